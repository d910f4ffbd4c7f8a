"""An episode's whole state: engine, gas and controller, losses, wrist, task, and the generator of random numbers."""

from copy import copy, deepcopy
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from envs.draw import Draw
from envs.episode import Episode
from envs.errors import BadStateError
from envs.task import Task

_OF_SIMULATION = (
    "wrist_reference",
    "wrist_target",
    "set_pressure_pa_gauge",
    "range_watch",
    "loss_state",
    "gas",
    "_next_look_s",
)


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """What `take` saw; any number of episodes may go on from it, bit for bit. It can be pickled to another process.

    The engine's data is kept whole, not only its state: a step starts from what the step before it derived.
    """

    names: tuple[str, ...]
    draw: Draw
    data: mujoco.MjData
    simulation: dict[str, Any]
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
            simulation={name: deepcopy(getattr(simulation, name)) for name in _OF_SIMULATION},
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
        # a world of its own may never have been reset
        simulation.reset(np.random.default_rng(0), self.simulation["wrist_reference"])
        # into the simulation's own data, which others hold views of
        mujoco.mj_copyData(mine, simulation.model, saved)
        for name, value in self.simulation.items():
            setattr(simulation, name, deepcopy(value))
        episode.task = self.task.copy()
        episode.look()
        rng.bit_generator.state = deepcopy(self.rng)
