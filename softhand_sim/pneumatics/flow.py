"""Gas of all elements over one stretch of time in which no valve moves."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from softhand_sim.control.protocol import ValveCommand
from softhand_sim.elements import FINGERS, FINGERS_OF_ELEMENT, sum_over_fingers
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.network import ElementGas, Outside, advance, gas_at, vessels
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.supply import Supply, solve_receiver
from softhand_sim.pneumatics.tube import Tube


class GasState(NamedTuple):
    """The gas's part of `PneumaticState`, under the same names."""

    mass_kg: tuple[float, ...]
    pressure_pa_abs: tuple[float, ...]
    chamber_mass_kg: tuple[float, ...] = ()
    chamber_pa_abs: tuple[float, ...] = ()
    invariant: tuple[float, ...] = ()
    supply_mass_kg: tuple[float, ...] = ()


class Flow(NamedTuple):
    """How a system's gas is filled in, read and advanced; chosen once, from the features that are there."""

    fill: Callable[[Sequence[float], Sequence[float]], GasState]
    read: Callable[[PneumaticState, Sequence[float]], list[float]]
    advance: Callable[[PneumaticState, Sequence[float], float], GasState]


@dataclass(frozen=True, kw_only=True)
class LumpedFlow:
    """The flow of isothermal elements of one pressure each, on reservoirs, without leaks."""

    elements: tuple[Element, ...]

    def flow(self) -> Flow:
        """Return its three functions."""
        return Flow(self.fill, self.read, self.advance)

    def fill(self, volumes_m3: Sequence[float], pressures: Sequence[float]) -> GasState:
        """Return gas at a pressure for each element [Pa abs]."""
        sums = sum_over_fingers(volumes_m3)
        masses = tuple(e.mass_kg(p, v) for e, p, v in zip(self.elements, pressures, sums, strict=True))
        return GasState(masses, tuple(pressures))

    def read(self, state: PneumaticState, volumes_m3: Sequence[float]) -> list[float]:
        """Return the elements' pressures [Pa abs] at the present volumes, (3,)."""
        sums = sum_over_fingers(volumes_m3)
        return [e.pressure_pa_abs(m, v) for e, m, v in zip(self.elements, state.mass_kg, sums, strict=True)]

    def advance(self, state: PneumaticState, volumes_m3: Sequence[float], dt: float) -> GasState:
        """Return the gas after ``dt`` [s]."""
        masses, sums = state.mass_kg, sum_over_fingers(volumes_m3)
        if any(map(any, state.valves)):
            masses = tuple(
                e.step(m, v, inlet, outlet, dt) if inlet or outlet else m
                for e, m, v, (inlet, outlet) in zip(self.elements, masses, sums, state.valves, strict=True)
            )
        return GasState(masses, tuple(map(Element.pressure_pa_abs, self.elements, masses, sums)))


