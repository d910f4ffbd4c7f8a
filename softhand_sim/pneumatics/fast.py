"""The network's flow by the compiled kernel: the same gas as `NetworkFlow`, some twenty times faster."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.elements import FINGERS, FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.compiled import advance_gas
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.flow import Flow, GasState, NetworkFlow
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.state import PneumaticState

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CompiledFlow:
    """A network's parameters as arrays; filling and reading stay the network's own."""

    network: NetworkFlow
    _elements: Vector = field(init=False, repr=False, compare=False)
    _receiver: Vector = field(init=False, repr=False, compare=False)
    _no_holes: Vector = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        elements, supply = self.network.elements, self.network.supply
        receiver = [] if supply is None else [supply.volume_m3, supply.largest_flow_kg_per_s, supply.droop_pa]
        rows = np.array([_row(element, members) for element, members in zip(elements, FINGERS_OF_ELEMENT, strict=True)])
        object.__setattr__(self, "_elements", rows)
        object.__setattr__(self, "_no_holes", np.zeros((len(FINGERS), 4)))
        object.__setattr__(self, "_receiver", np.array(receiver, dtype=np.float64))

    def flow(self) -> Flow:
        """Return its three functions."""
        return Flow(self.network.fill, self.network.read, self.advance)

    def advance(self, state: PneumaticState, volumes_m3: Sequence[float], dt: float) -> GasState:
        """Return the gas after ``dt`` [s]."""
        n, nodes = len(state.mass_kg), len(state.mass_kg) + len(state.chamber_mass_kg)
        # numbers of one row, so that one conversion makes the array
        mass = (*state.mass_kg, *state.chamber_mass_kg, *(state.supply_mass_kg or (0.0,)))
        gas = np.array([mass, (*(state.invariant or (0.0,) * nodes), 0.0), (0.0,) * (nodes + 1)])
        holes = self._no_holes
        if state.time_s:
            holes = self._no_holes.copy()
            for leak in self.network.open_leaks(state.time_s):
                holes[FINGERS.index(leak.finger)] = _orifice(leak.orifice)
        (a, b), (c, d), (e, f) = state.valves
        after = advance_gas(self._elements, gas, np.array(volumes_m3), (a, b, c, d, e, f), holes, self._receiver, dt)
        masses, invariants, pressures = after.tolist()
        return GasState(
            tuple(masses[:n]),
            tuple(pressures[:n]),
            tuple(masses[n:nodes]),
            tuple(pressures[n:nodes]),
            tuple(invariants[: len(state.invariant)]),
            tuple(masses[nodes:]) if state.supply_mass_kg else (),
        )


def _orifice(orifice: Orifice) -> tuple[float, float, float, float]:
    return (
        orifice.choked_coefficient_kg_per_s_pa,
        orifice.critical_pressure_ratio,
        orifice.laminar_pressure_ratio,
        orifice.laminar_coefficient_kg_per_s_pa,
    )


def _row(element: Element, members: Sequence[int]) -> list[float]:
    """Return an element's parameters in the kernel's columns; its fingers follow one another in ``FINGERS``."""
    tubing, thermal = element.tubing, element.thermal
    row = [*_orifice(element.inlet), *_orifice(element.outlet)]
    row += [element.dead_volume_m3, element.compliance_m3_per_pa, element.supply_pa_abs, element.ambient_pa_abs]
    row += [element.gas.rt_j_per_kg]
    if tubing is None:
        row += [0.0] * 4
    else:
        tube = tubing.branch(len(members))
        row += [tubing.half_finger_m3(), tube.laminar_kg_per_s_pa2, tube.crossing_kg_per_s, tube.crossing_pa2]
    wall = None if thermal is None else thermal.wall_time_constant_s
    row += [1.0 if thermal is None else thermal.exponent, math.inf if wall is None else wall]
    return [*row, float(members[0]), float(len(members))]
