"""The gas balance of all elements as compiled loops over arrays.

The same formulas, in the same order, as `Element` and `network`, which stay the reference and run where numba is
missing. Imported only where it is installed. Everything is in this one file, since numba's cache of a function
notices changes of that function's own file alone.

Nodes: manifolds of the elements first, then, where the tubes resist, the chambers of the fingers.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
import numpy.typing as npt

from softhand_sim.pneumatics.element import LARGEST_PART, MOST_PARTS

F64 = npt.NDArray[np.float64]
_Valves = tuple[bool, bool, bool, bool, bool, bool]
_Function = TypeVar("_Function", bound=Callable[..., Any])

# columns of an element's parameters; four each for an orifice: choked coefficient, b, laminar ratio and coefficient
INLET, OUTLET, DEAD, BULGING, SUPPLY, AMBIENT, RT = 0, 4, 8, 9, 10, 11, 12
HALF, LAMINAR, CROSSING_FLOW, CROSSING, EXPONENT, WALL, FIRST, FINGERS = 13, 14, 15, 16, 17, 18, 19, 20
COLUMNS = 21
# columns of a node's scratch
STIFF, SOFT, CAPACITY, GROWTH, CONTENT, PRESSURE, WARMTH, MASS = range(8)
# rows of the gas
GAS_MASS, GAS_INVARIANT, GAS_PRESSURE = range(3)

_TOLERANCE, _RECEIVER_TOLERANCE, _MAX_ITERATIONS = 1e-12, 1e-12, 100


def _compiled(function: _Function) -> _Function:
    """Compile on first use and keep the machine code on disk, or in memory where no cache folder is writable."""
    options = {"nogil": True, "error_model": "numpy"}
    try:
        kernel: _Function = numba.njit(cache=True, **options)(function)
    except RuntimeError:
        kernel = numba.njit(**options)(function)
    return kernel


@_compiled
def _root(a: float, b: float, c: float) -> float:
    return 2.0 * c / (b + math.sqrt(b * b + 4.0 * a * c))


@_compiled
def _orifice(o: F64, at: int, reservoir: float, chamber: float) -> tuple[float, float]:
    """`Orifice.inflow_and_slope` with the parameters o[at : at + 4]."""
    k, b, laminar = o[at], o[at + 1], o[at + 2]
    if chamber <= reservoir:
        ratio = chamber / reservoir
        if ratio <= b:
            return k * reservoir, 0.0
        if ratio < laminar:
            s = (ratio - b) / (1.0 - b)
            root = math.sqrt(1.0 - s * s)
            return k * reservoir * root, -k * s / ((1.0 - b) * root)
    else:
        ratio = reservoir / chamber
        if ratio <= b:
            return -k * chamber, -k
        if ratio < laminar:
            s = (ratio - b) / (1.0 - b)
            root = math.sqrt(1.0 - s * s)
            return -k * chamber * root, -k * (root + ratio * s / ((1.0 - b) * root))
    linear = o[at + 3]
    return linear * (reservoir - chamber), -linear


@_compiled
def _heat(o: F64, at: int, reservoir: float, chamber: float, warmth: float) -> tuple[float, float]:
    """Flow and slope of an orifice to a reservoir at room temperature, weighed by heat (`Warmed`)."""
    flow, slope = _orifice(o, at, reservoir, chamber)
    if warmth != 1.0 and flow <= 0.0:
        weight = math.sqrt(warmth)
        return weight * flow, weight * slope
    return flow, slope


@_compiled
def _mass_flow(o: F64, at: int, reservoir: float, chamber: float, warmth: float) -> float:
    flow, _ = _orifice(o, at, reservoir, chamber)
    return flow / math.sqrt(warmth) if warmth != 1.0 and flow <= 0.0 else flow


@_compiled
def _tube(e: F64, difference: float) -> tuple[float, float]:
    """`Tube.flow_and_slope`."""
    size = abs(difference)
    if size <= e[CROSSING]:
        return e[LAMINAR] * difference, e[LAMINAR]
    flow = e[CROSSING_FLOW] * (size / e[CROSSING]) ** (4.0 / 7.0)
    return math.copysign(flow, difference), 4.0 / 7.0 * flow / size


@_compiled
def _vessel(e: F64, mass: float, invariant: float, node: F64, stiff: float, soft: float) -> None:
    """`Vessel`: fill a node's scratch from its gas."""
    rt, n = e[RT], e[EXPONENT]
    node[STIFF], node[SOFT], node[MASS] = stiff, soft, mass
    if n == 1.0:
        node[PRESSURE] = _root(soft, stiff, mass * rt)
        node[CAPACITY], node[GROWTH], node[CONTENT] = stiff / rt, soft / rt, mass
        node[WARMTH] = 1.0
        return
    p = math.pow(invariant / stiff, n)
    if soft != 0.0:
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