@dataclass(frozen=True, kw_only=True)
class NetworkFlow:
    """The flow of elements with tubes that resist, heat of compression, leaks or a finite supply.

    All elements have tubes or none has, and likewise heat of compression.

    Raises
    ------
    ValueError
        Otherwise, or if a finite supply has several set pressures, or a finger several leaks.
    """

    elements: tuple[Element, ...]
    leaks: tuple[Leak, ...]
    supply: Supply | None
    _tubes: tuple[Tube | None, ...] = field(init=False)

    def __post_init__(self) -> None:
        for name in ("tubing", "thermal"):
            given = [getattr(e, name) is not None for e in self.elements]
            if any(given) and not all(given):
                raise ValueError(f"elements: {name} must be given for all of them or for none, is {given}")
        pressures = sorted({e.supply_pa_abs for e in self.elements})
        if self.supply is not None and len(pressures) > 1:
            raise ValueError(f"supply_pa_abs = {pressures}: must be the same for all elements on one finite supply")
        fingers = [leak.finger for leak in self.leaks]
        if len(set(fingers)) < len(fingers):
            raise ValueError(f"leaks = {fingers}: must be at most one a finger")
        tubes = [
            None if e.tubing is None else e.tubing.branch(len(m))
            for e, m in zip(self.elements, FINGERS_OF_ELEMENT, strict=True)
        ]
        object.__setattr__(self, "_tubes", tuple(tubes))

    def flow(self) -> Flow:
        """Return its three functions."""
        return Flow(self.fill, self.read, self.advance)

    def fill(self, volumes_m3: Sequence[float], pressures: Sequence[float]) -> GasState:
        """Return gas at room temperature at a pressure for each element [Pa abs], the receiver at its set pressure."""
        gas = [gas_at(e, _of(volumes_m3, k), p) for k, (e, p) in enumerate(zip(self.elements, pressures, strict=True))]
        receiver: tuple[float, ...] = ()
        if self.supply is not None:
            first = self.elements[0]
            receiver = (first.supply_pa_abs * self.supply.volume_m3 / first.gas.rt_j_per_kg,)
        return _packed(gas, receiver)

    def read(self, state: PneumaticState, volumes_m3: Sequence[float]) -> list[float]:
        """Return the manifolds' pressures [Pa abs] at the present volumes, (3,)."""
        if state.chamber_mass_kg:  # a manifold behind tubes does not change its volume
            return list(state.pressure_pa_abs)
        gas = _unpacked(state)
        return [vessels(e, gas[k], _of(volumes_m3, k))[0].pressure for k, e in enumerate(self.elements)]

    def advance(self, state: PneumaticState, volumes_m3: Sequence[float], dt: float) -> GasState:
        """Return the gas after ``dt`` [s], taken in as many parts as the fastest element wants."""
        gas, receiver = _unpacked(state), state.supply_mass_kg
        holes = [self._holes(k, state.time_s) for k in range(len(self.elements))]
        parts = max(
            element.parts(sum(_of(volumes_m3, k)), dt, _fastest(element, valves, holes[k]))
            for k, (element, valves) in enumerate(zip(self.elements, state.valves, strict=True))
        )
        for _ in range(parts):
            gas, receiver = self._part(gas, receiver, state, holes, volumes_m3, dt / parts)
        return _packed(gas, receiver)

    def open_leaks(self, time_s: tuple[float, ...]) -> list[Leak]:
        """Return the leaks that have started."""
        return [leak for leak in self.leaks if leak.start_s <= time_s[0] + 1e-9] if self.leaks else []

    def _part(
        self,
        gas: list[ElementGas],
        receiver: tuple[float, ...],
        state: PneumaticState,
        holes: list[tuple[Orifice | None, ...]],
        volumes_m3: Sequence[float],
        dt: float,
    ) -> tuple[list[ElementGas], tuple[float, ...]]:
        after = list(gas)

        def feed(supply_pa_abs: float, with_inlet: bool) -> float:
            """Advance the elements whose inlet is open (or shut); return the mass [kg] they draw."""
            drawn = 0.0
            for k, (element, valves) in enumerate(zip(self.elements, state.valves, strict=True)):
                if valves.inlet_open == with_inlet:
                    outside = Outside(valves.inlet_open, valves.outlet_open, supply_pa_abs, holes[k])
                    if self.supply is None:
                        outside = outside._replace(supply_pa_abs=element.supply_pa_abs)
                    after[k], draw = advance(element, self._tubes[k], gas[k], _of(volumes_m3, k), outside, dt)
                    drawn += draw
            return drawn

        feed(0.0, False)
        if self.supply is None:
            feed(0.0, True)
            return after, receiver
        first = self.elements[0]
        pressures = [p for each in gas for p in each.pressure_pa_abs] + [first.ambient_pa_abs]
        mass = solve_receiver(
            self.supply,
            mass_kg=receiver[0],
            rt_j_per_kg=first.gas.rt_j_per_kg,
            set_pa_abs=first.supply_pa_abs,
            others_pa_abs=pressures,
            draw=lambda p: feed(p, True),
            dt=dt,
        )
        return after, (mass,)

    def _holes(self, element: int, time_s: tuple[float, ...]) -> tuple[Orifice | None, ...]:
        """Return the open leak of each finger of an element, () if there is none."""
        opened = {leak.finger: leak.orifice for leak in self.open_leaks(time_s)}
        found = tuple(opened.get(FINGERS[i]) for i in FINGERS_OF_ELEMENT[element])
        return found if any(found) else ()


def _fastest(element: Element, valves: ValveCommand, holes: tuple[Orifice | None, ...]) -> float:
    """Return the largest choked coefficient [kg/(s Pa)] of what is open."""
    links = [hole for hole in holes if hole is not None]
    links += [element.inlet] if valves.inlet_open else []
    links += [element.outlet] if valves.outlet_open else []
    return max((link.choked_coefficient_kg_per_s_pa for link in links), default=0.0)


def _of(per_finger: Sequence[float], element: int) -> list[float]:
    return [per_finger[i] for i in FINGERS_OF_ELEMENT[element]]


def _unpacked(state: PneumaticState) -> list[ElementGas]:
    n = len(state.mass_kg)
    out: list[ElementGas] = []
    for k in range(n):
        fingers = FINGERS_OF_ELEMENT[k] if state.chamber_mass_kg else ()
        masses = (state.mass_kg[k], *(state.chamber_mass_kg[i] for i in fingers))
        invariants: tuple[float | None, ...] = (None,) * len(masses)
        if state.invariant:
            invariants = (state.invariant[k], *(state.invariant[n + i] for i in fingers))
        pressures = (state.pressure_pa_abs[k], *(state.chamber_pa_abs[i] for i in fingers))
        out.append(ElementGas(masses, invariants, pressures))
    return out


def _packed(gas: Sequence[ElementGas], receiver: tuple[float, ...]) -> GasState:
    """Put manifolds first, then chambers in the order of ``FINGERS`` (elements hold their fingers in that order)."""
    chambers = [(m, p) for each in gas for m, p in zip(each.mass_kg[1:], each.pressure_pa_abs[1:], strict=True)]
    invariants = [each.invariant[0] for each in gas] + [x for each in gas for x in each.invariant[1:]]
    return GasState(
        tuple(each.mass_kg[0] for each in gas),
        tuple(each.pressure_pa_abs[0] for each in gas),
        tuple(m for m, _ in chambers),
        tuple(p for _, p in chambers),
        tuple(x for x in invariants if x is not None),
        receiver,
    )
