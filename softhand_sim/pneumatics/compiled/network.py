"""Compiled balance of one element: its manifold, and the chambers behind their tubes (`network`, `Branch`)."""

from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import inner
from softhand_sim.pneumatics.compiled.flows import heat_flow, mass_flow, tube_flow
from softhand_sim.pneumatics.compiled.layout import CAPACITY, CONTENT, GROWTH, GUESS, MANIFOLDS, MASS, PRESSURE, WARMTH
from softhand_sim.pneumatics.compiled.vessels import MAX_ITERATIONS, next_guess, positive_root, settle

F64 = npt.NDArray[np.float64]
Valves = npt.NDArray[np.uint8]


@inner
def _leaf(e: Any, leaf: F64, hub_warmth: float, hole: F64, hub: float, guess: float, dt: float) -> float:
    """`Branch.solve`: pressure of a chamber at the step's end for a manifold's pressure."""
    ambient, leaks, warmth = e.ambient, hole[0] > 0.0, leaf[WARMTH]
    if not leaks:
        # laminar flow has a closed form; the root lies between both pressures, which tells whose gas flows
        pull = dt * e.laminar * (hub_warmth if hub > leaf[PRESSURE] else warmth)
        p = positive_root(leaf[GROWTH] + pull, leaf[CAPACITY], leaf[CONTENT] + pull * hub * hub)
        if abs(hub * hub - p * p) <= e.crossing:
            return p
    low, high = min(leaf[PRESSURE], hub), max(leaf[PRESSURE], hub)
    if leaks:
        low, high = min(low, ambient), max(high, ambient)
    p = min(max(guess, low), high)
    for _ in range(MAX_ITERATIONS):
        flow, slope = tube_flow(e, hub * hub - p * p)
        weight = hub_warmth if flow > 0.0 else warmth
        residual = (leaf[CAPACITY] + leaf[GROWTH] * p) * p - leaf[CONTENT] - dt * weight * flow
        rise = leaf[CAPACITY] + 2.0 * leaf[GROWTH] * p + dt * weight * 2.0 * p * slope
        if leaks:
            flow, slope = heat_flow(hole, ambient, p, warmth)
            residual -= dt * flow
            rise -= dt * slope
        p, low, high, found = next_guess(p, low, high, residual, rise)
        if found:
            break
    return p


@inner
def _branch(
    e: Any, leaf: F64, hub_warmth: float, hole: F64, hub: float, guess: float, dt: float
) -> tuple[float, float, float]:
    """`Branch.inflow_and_slope`, and the chamber's pressure."""
    p = _leaf(e, leaf, hub_warmth, hole, hub, guess, dt)
    flow, slope = tube_flow(e, hub * hub - p * p)
    weight = hub_warmth if flow > 0.0 else leaf[WARMTH]
    flow, slope = weight * flow, weight * slope
    stiffness = leaf[CAPACITY] + 2.0 * leaf[GROWTH] * p + 2.0 * dt * p * slope
    if hole[0] > 0.0:
        stiffness -= dt * heat_flow(hole, e.ambient, p, leaf[WARMTH])[1]
    return -flow, -2.0 * hub * slope * (1.0 - 2.0 * dt * p * slope / stiffness), p


@inner
def _balance(
    e: Any, nodes: F64, k: int, open_: Valves, holes: F64, supply: float, p: float, dt: float
) -> tuple[float, float]:
    """Residual of a manifold's balance at a pressure, and its derivative; the chambers' pressures go to ``GUESS``."""
    hub, ambient, warmth = nodes[k], e.ambient, nodes[k, WARMTH]
    residual = (hub[CAPACITY] + hub[GROWTH] * p) * p - hub[CONTENT]
    rise = hub[CAPACITY] + 2.0 * hub[GROWTH] * p
    if open_[2 * k]:
        flow, slope = heat_flow(e.inlet, supply, p, warmth)
        residual -= dt * flow
        rise -= dt * slope
    if open_[2 * k + 1]:
        flow, slope = heat_flow(e.outlet, ambient, p, warmth)
        residual -= dt * flow
        rise -= dt * slope
    for i in range(e.first, e.first + e.fingers):
        if e.half > 0.0:
            leaf = nodes[MANIFOLDS + i]
            flow, slope, leaf[GUESS] = _branch(e, leaf, warmth, holes[i], p, leaf[GUESS], dt)
        elif holes[i, 0] > 0.0:
            flow, slope = heat_flow(holes[i], ambient, p, warmth)
        else:
            continue
        residual -= dt * flow
        rise -= dt * slope
    return residual, rise