@_compiled
def _settle(e: F64, node: F64, pressure: float, mass: float, dt: float, at: int, gas: F64) -> None:
    """`Vessel.settled`: write a node's gas at the step's end."""
    rt, n, stiff, soft = e[RT], e[EXPONENT], node[STIFF], node[SOFT]
    gas[GAS_MASS, at] = mass
    if n == 1.0:
        gas[GAS_PRESSURE, at] = _root(soft, stiff, mass * rt)
        return
    cold = mass * rt
    excess = pressure * (stiff + soft * pressure) - cold
    p = _root(soft, stiff, cold + excess * math.exp(-dt / e[WALL]))
    gas[GAS_INVARIANT, at] = math.pow(p, 1.0 / n) * (stiff + soft * p)
    gas[GAS_PRESSURE, at] = p


@_compiled
def _leaf(e: F64, leaf: F64, hub_warmth: float, hole: F64, hub: float, guess: float, dt: float) -> float:
    """`Branch.solve`: pressure of a chamber at the step's end for a manifold's pressure."""
    ambient, leaks, warmth = e[AMBIENT], hole[0] > 0.0, leaf[WARMTH]
    if not leaks and e[EXPONENT] == 1.0:
        pull = dt * e[LAMINAR]
        p = _root(leaf[GROWTH] + pull, leaf[CAPACITY], leaf[CONTENT] + pull * hub * hub)
        if abs(hub * hub - p * p) <= e[CROSSING]:
            return p
    low, high = min(leaf[PRESSURE], hub), max(leaf[PRESSURE], hub)
    if leaks:
        low, high = min(low, ambient), max(high, ambient)
    p = float(min(max(guess, low), high))
    for _ in range(_MAX_ITERATIONS):
        flow, slope = _tube(e, hub * hub - p * p)
        weight = hub_warmth if flow > 0.0 else warmth
        residual = (leaf[CAPACITY] + leaf[GROWTH] * p) * p - leaf[CONTENT] - dt * weight * flow
        rise = leaf[CAPACITY] + 2.0 * leaf[GROWTH] * p + dt * weight * 2.0 * p * slope
        if leaks:
            flow, slope = _heat(hole, 0, ambient, p, warmth)
            residual -= dt * flow
            rise -= dt * slope
        if residual > 0.0:
            high = p
        elif residual < 0.0:
            low = p
        else:
            return p
        newton = float(p - residual / rise)
        if abs(newton - p) <= _TOLERANCE * p:
            return float(min(max(newton, low), high))
        p = newton if low < newton < high else 0.5 * (low + high)
    return p


@_compiled
def _branch(
    e: F64, leaf: F64, hub_warmth: float, hole: F64, hub: float, guess: float, dt: float
) -> tuple[float, float, float]:
    """`Branch.inflow_and_slope`, and the chamber's pressure."""
    p = _leaf(e, leaf, hub_warmth, hole, hub, guess, dt)
    flow, slope = _tube(e, hub * hub - p * p)
    weight = hub_warmth if flow > 0.0 else leaf[WARMTH]
    flow, slope = weight * flow, weight * slope
    stiffness = leaf[CAPACITY] + 2.0 * leaf[GROWTH] * p + 2.0 * dt * p * slope
    if hole[0] > 0.0:
        stiffness -= dt * _heat(hole, 0, e[AMBIENT], p, leaf[WARMTH])[1]
    return -flow, -2.0 * hub * slope * (1.0 - 2.0 * dt * p * slope / stiffness), p


@_compiled
def _balance(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    e: F64, nodes: F64, k: int, open_: _Valves, holes: F64, supply: float, p: float, guesses: F64, dt: float
) -> tuple[float, float]:
    """Residual of a manifold's balance at a pressure, and its derivative; the chambers' pressures go to ``guesses``."""
    hub, ambient, warmth, first = nodes[k], e[AMBIENT], nodes[k, WARMTH], int(e[FIRST])
    residual = (hub[CAPACITY] + hub[GROWTH] * p) * p - hub[CONTENT]
    rise = hub[CAPACITY] + 2.0 * hub[GROWTH] * p
    if open_[2 * k]:
        flow, slope = _heat(e, INLET, supply, p, warmth)
        residual -= dt * flow
        rise -= dt * slope
    if open_[2 * k + 1]:
        flow, slope = _heat(e, OUTLET, ambient, p, warmth)
        residual -= dt * flow
        rise -= dt * slope
    for j in range(guesses.shape[0]):
        i = first + j
        if e[HALF] > 0.0:
            flow, slope, guesses[j] = _branch(e, nodes[3 + i], warmth, holes[i], p, guesses[j], dt)
        elif holes[i, 0] > 0.0:
            flow, slope = _heat(holes[i], 0, ambient, p, warmth)
        else:
            continue
        residual -= dt * flow
        rise -= dt * slope
    return residual, rise


