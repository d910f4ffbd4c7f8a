"""The network's flow by the compiled kernel: the same gas as `NetworkFlow`, some twenty times faster."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import compile_for, entry
from softhand_sim.elements import FINGERS
from softhand_sim.pneumatics.compiled.gas import advance_gas
from softhand_sim.pneumatics.compiled.layout import (
    GAS_SHAPE,
    MANIFOLDS,
    NODES,
    RECEIVER,
    SCRATCH_SHAPE,
    element_records,
    orifice_row,
    receiver_row,
)
from softhand_sim.pneumatics.flow import Flow, GasState, NetworkFlow
from softhand_sim.pneumatics.state import PneumaticState

Vector = npt.NDArray[np.float64]


@entry
def _advance(
    elements: Any, gas: Vector, volumes: Vector, open_: npt.NDArray[np.uint8], holes: Vector, receiver: Vector,
    nodes: Vector, dt: float,
) -> None:  # fmt: skip
    advance_gas(elements, gas, volumes, open_, holes, receiver, nodes, dt)


@dataclass(frozen=True, kw_only=True)
class CompiledFlow:
    """A network's parameters as arrays; filling and reading stay the network's own."""

    network: NetworkFlow
    _elements: npt.NDArray[np.void] = field(init=False, repr=False, compare=False)
    _receiver: Vector = field(init=False, repr=False, compare=False)
    _no_holes: Vector = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_elements", element_records(self.network.elements))
        object.__setattr__(self, "_receiver", receiver_row(self.network.supply))
        object.__setattr__(self, "_no_holes", np.zeros((len(FINGERS), 4)))
        gas, nodes, open_ = np.zeros(GAS_SHAPE), np.zeros(SCRATCH_SHAPE), np.zeros(2 * MANIFOLDS, dtype=np.uint8)
        volumes = np.zeros(len(FINGERS))
        compile_for(_advance, self._elements, gas, volumes, open_, self._no_holes, self._receiver, nodes, 0.0)

    def flow(self) -> Flow:
        """Return its three functions."""
        return Flow(self.network.fill, self.network.read, self.advance)

    def advance(self, state: PneumaticState, volumes_m3: Sequence[float], dt: float) -> GasState:
        """Return the gas after ``dt`` [s]."""
        gas = gas_array(state)
        holes = self._no_holes
        if state.time_s:
            holes = self._no_holes.copy()
            for leak in self.network.open_leaks(state.time_s):
                holes[FINGERS.index(leak.finger)] = orifice_row(leak.orifice)
        open_ = np.array(state.valves, dtype=np.uint8).ravel()
        nodes = np.empty(SCRATCH_SHAPE)
        _advance(self._elements, gas, np.array(volumes_m3), open_, holes, self._receiver, nodes, dt)
        has = {"chambers": state.chamber_mass_kg, "warm": state.invariant, "supply": state.supply_mass_kg}
        return gas_state(gas, **{name: bool(value) for name, value in has.items()})


def gas_array(state: GasState | PneumaticState) -> Vector:
    """Return the gas of a state in the kernels' form."""
    gas = np.zeros(GAS_SHAPE)
    nodes = MANIFOLDS + len(state.chamber_mass_kg)
    gas[0, :nodes] = (*state.mass_kg, *state.chamber_mass_kg)
    gas[1, : len(state.invariant)] = state.invariant
    gas[2, :nodes] = (*state.pressure_pa_abs, *state.chamber_pa_abs)
    gas[0, RECEIVER] = state.supply_mass_kg[0] if state.supply_mass_kg else 0.0
    return gas


def gas_state(gas: Vector, *, chambers: bool, warm: bool, supply: bool) -> GasState:
    """Return the gas as a state: with chambers where tubes resist, invariants with heat, a receiver with a supply."""
    mass, invariant, pressure = gas.tolist()
    nodes = NODES if chambers else MANIFOLDS
    return GasState(
        tuple(mass[:MANIFOLDS]),
        tuple(pressure[:MANIFOLDS]),
        tuple(mass[MANIFOLDS:nodes]),
        tuple(pressure[MANIFOLDS:nodes]),
        tuple(invariant[:nodes]) if warm else (),
        (mass[RECEIVER],) if supply else (),
    )
