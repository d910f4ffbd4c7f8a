"""Compiled loop over whole steps of one world: wrist, actuation, engine."""

from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.kernel import AT_TICK, ENDED, NO_VOLUME, advance_world, move_wrists
from softhand_sim.actuation.layout import GIVEN
from softhand_sim.actuation.native import guarded_step
from softhand_sim.actuation.switching import tick_onoff
from softhand_sim.calibration.limits import HIGHEST, LOWEST, PRESSURES
from softhand_sim.compiling import entry, inner

F64 = npt.NDArray[np.float64]

FAILED = NO_VOLUME + 1
"""Why `run_world` returns, beside `ENDED`, `AT_TICK` and `NO_VOLUME`: the engine raised an error."""


@inner
def _look(hand: Any, world: Any, qpos: F64, extremes: F64) -> None:
    """`RangeWatch.look`; what is no number stays so."""
    for k in range(world.set.shape[0]):
        extremes[k] = np.maximum(extremes[k], world.set[k])
    for i in range(world.pressure.shape[0]):
        extremes[PRESSURES + i] = np.maximum(extremes[PRESSURES + i], world.pressure[i])
        joints = hand.joint_qpos.shape[1]
        for j in range(joints):
            angle, k = qpos[hand.joint_qpos[i, j]], i * joints + j
            extremes[HIGHEST + k] = np.maximum(extremes[HIGHEST + k], angle)
            extremes[LOWEST + k] = np.minimum(extremes[LOWEST + k], angle)


@inner
def _command(hand: Any, world: Any, wrist: F64, limits: F64, ctrl: F64, given: F64, step: int) -> None:
    """Move the wrist's reference, and take the recorded pressures of this step if there are such."""
    move_wrists(wrist[0], wrist[1], limits[0], limits[1])
    for j in range(6):
        ctrl[hand.wrist_ctrl[j]] = wrist[0, 0, j]
    if world.source == GIVEN:
        for i in range(given.shape[1]):
            world.pressure[i] = given[step, i]


@entry
def run_world(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    words: npt.NDArray[np.int64], elements: Any, hands: Any, worlds: Any, receiver: F64, ten_length: F64, qpos: F64,
    ctrl: F64, wrist: F64, limits: F64, extremes: F64, clock: F64, given: F64, noise: F64, dt: float,
    steps: int, begins: bool,
) -> tuple[int, int]:  # fmt: skip
    """Take steps of the only world of the arrays, as far as control ticks can be done here.

    Parameters
    ----------
    words
        Of the world's `EngineGuard`.
    elements, hands, worlds, receiver, ten_length, qpos, ctrl, dt
        As in `advance_hands`.
    wrist, limits
        The wrist's reference, which moves, and its target, (2, 1, 6); the longest move and turn of a step, (2,).
    extremes, clock
        Of a `RangeWatch`; the world's time, that of the next look (never where fingers have more than three hinges),
        and the time between looks [s], (3,).
    given
        Recorded pressures in the fingers [Pa gauge] for every step, (steps, 5), instead of the gas's; or none, (0, 5).
    noise
        Standard normal draws for the ON-OFF law's ticks to come, (m, 3); the first tick without is left to the caller.
    steps
        How many.
    begins
        Whether the first step begins; else it goes on after a tick.

    Returns
    -------
    done, why
        Steps taken, and `ENDED`, `AT_TICK`, `NO_VOLUME` or `FAILED`.
    """
    hand, world, ticks = hands[0], worlds[0], 0
    for done in range(steps):
        if begins:
            _command(hand, world, wrist, limits, ctrl[0], given, done)
        while True:
            state = advance_world(elements, hand, world, receiver, ten_length[0], qpos[0], ctrl[0], dt, begins)
            begins = False
            if state == ENDED:
                break
            if state == NO_VOLUME:
                return done, NO_VOLUME
            if ticks == noise.shape[0] or not tick_onoff(elements, hand, world, noise[ticks]):
                return done, AT_TICK
            ticks += 1
        begins = True
        if not guarded_step(words):
            return done, FAILED
        clock[0] += dt
        if clock[0] >= clock[1]:
            _look(hand, world, qpos[0], extremes)
            clock[1] = clock[0] + clock[2]
    return steps, ENDED
