"""Compiled gas of all elements over a stretch in which no valve moves, with or without a supply of finite capacity."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import inner
from softhand_sim.pneumatics.compiled.layout import GAS_MASS, PRESSURE, RECEIVER
from softhand_sim.pneumatics.compiled.network import Valves, advance_element
from softhand_sim.pneumatics.compiled.vessels import MAX_ITERATIONS, TOLERANCE, fill_nodes
from softhand_sim.pneumatics.element import LARGEST_PART, MOST_PARTS

F64 = npt.NDArray[np.float64]


@inner
def _feed(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    elements: Any, nodes: F64, open_: Valves, holes: F64, supply: float, with_inlet: bool, guesses: F64, dt: float,
    gas: F64,
) -> float:  # fmt: skip
    """Advance the elements whose inlet is open (or shut); a supply below 0 stands for each element's own."""
    drawn = 0.0
    for k in range(elements.shape[0]):
        if (open_[2 * k] != 0) == with_inlet:
            own = elements[k].supply if supply < 0.0 else supply
            drawn += advance_element(elements[k], k, nodes, open_, holes, own, guesses, dt, gas)
    return drawn


@inner
def _receive(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    elements: Any, nodes: F64, open_: Valves, holes: F64, receiver: F64, mass: float, guesses: F64, dt: float, gas: F64
) -> float:
    """`solve_receiver`: advance the elements with open inlets, return the mass in the receiver."""
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
    p = before = start
    residual_before, gained = 0.0, 0.0
    for iteration in range(MAX_ITERATIONS):
        refill = largest * min(max((wanted - p) / droop, 0.0), 1.0)
        gained = dt * refill - _feed(elements, nodes, open_, holes, p, True, guesses, dt, gas)
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
    return mass + gained


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
        Scratch, (8, 8).
    dt
        Step [s].
    """
    parts = _parts(elements, volumes_m3, open_, holes, dt)
    step, guesses = dt / parts, np.zeros(volumes_m3.shape[0])
    for _ in range(parts):
        fill_nodes(elements, gas, volumes_m3, nodes)
        _feed(elements, nodes, open_, holes, -1.0, False, guesses, step, gas)
        if receiver.shape[0] > 0:
            mass = gas[GAS_MASS, RECEIVER]
            gas[GAS_MASS, RECEIVER] = _receive(elements, nodes, open_, holes, receiver, mass, guesses, step, gas)
        else:
            _feed(elements, nodes, open_, holes, -1.0, True, guesses, step, gas)
