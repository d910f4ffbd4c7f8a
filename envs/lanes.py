"""Episodes side by side: each steps its own simulation, several at once on threads."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import count

import mujoco
import numpy as np
import numpy.typing as npt

from envs.episode import Episode

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class Lanes:
    """Episodes that are advanced together; each is as it would be alone, to the bit, for any number of threads.

    The steps of an episode's action are compiled code and the engine's own (`HandSimulation.advance`), during which
    other threads run.

    Parameters
    ----------
    episodes
        At least one.
    threads
        Including the caller's; 0 for as many as there are processors.
    """

    def __init__(self, episodes: Sequence[Episode], threads: int) -> None:
        self._episodes = tuple(episodes)
        helpers = min(threads or _processors(), len(self._episodes)) - 1
        self._helpers = helpers
        self._pool = ThreadPoolExecutor(helpers, thread_name_prefix="lanes") if helpers > 0 else None

    def advance(self, chosen: Sequence[int], then: Callable[[int], None]) -> None:
        """Advance some episodes by one action, and do what is to be done with each, in whichever thread had it.

        One lane's Python runs while others are in the engine.
        """
        # each thread takes the next one that is left: they differ in contacts, and so in time
        order, left = tuple(chosen), count()

        def work() -> None:
            while (k := next(left)) < len(order):
                self._episodes[order[k]].advance()
                then(order[k])

        pool = self._pool
        helping: list[Future[None]] = [] if pool is None else [pool.submit(work) for _ in range(self._helpers)]
        try:
            work()
        finally:
            for future in helping:
                future.result()

    def state(self) -> npt.NDArray[np.float64]:
        """Return a copy of the engine's full state, one row a lane."""
        rows = []
        for episode in self._episodes:
            simulation = episode.here.simulation
            rows.append(np.empty(mujoco.mj_stateSize(simulation.model, _STATE)))
            mujoco.mj_getState(simulation.model, simulation.data, rows[-1], _STATE)
        return np.array(rows)

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
