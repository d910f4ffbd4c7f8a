"""Pneumatics of the whole hand: three elements, their sensors, and a controller that runs at 50 Hz."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.checks import require_finite
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.protocol import Controller, ValveCommand
from softhand_sim.elements import (
    ELEMENTS,
    FINGERS,
    FINGERS_OF_ELEMENT,
    spread_to_fingers,
    sum_over_fingers,
)
from softhand_sim.pneumatics.element import Element, tube_volume_m3
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.state import PneumaticState, state_from_array

Values = Sequence[float] | npt.NDArray[np.float64]

_TIME_TOLERANCE_S = 1e-9  # a tick this close to a step's end belongs to the next step; far below any step


def default_elements(bulging_m3_per_pa: float = 0.0) -> tuple[Element, ...]:
    """Return the three elements with default valves, the tubes of their fingers and the bulging of each finger."""
    return tuple(
        Element(dead_volume_m3=tube_volume_m3(n), compliance_m3_per_pa=n * bulging_m3_per_pa)
        for n in map(len, FINGERS_OF_ELEMENT)
    )


@dataclass(frozen=True, kw_only=True)
class PneumaticSystem:
    """Parameters of the hand's pneumatics; the state is passed in and out.

    Attributes
    ----------
    elements
        Gas balance per element, in the order of ``ELEMENTS``.
    sensor
        Pressure sensor, the same for every element.
    controller
        Law from readings and set pressures to valves.
    tick_s
        Control period [s]: 0.02 (the paper samples at 50 Hz).

    Raises
    ------
    ValueError
        If the number of elements is wrong or the period is not positive.
    """

    elements: tuple[Element, ...] = field(default_factory=default_elements)
    sensor: PressureSensor = field(default_factory=PressureSensor)
    controller: Controller = field(default_factory=OnOffController)
    tick_s: float = 0.02

    def __post_init__(self) -> None:
        if len(self.elements) != len(ELEMENTS):
            raise ValueError(f"elements: {len(self.elements)} given, must be {len(ELEMENTS)} ({', '.join(ELEMENTS)})")
        require_finite("tick_s", self.tick_s, above=1e-4)

    def reset(self, volumes_m3: Values, rng: np.random.Generator, pressure_pa_gauge: float = 0.0) -> PneumaticState:
        """Return the state with every element at one gauge pressure and all valves shut; a tick is due.

        Parameters
        ----------
        volumes_m3
            Chamber volume per finger [m3], (5,).
        rng
            Source of the sensors' noise; one integer is drawn from it.
        pressure_pa_gauge
            Pressure of every element [Pa gauge].
        """
        require_finite("pressure_pa_gauge", pressure_pa_gauge, at_least=0.0)
        volumes = self._element_volumes(volumes_m3)
        pressures = tuple(element.ambient_pa_abs + pressure_pa_gauge for element in self.elements)
        return PneumaticState(
            time_to_tick_s=0.0,
            ticks=0,
            noise_seed=int(rng.integers(2**53)),
            mass_kg=tuple(e.mass_kg(p, v) for e, p, v in zip(self.elements, pressures, volumes, strict=True)),
            pressure_pa_abs=pressures,
            readings_pa_abs=pressures,
            valves=(ValveCommand(),) * len(self.elements),
            controller=self.controller.reset(),
        )

    def step(self, state: PneumaticState, volumes_m3: Values, set_pa_gauge: Values, dt: float) -> PneumaticState:
        """Return the state after ``dt``, with the chambers' volumes held over it.

        A tick that falls inside the step splits it there, so valves switch at exactly 50 Hz whatever
        ``dt``.

        Parameters
        ----------
        state
            State at the step's start.
        volumes_m3
            Chamber volume per finger [m3] at ambient pressure, (5,), in the order of ``FINGERS``.
        set_pa_gauge
            Set pressure per element [Pa gauge], (3,); read at ticks only.
        dt
            Step [s], from 0.1 to 20 ms (longer ones work too, being split at every tick).

        Raises
        ------
        ValueError
            If a volume or ``dt`` is not a positive number, or a set pressure is outside 0 to the supply's.
        """
        if not 0.0 < dt < math.inf:
            raise ValueError(f"dt = {dt!r}: must be a finite number of seconds > 0")
        volumes = self._element_volumes(volumes_m3)
        to_tick, remaining = state.time_to_tick_s, dt
        while True:
            if to_tick <= _TIME_TOLERANCE_S:
                state = self._tick(state, volumes, set_pa_gauge)
                to_tick += self.tick_s
            part = remaining if remaining <= to_tick + _TIME_TOLERANCE_S else to_tick
            state = self._flow(state, volumes, part, to_tick - part)
            to_tick -= part
            remaining -= part
            if remaining <= 0.0:
                return state

    def finger_pressures_pa_gauge(self, state: PneumaticState) -> tuple[float, ...]:
        """Return the gauge pressure per finger [Pa], (5,)."""
        gauge = [p - e.ambient_pa_abs for p, e in zip(state.pressure_pa_abs, self.elements, strict=True)]
        return spread_to_fingers(gauge)

    def restore(self, flat: npt.NDArray[np.float64]) -> PneumaticState:
        """Return the state that ``PneumaticState.to_array`` saved under this system, bit for bit."""
        return state_from_array(flat, len(self.elements), len(self.controller.reset()))

    def _flow(self, state: PneumaticState, volumes: Sequence[float], dt: float, to_tick: float) -> PneumaticState:
        """Advance the gas by ``dt`` with the valves as they are."""
        masses: list[float] = []
        pressures: list[float] = []
        for element, mass, volume, valves in zip(self.elements, state.mass_kg, volumes, state.valves, strict=True):
            after = mass
            if valves.inlet_open or valves.outlet_open:
                after = element.step(mass, volume, valves.inlet_open, valves.outlet_open, dt)
            masses.append(after)
            pressures.append(element.pressure_pa_abs(after, volume))
        return PneumaticState(
            to_tick,
            state.ticks,
            state.noise_seed,
            tuple(masses),
            tuple(pressures),
            state.readings_pa_abs,
            state.valves,
            state.controller,
        )

    def _tick(self, state: PneumaticState, volumes: Sequence[float], set_pa_gauge: Values) -> PneumaticState:
        """Read the sensors at the present volumes and let the controller switch the valves."""
        sets = [float(value) for value in set_pa_gauge]
        self._check_sets(sets)
        # One stream per reset, addressed by the tick's number: a restored state repeats its noise.
        stream = np.random.Generator(np.random.Philox(key=state.noise_seed, counter=state.ticks << 64))
        noise: list[float] = stream.standard_normal(len(self.elements)).tolist()
        readings = tuple(
            self.sensor.read_pa_abs(element.pressure_pa_abs(mass, volume), draw)
            for element, mass, volume, draw in zip(self.elements, state.mass_kg, volumes, noise, strict=True)
        )
        valves, memory = self.controller.command(readings, sets, state.controller)
        return state._replace(ticks=state.ticks + 1, readings_pa_abs=readings, valves=valves, controller=memory)

    def _check_sets(self, sets: Sequence[float]) -> None:
        if len(sets) != len(self.elements):
            raise ValueError(f"set_pa_gauge has {len(sets)} values: must have {len(self.elements)}")
        for name, value, element in zip(ELEMENTS, sets, self.elements, strict=True):
            highest = element.supply_pa_abs - element.ambient_pa_abs
            if not 0.0 <= value <= highest:
                raise ValueError(f"set_pa_gauge of {name} = {value!r}: must be in [0, {highest:g}] Pa")

    def _element_volumes(self, volumes_m3: Values) -> tuple[float, ...]:
        """Return the sum of the chamber volumes [m3] per element."""
        fingers: Sequence[float] = volumes_m3.tolist() if isinstance(volumes_m3, np.ndarray) else volumes_m3
        if not (len(fingers) == len(FINGERS) and min(fingers) > 0.0 and sum(fingers) < math.inf):
            raise ValueError(f"volumes_m3 = {list(fingers)}: must be {len(FINGERS)} finite numbers > 0")
        return sum_over_fingers(fingers)
