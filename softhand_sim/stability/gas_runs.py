"""What the gas cases share: a system that is marched through time, its masses and its bounds."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.control.protocol import Answer, ControllerState, ValveCommand
from softhand_sim.elements import FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.pneumatics.tube import Tubing

REST_M3, GROWTH_M3 = 2.5e-6, 7e-7
"""Chamber at rest and its growth at 75 kPa of the shipped finger, rounded."""
SEED = 7


@dataclass(frozen=True, kw_only=True)
class Script:
    """A controller that plays pairs (inlet, outlet), one a tick, over and over, the same for all elements."""

    pattern: tuple[tuple[bool, bool], ...]

    def reset(self) -> ControllerState:
        """Return the number of the tick."""
        return (0.0,)

    def command(self, _readings: Sequence[float], _sets: Sequence[float], state: ControllerState) -> Answer:
        """Return the tick's pair."""
        return (ValveCommand(*self.pattern[int(state[0]) % len(self.pattern)]),) * 3, (state[0] + 1.0,)


@dataclass(frozen=True, kw_only=True)
class Chatter:
    """A controller that sets every valve at random at every tick, both of an element together too."""

    seed: int = SEED

    def reset(self) -> ControllerState:
        """Return the number of the tick."""
        return (0.0,)

    def command(self, _readings: Sequence[float], _sets: Sequence[float], state: ControllerState) -> Answer:
        """Return six random valves."""
        draw = (np.random.default_rng((self.seed, int(state[0]))).random(6) < 0.5).tolist()
        return tuple(ValveCommand(draw[k], draw[k + 1]) for k in (0, 2, 4)), (state[0] + 1.0,)


def system_of(*, element: dict[str, Any] | None = None, **features: Any) -> PneumaticSystem:
    """Return a system of three elements that share the fields in ``element``, without sensors unless given."""
    tubes = Tubing()
    elements = tuple(Element(dead_volume_m3=tubes.volume_m3(len(members))) for members in FINGERS_OF_ELEMENT)
    elements = tuple(replace(one, **(element or {})) for one in elements)
    return PneumaticSystem(elements=elements, **{"sensor": None, **features})


def still(_time_s: float) -> list[float]:
    """Return the chambers' volumes [m3], (5,), of fingers that don't move."""
    return [REST_M3] * 5


def breathing(time_s: float) -> list[float]:
    """Return the chambers' volumes [m3], (5,), of fingers that move at up to 5 rad/s, each at its own pace."""
    return [REST_M3 + GROWTH_M3 * (1.0 - math.cos((3.0 + 0.4 * k) * time_s)) for k in range(5)]


def march(
    system: PneumaticSystem,
    dt: float,
    duration_s: float,
    *,
    sets: Sequence[float] = (0.0, 0.0, 0.0),
    volumes: Callable[[float], list[float]] = still,
    start_pa_gauge: float = 0.0,
) -> list[PneumaticState]:
    """Return the states at the start and after every step."""
    state = system.reset(volumes(0.0), np.random.default_rng(SEED), start_pa_gauge)
    states = [state]
    for k in range(1, max(1, round(duration_s / dt)) + 1):
        state = system.step(state, volumes(k * dt), sets, dt)
        states.append(state)
    return states


def outside_pa(states: Sequence[PneumaticState], low_pa_abs: float, high_pa_abs: float) -> float:
    """Return by how much any pressure leaves a range [Pa], infinite where one is not finite."""
    values = np.array([[*s.pressure_pa_abs, *s.chamber_pa_abs] for s in states])
    if not np.isfinite(values).all():
        return math.inf
    return float(max(0.0, low_pa_abs - values.min(), values.max() - high_pa_abs))


def total_kg(state: PneumaticState) -> float:
    """Return all gas in manifolds, chambers and receiver [kg]."""
    return math.fsum((*state.mass_kg, *state.chamber_mass_kg, *state.supply_mass_kg))


def gauge_pa(state: PneumaticState) -> list[float]:
    """Return the elements' pressures [Pa gauge], (3,)."""
    return [p - AMBIENT_PA_ABS for p in state.pressure_pa_abs]
