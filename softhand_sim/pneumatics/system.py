"""Pneumatics of the whole hand: three elements, their sensors, and a controller that runs at 50 Hz."""

import importlib.util
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.checks import require_finite
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.protocol import Controller, ValveCommand, checked_answer
from softhand_sim.elements import ELEMENTS, FINGERS, FINGERS_OF_ELEMENT, spread_to_fingers
from softhand_sim.pneumatics.delay import ValveDelay, moved
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.flow import Flow, LumpedFlow, NetworkFlow
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.network import vessel_shapes
from softhand_sim.pneumatics.noise import NumberedNoise
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.tube import tube_volume_m3
from softhand_sim.pneumatics.vessel import require_gas

Values = Sequence[float] | npt.NDArray[np.float64]

LONGEST_STEP_S = 3600.0
"""Choice: a step is split at every tick, so that 1e300 s would never end."""
SMALLEST_VOLUME_M3, LARGEST_VOLUME_M3 = 1e-15, 1e3
"""Choices: a hundredth of a millimetre cubed, and a hall; in 1e-300 m3 a step's rounding is more than all the gas, in
1e300 m3 what flows in is less than the rounding of what is there."""
_TIME_TOLERANCE_S = 1e-9  # an event this close to a step's end belongs to the next step; far below any step


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
        Pressure sensor, the same for every element; None: the controller reads the true pressure.
    controller
        Law from readings and set pressures to valves.
    tick_s
        Control period [s]: 0.02 (the paper samples at 50 Hz).
    delay
        Dead time of the valves; None: they move with the command.
    leaks
        Holes in fingers, at most one each.
    supply
        Receiver and regulator that all elements draw from; None: each element's supply is a reservoir.

    Raises
    ------
    ValueError
        If the number of elements is wrong, the period is not positive, the sensor's range ends below ambient, or
        features contradict one another (`NetworkFlow`).
    """

    elements: tuple[Element, ...] = field(default_factory=default_elements)
    sensor: PressureSensor | None = field(default_factory=PressureSensor)
    controller: Controller = field(default_factory=OnOffController)
    tick_s: float = 0.02
    delay: ValveDelay | None = None
    leaks: tuple[Leak, ...] = ()
    supply: Supply | None = None
    _flow: Flow = field(init=False, repr=False, compare=False)
    _memory: int = field(init=False, repr=False, compare=False)
    _noise: NumberedNoise = field(init=False, repr=False, compare=False, default_factory=NumberedNoise)

    def __post_init__(self) -> None:
        if len(self.elements) != len(ELEMENTS):
            raise ValueError(f"elements: {len(self.elements)} given, must be {len(ELEMENTS)} ({', '.join(ELEMENTS)})")
        require_finite("tick_s", self.tick_s, above=1e-4)
        for name, element in zip(ELEMENTS, self.elements, strict=True):
            if self.sensor is not None and self.sensor.high_pa_abs <= element.ambient_pa_abs:
                raise ValueError(
                    f"high_pa_abs = {self.sensor.high_pa_abs!r}: sensor of {name} must reach above ambient, "
                    f"{element.ambient_pa_abs:g} Pa"
                )
        featured = any(e.tubing is not None or e.thermal is not None for e in self.elements)
        if featured or self.leaks or self.supply is not None:
            flow = _network_flow(NetworkFlow(elements=self.elements, leaks=self.leaks, supply=self.supply))
        else:
            flow = LumpedFlow(elements=self.elements).flow()
        object.__setattr__(self, "_flow", flow)
        object.__setattr__(self, "_memory", len(self.controller.reset()))

    @property
    def ambient_pa_abs(self) -> npt.NDArray[np.float64]:
        """Ambient pressure at each element [Pa abs], (3,)."""
        return np.array([element.ambient_pa_abs for element in self.elements])

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

        Raises
        ------
        ValueError
            If a volume or the pressure is out of range, or an element with heat bulges by more than a volume.
        """
        require_finite("pressure_pa_gauge", pressure_pa_gauge, at_least=0.0)
        pressures = tuple(element.ambient_pa_abs + pressure_pa_gauge for element in self.elements)
        gas = self._flow.fill(self._checked_volumes(volumes_m3), pressures)
        return PneumaticState(
            time_to_tick_s=0.0,
            ticks=0,
            noise_seed=int(rng.integers(2**53)),
            readings_pa_abs=pressures,
            valves=(ValveCommand(),) * len(self.elements),
            controller=self.controller.reset(),
            waiting_s=() if self.delay is None else (math.inf,) * (2 * len(self.elements)),
            time_s=(0.0,) if self.leaks else (),
            **gas._asdict(),
        )

    def step(self, state: PneumaticState, volumes_m3: Values, set_pa_gauge: Values, dt: float) -> PneumaticState:
        """Return the state after ``dt``, with the chambers' volumes held over it.

        A tick, a valve's delayed move or the start of a leak inside the step splits it there, so valves switch at
        exactly 50 Hz whatever ``dt``.

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
            If a volume or ``dt`` is not a positive number, ``dt`` is too long for what flows (`require_gas`), a set
            pressure is outside 0 to the supply's or the sensor's range, or the controller's answer is not what
            `Controller` promises.
        """
        if not 0.0 < dt <= LONGEST_STEP_S:
            raise ValueError(f"dt = {dt!r}: must be a number of seconds in (0, {LONGEST_STEP_S:g}]")
        volumes = self._checked_volumes(volumes_m3)
        to_tick, remaining = state.time_to_tick_s, dt
        while True:
            if to_tick <= _TIME_TOLERANCE_S:
                state = self._tick(state, volumes, set_pa_gauge)
                to_tick += self.tick_s
            event = to_tick
            if state.waiting_s or state.time_s:
                event = min(event, self._next_event_s(state))
            part = remaining if remaining <= event + _TIME_TOLERANCE_S else event
            gas = self._flow.advance(state, volumes, part)
            require_gas((*gas.mass_kg, *gas.chamber_mass_kg), dt)
            to_tick -= part
            state = PneumaticState(
                to_tick, state.ticks, state.noise_seed, gas.mass_kg, gas.pressure_pa_abs, state.readings_pa_abs,
                state.valves, state.controller, gas.chamber_mass_kg, gas.chamber_pa_abs, gas.invariant,
                state.waiting_s, gas.supply_mass_kg, state.time_s,
            )  # fmt: skip
            if state.waiting_s or state.time_s:
                state = _later(state, part)
            remaining -= part
            if remaining <= 0.0:
                return state

    def finger_pressures_pa_gauge(self, state: PneumaticState) -> tuple[float, ...]:
        """Return the gauge pressure in each finger's chamber [Pa], (5,)."""
        if state.chamber_pa_abs:
            ambient = spread_to_fingers([e.ambient_pa_abs for e in self.elements])
            return tuple(p - a for p, a in zip(state.chamber_pa_abs, ambient, strict=True))
        gauge = [p - e.ambient_pa_abs for p, e in zip(state.pressure_pa_abs, self.elements, strict=True)]
        return spread_to_fingers(gauge)

    def _checked_volumes(self, volumes_m3: Values) -> Sequence[float]:
        """Return the chamber volumes [m3] per finger (5,)."""
        fingers = _checked_volumes(volumes_m3)
        for name, element, members in zip(ELEMENTS, self.elements, FINGERS_OF_ELEMENT, strict=True):
            if element.thermal is None or element.compliance_m3_per_pa == 0.0:
                continue
            own = [fingers[i] for i in members]
            # the law of compression has no solution where nothing would be left of a volume without pressure
            if min(stiff for stiff, growth in vessel_shapes(element, own) if growth > 0.0) <= 0.0:
                raise ValueError(
                    f"compliance_m3_per_pa = {element.compliance_m3_per_pa!r}: {name} must bulge by less than its "
                    f"chambers' volumes, {own} m3, from no pressure to ambient"
                )
        return fingers

    def restore(self, flat: npt.NDArray[np.float64]) -> PneumaticState:
        """Return the state that ``PneumaticState.to_array`` saved under this system, bit for bit."""
        return self.reset([1e-6] * len(FINGERS), np.random.default_rng(0)).from_array(flat)

    def _next_event_s(self, state: PneumaticState) -> float:
        """Return the time [s] until the next valve moves or leak opens."""
        moves = min(state.waiting_s, default=math.inf)
        starts = (leak.start_s - state.time_s[0] for leak in self.leaks)
        return min(moves, min((s for s in starts if s > _TIME_TOLERANCE_S), default=math.inf))

    def _tick(self, state: PneumaticState, volumes: Sequence[float], set_pa_gauge: Values) -> PneumaticState:
        """Read the sensors at the present volumes and let the controller switch the valves."""
        sets = [float(value) for value in set_pa_gauge]
        self.check_sets(sets)
        readings = tuple(self._flow.read(state, volumes))
        if self.sensor is not None:
            # one stream per reset, addressed by the tick's number: a restored state repeats its noise
            noise = self._noise.draw(state.noise_seed, state.ticks, len(self.elements))
            readings = tuple(self.sensor.read_pa_abs(p, draw) for p, draw in zip(readings, noise, strict=True))
        answer = self.controller.command(readings, sets, state.controller)
        valves, memory = checked_answer(type(self.controller).__name__, answer, self._memory)
        waiting = state.waiting_s
        if self.delay is not None:
            valves, waiting = self.delay.request(state.valves, valves, waiting)
        return state._replace(
            ticks=state.ticks + 1, readings_pa_abs=readings, valves=valves, controller=memory, waiting_s=waiting
        )

    @property
    def highest_set_pa_gauge(self) -> tuple[float, ...]:
        """Highest set pressure of each element [Pa gauge], (3,): its supply's, or the end of the sensor's range."""
        reach = math.inf if self.sensor is None else self.sensor.high_pa_abs
        return tuple(min(e.supply_pa_abs, reach) - e.ambient_pa_abs for e in self.elements)

    def check_sets(self, set_pa_gauge: Sequence[float]) -> None:
        """Raise a ValueError that names the element if set pressures [Pa gauge], (3,), cannot be kept."""
        if len(set_pa_gauge) != len(self.elements):
            raise ValueError(f"set_pa_gauge has {len(set_pa_gauge)} values: must have {len(self.elements)}")
        for name, value, element, highest in zip(
            ELEMENTS, set_pa_gauge, self.elements, self.highest_set_pa_gauge, strict=True
        ):
            if not 0.0 <= value <= highest:
                limit = "supply" if highest == element.supply_pa_abs - element.ambient_pa_abs else "sensor's range"
                raise ValueError(
                    f"set_pa_gauge of {name} = {value!r}: must be in [0, {highest:g}] Pa ({limit} ends there)"
                )


