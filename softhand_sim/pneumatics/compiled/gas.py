"""Compiled gas of all elements over a stretch in which no valve moves, with or without a supply of finite capacity."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import inner
from softhand_sim.pneumatics.compiled.layout import GAS_MASS, PRESSURE, RECEIVER
from softhand_sim.pneumatics.compiled.network import Valves, settle_element, solve_element
from softhand_sim.pneumatics.compiled.vessels import MAX_ITERATIONS, TOLERANCE, fill_nodes
from softhand_sim.pneumatics.element import LARGEST_PART, MOST_PARTS

F64 = npt.NDArray[np.float64]


@inner
def _solve(elements: Any, nodes: F64, open_: Valves, holes: F64, supply: float, with_inlet: bool, dt: float) -> float:
    """Solve the elements whose inlet is open (or shut), return what they draw; a supply below 0 is each one's own."""
    drawn = 0.0
    for k in range(elements.shape[0]):
        if (open_[2 * k] != 0) == with_inlet:
            own = elements[k].supply if supply < 0.0 else supply
            drawn += solve_element(elements[k], k, nodes, open_, holes, own, dt)
    return drawn


@inner
def _receive(
    elements: Any, nodes: F64, open_: Valves, holes: F64, receiver: F64, mass: float, dt: float
) -> tuple[float, float]:
    """`solve_receiver`: solve the elements with open inlets, return the supply that they see and what mass is left."""
    volume, largest, droop = receiver[0], receiver[1], receiver[2]
    wanted, capacity = elements[0].supply, volume / elements[0].rt
    start = mass / capacity
    low, high = min(start, elements[0].ambient), max(start, wanted)
    for k in range(elements.shape[0]):
        e = elements[k]
        low, high = min(low, nodes[k, PRESSURE]), max(high, nodes[k, PRESSURE])
        if e.half > 0.0:
            for i in range(elements.shape[0] + e.first, elements.shape[0] + e.first + e.fingers):
                low, high = min(low, nodes[i, PRESSURE]), max(high, nodes[i, PRESSURE])
    p = before = seen = start
    residual_before, gained = 0.0, 0.0
    for iteration in range(MAX_ITERATIONS):
        refill = largest * min(max((wanted - p) / droop, 0.0), 1.0)
        seen, gained = p, dt * refill - _solve(elements, nodes, open_, holes, p, True, dt)
        residual = capacity * p - mass - gained
        if residual > 0.0:
            high = min(high, p)
        else:
            low = max(low, p)
        slope = capacity if iteration == 0 else (residual - residual_before) / (p - before)
        following = p - residual / slope if slope > 0.0 else 0.5 * (low + high)
        if residual == 0.0 or abs(following - p) <= TOLERANCE * p:
            break
        before, residual_before = p, residual
        p = following if low < following < high else 0.5 * (low + high)
    return seen, mass + gained


@inner
def _parts(elements: Any, volumes_m3: F64, open_: Valves, holes: F64, dt: float) -> int:
    """`Element.parts` of the element that wants most."""
    parts = 1
    for k in range(elements.shape[0]):
        e = elements[k]
        volume = e.dead
        fastest = e.inlet[0] if open_[2 * k] else 0.0
        if open_[2 * k + 1]:
            fastest = max(fastest, e.outlet[0])
        for i in range(e.first, e.first + e.fingers):
            volume += volumes_m3[i]
            fastest = max(fastest, holes[i, 0])
        parts = max(parts, math.ceil(dt * fastest / (volume / e.rt * LARGEST_PART)))
    return min(parts, MOST_PARTS)


@inner
def advance_gas(
    elements: Any, gas: F64, volumes_m3: F64, open_: Valves, holes: F64, receiver: F64, nodes: F64, dt: float
) -> None:
    """Advance the gas by ``dt`` [s], in place.

    Parameters
    ----------
    elements
        Parameters of the elements (`layout.ELEMENT`), (3,).
    gas
        Rows: mass [kg], invariant and pressure [Pa abs]; columns: nodes, then the receiver (mass only), (3, 9).
    volumes_m3
        Chamber volumes, (5,).
    open_
        Whether inlet and outlet of each element are open, (6,).
    holes
        Orifice parameters of each finger's leak, (5, 4); zero for none.
    receiver
        Volume [m3], largest flow [kg/s] and droop [Pa] of the supply, (3,), or empty.
    nodes
        Scratch (`layout.SCRATCH_SHAPE`).
    dt
        Step [s].
    """
    parts = _parts(elements, volumes_m3, open_, holes, dt)
    step = dt / parts
    for _ in range(parts):
        fill_nodes(elements, gas, volumes_m3, nodes)
        _solve(elements, nodes, open_, holes, -1.0, False, step)
        supply = -1.0
        if receiver.shape[0] > 0:
            mass = gas[GAS_MASS, RECEIVER]
            supply, gas[GAS_MASS, RECEIVER] = _receive(elements, nodes, open_, holes, receiver, mass, step)
        else:
            _solve(elements, nodes, open_, holes, -1.0, True, step)
        for k in range(elements.shape[0]):
            own = elements[k].supply if supply < 0.0 else supply
            settle_element(elements[k], k, nodes, open_, holes, own, step, gas)
