"""From effects to what a simulation is made of: parameters of the gas, changes to the model before it is compiled."""

from dataclasses import replace
from typing import Any

from softhand_sim.calibration import FingerCalibration
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.protocol import Controller
from softhand_sim.effects.effects import Effects
from softhand_sim.effects.gravity import without_gravity
from softhand_sim.effects.interference import without_interference
from softhand_sim.effects.pads import soften
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.system import PneumaticSystem

TICK_S = 0.02
"""Control period [s] (the paper samples at 50 Hz)."""


def build_pneumatics(
    effects: Effects, calibration: FingerCalibration, controller: Controller | None = None
) -> PneumaticSystem | None:
    """Return the pneumatics that the effects ask for; None for set pressures at once.

    Without a controller of one's own it is the ON-OFF law, which knows the ambient pressure and its valves' delay.
    """
    gas = effects.gas
    if gas is None:
        return None
    if controller is None:
        late = 0.0 if effects.valve_delay is None else effects.valve_delay.closing_s / TICK_S
        controller = OnOffController(ambient_pa_abs=gas.ambient_pa_abs, dead_time_ticks=late)
    return PneumaticSystem(
        elements=gas.elements(calibration, resists=effects.tube is not None, heat=effects.heat),
        sensor=effects.sensor,
        controller=controller,
        tick_s=TICK_S,
        delay=effects.valve_delay,
        leaks=effects.leaks or (),
        supply=effects.supply,
    )


def build_losses(effects: Effects, calibration: FingerCalibration) -> Losses:
    """Return friction, relaxation and relief of the fingers, each only if the effects have it."""
    with_friction = Losses.of(calibration, effects.relaxation or (), effects.relief)
    return with_friction if effects.sliding is not None else replace(with_friction, sliding=None)


def apply_to_model(effects: Effects, root: Any) -> None:
    """Change a hand's MJCF by the effects that act on the model; what is present changes nothing."""
    if effects.interference is None:
        without_interference(root)
    if effects.gravity is None:
        without_gravity(root)


def apply_to_contacts(effects: Effects, root: Any) -> None:
    """Change the contacts of hand and object by the effects that act on them, once both are in the MJCF."""
    if effects.pads is not None:
        soften(root, effects.pads)