def _network_flow(network: NetworkFlow) -> Flow:
    """Return the compiled flow where numba is installed, else the plain one: the same figures, slower."""
    if importlib.util.find_spec("numba") is None:
        return network.flow()
    from softhand_sim.pneumatics.fast import CompiledFlow  # noqa: PLC0415 - numba is optional

    return CompiledFlow(network=network).flow()


def _later(state: PneumaticState, dt: float) -> PneumaticState:
    """Let ``dt`` [s] pass for delayed valves and for the clock."""
    if state.waiting_s:
        valves, waiting = moved(state.valves, state.waiting_s, dt)
        state = state._replace(valves=valves, waiting_s=waiting)
    return state._replace(time_s=(state.time_s[0] + dt,)) if state.time_s else state


def _checked_volumes(volumes_m3: Values) -> Sequence[float]:
    """Return the chamber volumes [m3] per finger (5,)."""
    fingers: Sequence[float] = volumes_m3.tolist() if isinstance(volumes_m3, np.ndarray) else volumes_m3
    if not (len(fingers) == len(FINGERS) and min(fingers) > SMALLEST_VOLUME_M3 and sum(fingers) <= LARGEST_VOLUME_M3):
        raise ValueError(
            f"volumes_m3 = {list(fingers)}: must be {len(FINGERS)} finite numbers > {SMALLEST_VOLUME_M3:g}, "
            f"together <= {LARGEST_VOLUME_M3:g}"
        )
    return fingers
