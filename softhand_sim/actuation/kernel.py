"""Compiled step of many hands: gas between two ticks, the fingers' losses, and what goes to the engine."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.layout import GAS, SET
from softhand_sim.actuation.plain import MOST_BEND_RAD
from softhand_sim.actuation.switching import move_valves
from softhand_sim.compiling import entry, inner
from softhand_sim.pneumatics.compiled.gas import advance_gas
from softhand_sim.pneumatics.compiled.layout import GAS_PRESSURE, MANIFOLDS

F64 = npt.NDArray[np.float64]

TIME_TOLERANCE_S = 1e-9
"""As in `PneumaticSystem.step`."""
ENDED, AT_TICK, NO_VOLUME = range(3)
"""What became of a world's step: at its end, before a control tick, or no chamber to advance."""


@inner
def _measure(hand: Any, world: Any, ten_length: F64) -> bool:
    """Take elongations and chamber volumes from the engine; False if one is not a number that a chamber can have."""
    sound = True
    for i in range(world.volume.shape[0]):
        d = hand.straight[i] - ten_length[hand.tendon[i]]
        long = d + world.bulge[i] if hand.relieves else d
        volume = hand.volume + long * (hand.area + 0.5 * hand.area_slope * long)
        world.elongation[i], world.volume[i] = d, volume
        sound = sound and 0.0 < volume < math.inf
    return sound


@inner
def _next_event_s(hand: Any, world: Any) -> float:
    """Time until the next tick, delayed move of a valve or start of a leak."""
    event: float = world.to_tick
    if hand.delays:
        for j in range(world.waiting.shape[0]):
            event = min(event, world.waiting[j])
    if hand.leaks:
        for i in range(hand.leak_start.shape[0]):
            if hand.leak_start[i] - world.time > TIME_TOLERANCE_S:
                event = min(event, hand.leak_start[i] - world.time)
    return event


@inner
def _open_leaks(hand: Any, world: Any) -> None:
    for i in range(hand.holes.shape[0]):
        for c in range(hand.holes.shape[1]):
            hand.holes[i, c] = hand.leak[i, c] if hand.leak_start[i] - world.time <= TIME_TOLERANCE_S else 0.0


@inner
def _run_gas(elements: Any, hand: Any, world: Any, receiver: F64) -> bool:
    """Advance to the step's end or the next tick, split where valves move or leaks open; whether the end is reached."""
    while world.left > 0.0:
        if world.to_tick <= TIME_TOLERANCE_S:
            return False
        if hand.leaks:
            _open_leaks(hand, world)
        event = _next_event_s(hand, world)
        part = world.left if world.left <= event + TIME_TOLERANCE_S else event
        advance_gas(elements, world.gas, world.volume, world.open, hand.holes, receiver, hand.nodes, part)
        world.to_tick -= part
        if hand.delays:
            move_valves(world, part)
        world.time += part
        world.left -= part
    return True


@inner
def _write_pressures(elements: Any, hand: Any, world: Any, ctrl: F64) -> None:
    for i in range(world.pressure.shape[0]):
        k = hand.element[i]
        if world.source == GAS:
            node = MANIFOLDS + i if hand.tubes else k
            world.pressure[i] = world.gas[GAS_PRESSURE, node] - elements[k].ambient
        elif world.source == SET:
            world.pressure[i] = world.set[k]
        ctrl[hand.pressure_ctrl[i]] = world.pressure[i]


@inner
def _thrust(hand: Any, elongation: float, pressure: float) -> float:
    """`Relief.thrust_n`."""
    wall = elongation * (hand.wall_1 + elongation * (hand.wall_2 + elongation * hand.wall_3))
    thrust: float = pressure * (hand.area + hand.area_slope * elongation) - wall
    return thrust


