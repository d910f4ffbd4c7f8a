"""Compiled control ticks: sensors, the ON-OFF law, and valves that move late."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import entry, inner
from softhand_sim.control.onoff import MEMORY_SIZE
from softhand_sim.pneumatics.compiled.layout import GAS_PRESSURE, PRESSURE
from softhand_sim.pneumatics.compiled.vessels import fill_nodes

F64 = npt.NDArray[np.float64]

_TIME_TOLERANCE_S = 1e-9


@inner
def move_valves(world: Any, dt: float) -> None:
    """`delay.moved`: let ``dt`` [s] pass for valves that wait."""
    for j in range(6):
        world.waiting[j] -= dt
        if world.waiting[j] <= _TIME_TOLERANCE_S:
            world.open[j] = 1 - world.open[j]
            world.waiting[j] = math.inf


@inner
def _read(hand: Any, pressure: float, noise: float) -> float:
    """`PressureSensor.read_pa_abs`."""
    seen = min(max(pressure + hand.offset, hand.low), hand.high)
    volts = hand.volts * (0.004e-3 * seen - 0.04) + hand.noise_v * noise
    count = min(max(math.floor(volts / hand.volts * hand.counts), 0), hand.counts - 1)
    reading: float = ((count + 0.5) / hand.counts + 0.04) / 0.004e-3
    return reading


@inner
def _decide(hand: Any, error: float, set_gauge: float, rise: float, fall: float, inlet: bool, outlet: bool) -> int:
    """`OnOffController._decide`: 1 for an open inlet, 2 for an open outlet."""
    if set_gauge <= 0.0:
        return 2 if -error > (0.0 if outlet else hand.dead_band) else 0
    going_on, beginning = 1.0 + hand.dead_ticks, hand.minimum_ticks
    inlet_at = rise * going_on if inlet else max(hand.dead_band, rise * beginning)
    outlet_at = fall * going_on if outlet else max(hand.dead_band, fall * beginning)
    return (1 if error > inlet_at else 0) + (2 if -error > outlet_at else 0)


@inner
def _command(hand: Any, world: Any, k: int) -> None:
    """`OnOffController.command` of one element."""
    memory = world.memory[k * MEMORY_SIZE : (k + 1) * MEMORY_SIZE]
    inlet, outlet, last, rise, fall, ticks_open = memory[0], memory[1], memory[2], memory[3], memory[4], memory[5]
    reading, now = world.reading[k], int(memory[0]) + 2 * int(memory[1])
    part = hand.dead_ticks > 0.0 and ticks_open == 1.0
    if hand.lookahead and inlet != 0.0:
        rise = max(reading - last, rise if part else 0.0)
    if hand.lookahead and outlet != 0.0:
        fall = max(last - reading, fall if part else 0.0)
    command = now
    if not 0.0 < ticks_open < hand.minimum_ticks:
        error = world.set[k] - (reading - hand.control_ambient)
        command = _decide(hand, error, world.set[k], rise, fall, inlet != 0.0, outlet != 0.0)
    ticks_open = ticks_open + 1.0 if command == now else 1.0
    if command == 0:
        ticks_open = 0.0
    world.wanted[2 * k], world.wanted[2 * k + 1] = command & 1, command >> 1
    memory[0], memory[1], memory[2], memory[3] = command & 1, command >> 1, reading, rise
    memory[4], memory[5] = fall, ticks_open


@inner
def _switch(hand: Any, world: Any) -> None:
    """Let the valves take the wanted positions, at once or late (`ValveDelay.request`); the tick is over."""
    for j in range(6):
        if not hand.delays:
            world.open[j] = world.wanted[j]
        elif world.open[j] == world.wanted[j]:
            world.waiting[j] = math.inf
        else:
            world.waiting[j] = min(world.waiting[j], hand.opening if world.wanted[j] else hand.closing)
    if hand.delays:
        move_valves(world, 0.0)
    world.ticks += 1
    world.to_tick += hand.tick


@inner
def _sets_are_sound(hand: Any, world: Any) -> bool:
    sound = True
    for k in range(3):
        sound = sound and 0.0 <= world.set[k] <= hand.highest_set[k]
    return sound


@inner
def read_world(elements: Any, hand: Any, world: Any, noise: F64) -> None:
    """Read the sensors of a world at its present volumes, with standard normal draws, (3,)."""
    if not hand.tubes:
        fill_nodes(elements, world.gas, world.volume, hand.nodes)
    for k in range(3):
        pressure = world.gas[GAS_PRESSURE, k] if hand.tubes else hand.nodes[k, PRESSURE]
        world.reading[k] = _read(hand, pressure, noise[k]) if hand.senses else pressure


@inner
def tick_onoff(elements: Any, hand: Any, world: Any, noise: F64) -> bool:
    """Let a world's ON-OFF law read, command and switch; False, and nothing done, if a set pressure is out of range."""
    if not _sets_are_sound(hand, world):
        return False
    read_world(elements, hand, world, noise)
    for k in range(3):
        _command(hand, world, k)
    _switch(hand, world)
    return True


@entry
def read_sensors(elements: Any, hands: Any, worlds: Any, due: npt.NDArray[np.int64], noise: F64) -> int:
    """Read the sensors of the worlds that are due, at their present volumes.

    Parameters
    ----------
    elements, hands, worlds
        As in `advance_hands`.
    due
        Worlds whose tick it is, (m,).
    noise
        Standard normal draws, (m, 3).

    Returns
    -------
    int
        The first world with a set pressure out of range, where nothing was done; -1 if there is none.
    """
    hand = hands[0]
    for w in due:
        if not _sets_are_sound(hand, worlds[w]):
            return int(w)
    for m in range(due.shape[0]):
        read_world(elements, hand, worlds[due[m]], noise[m])
    return -1


@entry
def command_onoff(hands: Any, worlds: Any, due: npt.NDArray[np.int64]) -> None:
    """Let the ON-OFF law command the valves of the worlds that are due."""
    for w in due:
        for k in range(3):
            _command(hands[0], worlds[w], k)


@entry
def switch_valves(hands: Any, worlds: Any, due: npt.NDArray[np.int64]) -> None:
    """Let the valves of the worlds that are due go where they are wanted."""
    for w in due:
        _switch(hands[0], worlds[w])
