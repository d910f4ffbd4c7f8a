"""The set of effects of a scene, and three presets."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

from softhand_sim.effects import gas, gravity, interference, pads, relaxation, relief, sliding, tube
from softhand_sim.effects.gas import GasDynamics
from softhand_sim.effects.gravity import FingerGravity
from softhand_sim.effects.interference import FingerInterference
from softhand_sim.effects.kind import ActsOn
from softhand_sim.effects.sliding import SlidingHysteresis
from softhand_sim.effects.tube import TubeResistance
from softhand_sim.pads import SoftPads
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.relaxation import CONDITIONED_SILICONE, MaxwellBranch
from softhand_sim.relief import ProximalRelief


@dataclass(frozen=True, kw_only=True)
class Effects:
    """Which effects a scene has, with their parameters; None leaves one out, with all its state and work.

    Attributes
    ----------
    gas
        Gas dynamics (flow); without it the fingers have the set pressure at once.
    tube
        Resistance of the tubes (flow).
    heat
        Heat of compression (flow).
    supply
        Supply of finite capacity that droops (flow).
    leaks
        Holes in fingers (flow).
    valve_delay
        Dead time of the valves (command).
    sensor
        Noise, saturation, quantisation of the readings (command).
    sliding
        Hysteresis from friction of the actuators (torque).
    relaxation
        Branches of the walls' relaxation (torque).
    relief
        Actuators that come out at the proximal joint where the thrust is too large (torque).
    interference
        Contact between fingers (model).
    gravity
        Weight of the fingers (model).
    pads
        Contacts of phalanges and object as soft as in the finite elements (model).

    Raises
    ------
    ValueError
        If an effect of the flow or the command is given without gas dynamics.
    """

    gas: GasDynamics | None = None
    tube: TubeResistance | None = None
    heat: Polytropic | None = None
    supply: Supply | None = None
    leaks: tuple[Leak, ...] | None = None
    valve_delay: ValveDelay | None = None
    sensor: PressureSensor | None = None
    sliding: SlidingHysteresis | None = None
    relaxation: tuple[MaxwellBranch, ...] | None = None
    relief: ProximalRelief | None = None
    interference: FingerInterference | None = None
    gravity: FingerGravity | None = None
    pads: SoftPads | None = None

    def __post_init__(self) -> None:
        lost = [name for name in self.present if name in NEED_GAS]
        if self.gas is None and lost:
            raise ValueError(f"{lost[0]} = {getattr(self, lost[0])!r}: needs gas dynamics, gas is None")
        for name in ("leaks", "relaxation"):
            if getattr(self, name) == ():
                raise ValueError(f"{name} = (): must be one or more, or None")

    @property
    def present(self) -> tuple[str, ...]:
        """Names of the effects that are there."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name) is not None)


ACTS_ON: Mapping[str, ActsOn] = MappingProxyType(
    {
        "gas": gas.ACTS_ON,
        "tube": tube.ACTS_ON,
        "heat": ActsOn.FLOW,
        "supply": ActsOn.FLOW,
        "leaks": ActsOn.FLOW,
        "valve_delay": ActsOn.COMMAND,
        "sensor": ActsOn.COMMAND,
        "sliding": sliding.ACTS_ON,
        "relaxation": relaxation.ACTS_ON,
        "relief": relief.ACTS_ON,
        "interference": interference.ACTS_ON,
        "gravity": gravity.ACTS_ON,
        "pads": pads.ACTS_ON,
    }
)
"""Where each effect acts."""

NEED_GAS = tuple(name for name, on in ACTS_ON.items() if on in (ActsOn.FLOW, ActsOn.COMMAND) and name != "gas")
"""Effects that mean nothing without gas dynamics."""

IDEAL = Effects()
"""Set pressures at once, fingers without weight that don't meet: the finger and the object alone."""

BENCH = Effects(
    gas=GasDynamics(),
    sensor=PressureSensor(),
    sliding=SlidingHysteresis(),
    interference=FingerInterference(),
    gravity=FingerGravity(),
)
"""The paper's bench as far as its parts are documented: valves, tubes' volume, sensor. The default everywhere."""

FULL = Effects(
    gas=GasDynamics(),
    tube=TubeResistance(),
    heat=Polytropic(),
    supply=Supply(),
    valve_delay=ValveDelay(),
    sensor=PressureSensor(),
    sliding=SlidingHysteresis(),
    relaxation=CONDITIONED_SILICONE,
    interference=FingerInterference(),
    gravity=FingerGravity(),
)
"""Everything that every scene has but for the soft pads. A leak has to be declared, and so has the relief, of which no
force is stated."""

PRESETS: Mapping[str, Effects] = MappingProxyType({"ideal": IDEAL, "bench": BENCH, "full": FULL})
"""Presets by name."""
