"""The Gymnasium environment around one world's episodes, whatever the task."""

from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from envs.config import EnvConfig
from envs.episode import Episode
from envs.observations import ObservationMode
from envs.rendering import RENDER_MODES, Pictures
from envs.snapshot import Snapshot
from envs.task import Task
from envs.world import WorldPool

Vector = npt.NDArray[np.float64]
Info = dict[str, Any]


class SoftHandEnv(gymnasium.Env[Any, Any]):
    """See `envs.grasp` and `envs.reorient`; the keywords are those of `envs.config.EnvConfig`."""

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 25}  # noqa: RUF012 - as Gymnasium has it

    def __init__(self, task: Task, config: EnvConfig, render_mode: str | None = None) -> None:
        if render_mode not in (None, *RENDER_MODES):
            raise ValueError(f"render_mode = {render_mode!r}: must be None or one of {', '.join(RENDER_MODES)}")
        self.render_mode = render_mode
        self.metadata = {**type(self).metadata, "render_fps": round(1.0 / config.control_period_s)}
        scenes = config.scenes()
        spec = config.spec(scenes, task)
        self._episode = Episode(spec, WorldPool(scenes), task)
        self._mode, self._camera_size = config.mode, config.camera
        self._pictures = Pictures()
        self.action_space = spec.action.space
        self.observation_space = observation_space(config, spec.layout.space, task)
        if config.mode is ObservationMode.GOAL:
            # learning libraries take any environment that has this method for one with goals
            self.compute_reward = self._goal_reward

    @property
    def episode(self) -> Episode:
        """What runs inside: world, simulation, task, for scripts and experts."""
        return self._episode

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Info]:
        """Start a new episode; ``info`` tells what was drawn. See the class for ``options``.

        Raises
        ------
        BadOptionError
            If an option is unknown, or its value not allowed.
        """
        super().reset(seed=seed)
        drawn = self._episode.reset(self.np_random, options or {})
        observation = self._observed()
        info = self._episode.judge(0.0)[2]
        if self.render_mode == "human":
            self.render()
        return observation, info | drawn

    def step(self, action: npt.ArrayLike) -> tuple[Any, float, bool, bool, Info]:
        """Advance by one control period.

        Raises
        ------
        BadActionError
            If the action has a wrong shape or a value that the space does not hold; nothing was advanced.
        RuntimeError
            Before the first reset.
        """
        episode = self._episode
        episode.command(action)
        episode.advance()
        observation = self._observed()
        reward, terminated, info = episode.judge(episode.spec.control_period_s)
        if self.render_mode == "human":
            self.render()
        return observation, reward, terminated, False, info

    def save(self) -> Snapshot:
        """Return the episode's whole state, the generator's included; `load` goes on from it bit for bit.

        Steps counted by a ``TimeLimit`` around the environment are that wrapper's own.
        """
        return Snapshot.take(self._episode, self.np_random)

    def load(self, state: Snapshot) -> Any:
        """Go to a saved state and return its observation.

        Raises
        ------
        BadStateError
            If it belongs to another environment.
        """
        state.restore(self._episode, self.np_random)
        return self._observed()

    def render(self) -> npt.NDArray[Any] | None:
        """Return a picture: RGB (480, 640, 3) uint8, or depth [m] (480, 640) float32; None for a window or no mode.

        Raises
        ------
        RenderUnavailableError
            If this machine has no OpenGL library or, for a window, no screen; the message says what to do.
        """
        if self.render_mode is None:
            return None
        return self._pictures.render(self._episode.here, self.render_mode)

    def close(self) -> None:
        """Free windows and GL contexts."""
        self._pictures.close()

    def _goal_reward(self, achieved_goal: Vector, desired_goal: Vector, info: Any) -> Any:
        """Return the sparse reward of goals (g,) or (n, g), for hindsight: 0 where reached, -1 elsewhere."""
        del info
        reward = self._episode.task.goal_reward(np.asarray(achieved_goal), np.asarray(desired_goal))
        return float(reward) if reward.ndim == 0 else reward

    def _observed(self) -> Any:
        size = self._camera_size
        picture = None if size is None else self._pictures.camera(self._episode.here, size)
        return observed(self._episode, self._mode, picture)


def observed(episode: Episode, mode: ObservationMode, picture: npt.NDArray[np.uint8] | None = None) -> Any:
    """Return an episode's observation in a mode: the vector, or a dict with goals or a picture."""
    vector = episode.observe()
    if mode is not ObservationMode.GOAL and picture is None:
        return vector
    seen: dict[str, Any] = {"observation": vector}
    if mode is ObservationMode.GOAL:
        seen["achieved_goal"], seen["desired_goal"] = episode.goals()
    if picture is not None:
        seen["camera"] = picture
    return seen


def observation_space(config: EnvConfig, vector: spaces.Box, task: Task) -> spaces.Space[Any]:
    """Return the space of a mode's observations: a box, or a dict with goals or a picture."""
    if config.mode is not ObservationMode.GOAL and config.camera is None:
        return vector
    parts: dict[str, spaces.Space[Any]] = {"observation": vector}
    if config.mode is ObservationMode.GOAL:
        for name in ("achieved_goal", "desired_goal"):
            parts[name] = spaces.Box(task.goal_low, task.goal_high, dtype=np.float64)
    if config.camera is not None:
        parts["camera"] = spaces.Box(0, 255, (*config.camera, 3), dtype=np.uint8)
    return spaces.Dict(parts)