@inner
def _manifold(e: Any, nodes: F64, k: int, open_: Valves, holes: F64, supply: float, dt: float) -> float:
    """Pressure of a manifold at the step's end (`solve_pressure`)."""
    ambient: float = e.ambient
    p: float = nodes[k, PRESSURE]
    low = high = p
    if open_[2 * k]:
        low, high = min(low, supply), max(high, supply)
    if open_[2 * k + 1]:
        low, high = min(low, ambient), max(high, ambient)
    for i in range(e.first, e.first + e.fingers):
        if holes[i, 0] > 0.0:
            low, high = min(low, ambient), max(high, ambient)
        if e.half > 0.0:
            low, high = min(low, nodes[MANIFOLDS + i, GUESS]), max(high, nodes[MANIFOLDS + i, GUESS])
    for _ in range(MAX_ITERATIONS):
        residual, rise = _balance(e, nodes, k, open_, holes, supply, p, dt)
        p, low, high, found = next_guess(p, low, high, residual, rise)
        if found:
            break
    return p


@inner
def shut_off(e: Any, k: int, open_: Valves, holes: F64) -> bool:
    """Whether no gas can move in an element: no tube between its vessels, no open valve, no leak."""
    moves = e.half > 0.0 or open_[2 * k] or open_[2 * k + 1]
    for i in range(e.first, e.first + e.fingers):
        moves = moves or holes[i, 0] > 0.0
    return not moves


@inner
def solve_element(e: Any, k: int, nodes: F64, open_: Valves, holes: F64, supply: float, dt: float) -> float:
    """First half of `network.advance` from filled nodes: find the manifold's pressure, return the mass it draws."""
    if shut_off(e, k, open_, holes):
        nodes[k, GUESS] = nodes[k, PRESSURE]
        return 0.0
    if e.half > 0.0:
        for i in range(e.first, e.first + e.fingers):
            nodes[MANIFOLDS + i, GUESS] = nodes[MANIFOLDS + i, PRESSURE]
    p = _manifold(e, nodes, k, open_, holes, supply, dt)
    nodes[k, GUESS] = p
    drawn: float = dt * mass_flow(e.inlet, supply, p, nodes[k, WARMTH]) if open_[2 * k] else 0.0
    return drawn


@inner
def settle_element(e: Any, k: int, nodes: F64, open_: Valves, holes: F64, supply: float, dt: float, gas: F64) -> None:
    """Second half: write the gas after the step at the manifold's pressure that was found."""
    ambient, warmth, p, inflow = e.ambient, nodes[k, WARMTH], nodes[k, GUESS], 0.0
    if open_[2 * k]:
        inflow += mass_flow(e.inlet, supply, p, warmth)
    if open_[2 * k + 1]:
        inflow += mass_flow(e.outlet, ambient, p, warmth)
    for i in range(e.first, e.first + e.fingers):
        if e.half > 0.0:
            leaf = nodes[MANIFOLDS + i]
            q = _leaf(e, leaf, warmth, holes[i], p, leaf[GUESS], dt)
            flow = tube_flow(e, q * q - p * p)[0]
            inflow += flow
            gained = -flow
            if holes[i, 0] > 0.0:
                gained += mass_flow(holes[i], ambient, q, leaf[WARMTH])
            settle(e, leaf, q, leaf[MASS] + dt * gained, dt, MANIFOLDS + i, gas)
        elif holes[i, 0] > 0.0:
            inflow += mass_flow(holes[i], ambient, p, warmth)
    settle(e, nodes[k], p, nodes[k, MASS] + dt * inflow, dt, k, gas)
