"""Compiled vessels: what a node holds before and after a step (`Vessel`), and the search for a pressure."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import inner
from softhand_sim.pneumatics.compiled.layout import (
    CAPACITY,
    CONTENT,
    GAS_INVARIANT,
    GAS_MASS,
    GAS_PRESSURE,
    GROWTH,
    MANIFOLDS,
    MASS,
    PRESSURE,
    SOFT,
    STIFF,
    WARMTH,
)

F64 = npt.NDArray[np.float64]

TOLERANCE, MAX_ITERATIONS = 1e-12, 100


@inner
def positive_root(a: float, b: float, c: float) -> float:
    """`vessel.positive_root`."""
    return 2.0 * c / (b + math.sqrt(b * b + 4.0 * a * c))


@inner
def next_guess(p: float, low: float, high: float, residual: float, rise: float) -> tuple[float, float, float, bool]:
    """One round of `solve_pressure`: the next pressure, its bracket, and whether it is the root."""
    if residual == 0.0:
        return p, low, high, True
    if residual > 0.0:
        high = p
    else:
        low = p
    newton = p - residual / rise
    if abs(newton - p) <= TOLERANCE * p:
        return min(max(newton, low), high), low, high, True
    return (newton if low < newton < high else 0.5 * (low + high)), low, high, False


@inner
def _fill(e: Any, gas: F64, node: F64, at: int, stiff: float, soft: float) -> None:
    rt, n, mass, invariant = e.rt, e.exponent, gas[GAS_MASS, at], gas[GAS_INVARIANT, at]
    node[STIFF], node[SOFT], node[MASS] = stiff, soft, mass
    if n == 1.0:
        node[PRESSURE] = positive_root(soft, stiff, mass * rt)
        node[CAPACITY], node[GROWTH], node[CONTENT] = stiff / rt, soft / rt, mass
        node[WARMTH] = 1.0
        return
    if soft == 0.0:
        p = math.pow(invariant / stiff, n)
    else:
        # the pressure that the vessel had is near
        p = gas[GAS_PRESSURE, at]
        for _ in range(50):
            volume = stiff + soft * p
            error = math.log(p) / n + math.log(volume / invariant)
            step = error / (1.0 / n + soft * p / volume)
            p *= math.exp(-step)
            if abs(step) <= 1e-14:
                break
    node[PRESSURE] = p
    node[CAPACITY], node[GROWTH] = stiff / (n * rt), 0.5 * (n + 1.0) * soft / (n * rt)
    node[CONTENT] = (node[CAPACITY] + node[GROWTH] * p) * p
    node[WARMTH] = p * (stiff + soft * p) / (mass * rt)


@inner
def fill_nodes(elements: Any, gas: F64, volumes_m3: F64, nodes: F64) -> None:
    """`network.vessels` of all elements: fill the scratch from the gas at the chambers' volumes."""
    for k in range(elements.shape[0]):
        e = elements[k]
        bulging = e.bulging
        if e.half > 0.0:
            _fill(e, gas, nodes[k], k, e.dead - e.fingers * e.half, 0.0)
            for i in range(e.first, e.first + e.fingers):
                stiff = volumes_m3[i] + e.half - bulging / e.fingers * e.ambient
                _fill(e, gas, nodes[MANIFOLDS + i], MANIFOLDS + i, stiff, bulging / e.fingers)
        else:
            stiff = e.dead - bulging * e.ambient
            for i in range(e.first, e.first + e.fingers):
                stiff += volumes_m3[i]
            _fill(e, gas, nodes[k], k, stiff, bulging)


@inner
def settle(e: Any, node: F64, pressure: float, mass: float, dt: float, at: int, gas: F64) -> None:
    """`Vessel.settled`: write a node's gas at the step's end."""
    rt, n, stiff, soft = e.rt, e.exponent, node[STIFF], node[SOFT]
    gas[GAS_MASS, at] = mass
    if n == 1.0:
        gas[GAS_PRESSURE, at] = positive_root(soft, stiff, mass * rt)
        return
    cold = mass * rt
    excess = pressure * (stiff + soft * pressure) - cold
    p = positive_root(soft, stiff, cold + excess * math.exp(-dt / e.wall))
    gas[GAS_INVARIANT, at] = math.pow(p, 1.0 / n) * (stiff + soft * p)
    gas[GAS_PRESSURE, at] = p