@_compiled
def _manifold(e: F64, nodes: F64, k: int, open_: _Valves, holes: F64, supply: float, guesses: F64, dt: float) -> float:
    """Pressure of a manifold at the step's end (`solve_pressure`)."""
    ambient, first = e[AMBIENT], int(e[FIRST])
    p = float(nodes[k, PRESSURE])
    low = high = p
    if open_[2 * k]:
        low, high = min(low, supply), max(high, supply)
    if open_[2 * k + 1]:
        low, high = min(low, ambient), max(high, ambient)
    for j in range(guesses.shape[0]):
        if holes[first + j, 0] > 0.0:
            low, high = min(low, ambient), max(high, ambient)
        if e[HALF] > 0.0:
            low, high = min(low, guesses[j]), max(high, guesses[j])
    for _ in range(_MAX_ITERATIONS):
        residual, rise = _balance(e, nodes, k, open_, holes, supply, p, guesses, dt)
        if residual > 0.0:
            high = p
        elif residual < 0.0:
            low = p
        else:
            return p
        newton = float(p - residual / rise)
        if abs(newton - p) <= _TOLERANCE * p:
            return float(min(max(newton, low), high))
        p = newton if low < newton < high else 0.5 * (low + high)
    return p


@_compiled
def _element(e: F64, k: int, nodes: F64, open_: _Valves, holes: F64, supply: float, dt: float, after: F64) -> float:
    """`network.advance` from filled nodes: write the gas after the step, return the mass drawn from the supply."""
    ambient, first, warmth = e[AMBIENT], int(e[FIRST]), nodes[k, WARMTH]
    guesses = np.empty(int(e[FINGERS]))
    for j in range(guesses.shape[0]):
        guesses[j] = nodes[3 + first + j, PRESSURE] if e[HALF] > 0.0 else 0.0
    p = _manifold(e, nodes, k, open_, holes, supply, guesses, dt)
    drawn, inflow = 0.0, 0.0
    if open_[2 * k]:
        drawn = _mass_flow(e, INLET, supply, p, warmth)
        inflow += drawn
    if open_[2 * k + 1]:
        inflow += _mass_flow(e, OUTLET, ambient, p, warmth)
    for j in range(guesses.shape[0]):
        i = first + j
        if e[HALF] > 0.0:
            leaf = nodes[3 + i]
            q = _leaf(e, leaf, warmth, holes[i], p, guesses[j], dt)
            flow = _tube(e, q * q - p * p)[0]
            inflow += flow
            gained = -flow
            if holes[i, 0] > 0.0:
                gained += _mass_flow(holes[i], 0, ambient, q, leaf[WARMTH])
            _settle(e, leaf, q, leaf[MASS] + dt * gained, dt, 3 + i, after)
        elif holes[i, 0] > 0.0:
            inflow += _mass_flow(holes[i], 0, ambient, p, warmth)
    _settle(e, nodes[k], p, nodes[k, MASS] + dt * inflow, dt, k, after)
    return dt * drawn


@_compiled
def _feed(
    elements: F64, nodes: F64, open_: _Valves, holes: F64, supply: float, with_inlet: bool, dt: float, after: F64
) -> float:
    """Advance the elements whose inlet is open (or shut); a supply below 0 stands for each element's own."""
    drawn = 0.0
    for k in range(elements.shape[0]):
        if open_[2 * k] == with_inlet:
            own = elements[k, SUPPLY] if supply < 0.0 else supply
            drawn += _element(elements[k], k, nodes, open_, holes, own, dt, after)
    return drawn