@inner
def _relieve(hand: Any, world: Any, i: int, dt: float) -> float:
    """`Relief.step` of one finger: let its actuator out, and return the force that it costs."""
    elongation, pressure, bulge = world.elongation[i], world.pressure[i], world.bulge[i]
    before = _thrust(hand, elongation, pressure)
    if before <= hand.relief_thrust and bulge == 0.0:
        return 0.0
    long, spring = elongation + bulge, hand.relief_spring
    excess = _thrust(hand, long, pressure) - hand.relief_thrust - spring * bulge
    falls = hand.wall_1 + long * (2.0 * hand.wall_2 + 3.0 * hand.wall_3 * long) - pressure * hand.area_slope
    slow = hand.relief_time * (hand.wall_1 + spring)
    world.bulge[i] = max(0.0, bulge + dt * excess / (slow + dt * (max(falls, 0.0) + spring)))
    return _thrust(hand, elongation + world.bulge[i], pressure) - before


@inner
def _write_losses(hand: Any, world: Any, qpos: F64, ctrl: F64, dt: float) -> None:
    """`Losses.step`."""
    for i in range(world.slip.shape[0]):
        elongation, force = world.elongation[i], 0.0
        if hand.friction > 0.0:
            bend = 0.0
            for j in range(hand.joint_qpos.shape[1]):
                bend += abs(qpos[hand.joint_qpos[i, j]])
            area = hand.area + hand.area_slope * elongation
            reach = hand.friction * min(bend, MOST_BEND_RAD) * world.pressure[i] * area
            stretch = min(max(elongation - world.slip[i], -reach), reach)
            world.slip[i] = elongation - stretch
            force = -hand.friction_stiffness * stretch
        for b in range(hand.branches):
            flow = elongation + math.exp(-dt / hand.branch_time[b]) * (world.flow[b, i] - elongation)
            world.flow[b, i] = flow
            force -= hand.branch_stiffness[b] * (elongation - flow)
        if hand.relieves:
            force += _relieve(hand, world, i, dt)
        ctrl[hand.loss_ctrl[i]] = force


@inner
def advance_world(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    elements: Any, hand: Any, world: Any, receiver: F64, ten_length: F64, qpos: F64, ctrl: F64, dt: float, begins: bool
) -> int:
    """Advance one world as `advance_hands` does; `ENDED`, `AT_TICK` or `NO_VOLUME`."""
    if begins:
        if not _measure(hand, world, ten_length) and world.source == GAS:
            return NO_VOLUME
        world.left = dt
    if world.source == GAS and not _run_gas(elements, hand, world, receiver):
        return AT_TICK
    world.left = 0.0
    _write_pressures(elements, hand, world, ctrl)
    if hand.losses:
        _write_losses(hand, world, qpos, ctrl, dt)
    return ENDED


@entry
def advance_hands(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    elements: Any, hands: Any, worlds: Any, receiver: F64, ten_length: F64, qpos: F64, ctrl: F64, dt: float,
    begins: bool,
) -> int:  # fmt: skip
    """Advance all worlds to the end of a step, or to a control tick inside it.

    Parameters
    ----------
    elements, hands, worlds, receiver
        `layout` of gas and hand: (3,), (1,), (n,), (3,) or (0,).
    ten_length, qpos, ctrl
        The engine's arrays, one row a world.
    dt
        Step [s].
    begins
        Whether the step begins; else it goes on after ticks.

    Returns
    -------
    int
        How many worlds wait for a tick; or -1 - w if the chambers of world w have no volume.
    """
    hand, waiting = hands[0], 0
    for w in range(worlds.shape[0]):
        if not begins and worlds[w].left <= 0.0:
            continue
        state = advance_world(elements, hand, worlds[w], receiver, ten_length[w], qpos[w], ctrl[w], dt, begins)
        if state == NO_VOLUME:
            return -1 - w
        waiting += state
    return waiting


@entry
def move_wrists(reference: F64, target: F64, largest_m: float, largest_rad: float) -> None:
    """`wrist.limited_step` of n wrists, (n, 6), in place."""
    for w in range(reference.shape[0]):
        x, y, z = target[w, 0] - reference[w, 0], target[w, 1] - reference[w, 1], target[w, 2] - reference[w, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        share = largest_m / distance if distance > largest_m else 1.0
        reference[w, 0] += x * share
        reference[w, 1] += y * share
        reference[w, 2] += z * share
        for j in range(3, 6):
            reference[w, j] += min(max(target[w, j] - reference[w, j], -largest_rad), largest_rad)
