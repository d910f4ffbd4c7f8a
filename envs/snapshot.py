"""An episode's whole state: engine, gas and controller, losses, wrist, task, and the generator of random numbers."""

from copy import copy, deepcopy
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.draw import Draw
from envs.episode import Episode
from envs.errors import BadStateError
from envs.task import Task
from softhand_sim.guards import checkpoint
from softhand_sim.guards.limits import Alarm

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """What `take` saw; any number of episodes may go on from it, bit for bit. It can be pickled to another process.

    The engine's data is kept whole beside the simulation's state: what a step derived is observed after it.
    """

    names: tuple[str, ...]
    draw: Draw
    data: mujoco.MjData
    simulation: dict[str, Vector]
    book: dict[str, Vector]
    alarm: Alarm | None
    task: Task
    rng: dict[str, Any]

    @classmethod
    def take(cls, episode: Episode, rng: Any) -> "Snapshot":
        """Return the state of an episode and of the generator ``rng`` (`numpy.random.Generator`)."""
        simulation = episode.here.simulation
        return cls(
            names=episode.spec.names,
            draw=episode.draw,
            data=copy(simulation.data),
            simulation=checkpoint.take(simulation),
            book=episode.guarding.book(),
            alarm=episode.guarding.alarm,
            task=episode.task.copy(),
            rng=deepcopy(rng.bit_generator.state),
        )

    def restore(self, episode: Episode, rng: Any) -> None:
        """Put an episode of the same environment, and its generator, into this state.

        Raises
        ------
        BadStateError
            If the environment has other objects, or its scene another layout.
        """
        if episode.spec.names != self.names:
            raise BadStateError(f"state of objects {list(self.names)}: this environment has {list(episode.spec.names)}")
        episode.enter(self.draw)
        simulation = episode.here.simulation
        mine, saved = simulation.data, self.data
        if mine.qpos.shape != saved.qpos.shape or mine.geom_xpos.shape != saved.geom_xpos.shape:
            raise BadStateError("state of a scene with other parts: was it saved with other objects or effects?")
        checkpoint.restore(simulation, self.simulation)
        # into the simulation's own data, which others hold views of
        mujoco.mj_copyData(mine, simulation.model, saved)
        episode.task = self.task.copy()
        episode.guarding.begin(episode.here, self.alarm, self.book)
        episode.look()
        rng.bit_generator.state = deepcopy(self.rng)