@_compiled
def _receive(
    elements: F64, nodes: F64, open_: _Valves, holes: F64, receiver: F64, mass: float, dt: float, after: F64
) -> float:
    """`solve_receiver`: advance the elements with open inlets, return the mass in the receiver."""
    volume, largest, droop = receiver[0], receiver[1], receiver[2]
    wanted, capacity = elements[0, SUPPLY], volume / elements[0, RT]
    start = mass / capacity
    low, high = min(start, elements[0, AMBIENT]), max(start, wanted)
    for i in range(nodes.shape[0]):
        low, high = min(low, nodes[i, PRESSURE]), max(high, nodes[i, PRESSURE])
    p = before = start
    residual_before, gained = 0.0, 0.0
    for iteration in range(_MAX_ITERATIONS):
        refill = largest * min(max((wanted - p) / droop, 0.0), 1.0)
        gained = dt * refill - _feed(elements, nodes, open_, holes, p, True, dt, after)
        residual = capacity * p - mass - gained
        if residual > 0.0:
            high = min(high, p)
        else:
            low = max(low, p)
        slope = capacity if iteration == 0 else (residual - residual_before) / (p - before)
        following = p - residual / slope if slope > 0.0 else 0.5 * (low + high)
        if residual == 0.0 or abs(following - p) <= _RECEIVER_TOLERANCE * p:
            break
        before, residual_before = p, residual
        p = following if low < following < high else 0.5 * (low + high)
    return mass + gained


@_compiled
def _fill(elements: F64, gas: F64, volumes_m3: F64, nodes: F64) -> None:
    """`network.vessels` of all elements."""
    for k in range(elements.shape[0]):
        e = elements[k]
        first, fingers, bulging = int(e[FIRST]), int(e[FINGERS]), e[BULGING]
        if e[HALF] > 0.0:
            _vessel(e, gas[GAS_MASS, k], gas[GAS_INVARIANT, k], nodes[k], e[DEAD] - fingers * e[HALF], 0.0)
            for i in range(first, first + fingers):
                stiff = volumes_m3[i] + e[HALF] - bulging / fingers * e[AMBIENT]
                soft = bulging / fingers
                _vessel(e, gas[GAS_MASS, 3 + i], gas[GAS_INVARIANT, 3 + i], nodes[3 + i], stiff, soft)
        else:
            stiff = e[DEAD] - bulging * e[AMBIENT]
            for i in range(first, first + fingers):
                stiff += volumes_m3[i]
            _vessel(e, gas[GAS_MASS, k], gas[GAS_INVARIANT, k], nodes[k], stiff, bulging)


@_compiled
def _parts(elements: F64, volumes_m3: F64, open_: _Valves, holes: F64, dt: float) -> int:
    """`Element.parts` of the element that wants most."""
    parts = 1
    for k in range(elements.shape[0]):
        e, volume = elements[k], elements[k, DEAD]
        fastest = e[INLET] if open_[2 * k] else 0.0
        if open_[2 * k + 1]:
            fastest = max(fastest, e[OUTLET])
        for i in range(int(e[FIRST]), int(e[FIRST]) + int(e[FINGERS])):
            volume += volumes_m3[i]
            fastest = max(fastest, holes[i, 0])
        parts = max(parts, math.ceil(dt * fastest / (volume / e[RT] * LARGEST_PART)))
    return min(parts, MOST_PARTS)


@_compiled
def advance_gas(elements: F64, gas: F64, volumes_m3: F64, open_: _Valves, holes: F64, receiver: F64, dt: float) -> F64:
    """Return the gas after ``dt`` [s], in the form of ``gas``.

    Parameters
    ----------
    elements
        Parameters of the elements, shape (3, COLUMNS).
    gas
        Rows: mass [kg], invariant and pressure [Pa abs]; columns: nodes, 3 or 8, then the receiver (mass only).
    volumes_m3
        Chamber volumes (5,).
    open_
        Whether inlet and outlet of each element are open, (6,).
    holes
        Orifice parameters of each finger's leak, (5, 4); zero for none.
    receiver
        Volume [m3], largest flow [kg/s] and droop [Pa] of the supply, (3,), or empty.
    dt
        Step [s].
    """
    last = gas.shape[1] - 1
    after, nodes = gas.copy(), np.empty((last, 8))
    parts = _parts(elements, volumes_m3, open_, holes, dt)
    step = dt / parts
    for _ in range(parts):
        _fill(elements, after, volumes_m3, nodes)
        _feed(elements, nodes, open_, holes, -1.0, False, step, after)
        if receiver.shape[0] > 0:
            mass = after[GAS_MASS, last]
            after[GAS_MASS, last] = _receive(elements, nodes, open_, holes, receiver, mass, step, after)
        else:
            _feed(elements, nodes, open_, holes, -1.0, True, step, after)
    return after
