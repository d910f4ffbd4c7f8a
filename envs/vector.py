"""Vector environments: many episodes at once on the engine's own threads."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from envs.config import EnvConfig
from envs.episode import Episode
from envs.hand_env import observation_space, observed
from envs.infos import columns
from envs.lanes import Lanes
from envs.rendering import Pictures
from envs.task import Task
from envs.world import WorldPool

Info = dict[str, Any]
Flags = npt.NDArray[np.bool_]


class SoftHandVectorEnv(VectorEnv[Any, Any, Any]):
    """``num_envs`` environments of one kind; the same results as so many single ones with the same seeds, bit for bit.

    Made by ``gymnasium.make_vec``. Each draws its own object, material pair, leak, valves and sensors, as a single one
    does. Compiled scenes are shared, and so are worlds: one that an episode leaves serves whichever wants it next. A
    camera draws one world after the other in a context of its own.

    Parameters
    ----------
    tasks
        One for each environment.
    config
        Of all of them.
    max_episode_steps
        After which an episode is truncated; None for never.
    threads
        Of the engine; 0 for all processors.
    autoreset_mode
        ``NEXT_STEP`` (default): the step after an episode's last one resets it, whatever the action, and has reward 0.
        ``SAME_STEP``: the last step returns the next episode's first observation; the last of the old one is in
        ``info["final_obs"]``, its info in ``info["final_info"]``. ``DISABLED``: the caller resets, with
        ``options={"reset_mask": ...}``.

    Raises
    ------
    ValueError
        If the number of environments or of steps is not above 0.
    """

    def __init__(
        self,
        tasks: Sequence[Task],
        config: EnvConfig,
        *,
        max_episode_steps: int | None,
        threads: int = 0,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
    ) -> None:
        if not tasks:
            raise ValueError("num_envs = 0: must be 1 or more")
        if max_episode_steps is not None and max_episode_steps < 1:
            raise ValueError(f"max_episode_steps = {max_episode_steps}: must be None or 1 or more")
        if threads < 0:
            raise ValueError(f"threads = {threads}: must be 0 or more")
        mode = AutoresetMode(autoreset_mode)
        self.num_envs = len(tasks)
        self.metadata = {"render_modes": [], "autoreset_mode": mode}
        self._autoreset, self._most = mode, max_episode_steps
        scenes = config.scenes()
        worlds = WorldPool(scenes)
        self._episodes = tuple(Episode(config.spec(scenes, task), worlds, task) for task in tasks)
        self._lanes = Lanes(self._episodes, threads)
        self._mode, self._camera_size = config.mode, config.camera
        self._pictures = tuple(Pictures() for _ in tasks)
        spec = self._episodes[0].spec
        self.single_action_space = spec.action.space
        self.single_observation_space = observation_space(config, spec.layout.space, tasks[0])
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._rngs = [seeding.np_random()[0] for _ in tasks]
        self._steps = np.zeros(self.num_envs, dtype=np.int64)
        self._over = np.zeros(self.num_envs, dtype=bool)

    @property
    def episodes(self) -> tuple[Episode, ...]:
        """What runs inside."""
        return self._episodes

    def engine_state(self) -> npt.NDArray[np.float64]:
        """Return a copy of the engine's full state, one row an environment, for measurements."""
        return self._lanes.state()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, Info]:
        """Start new episodes, all of them or those of ``options["reset_mask"]``, a bool array (n,).

        Parameters
        ----------
        seed
            One for the first environment, the others counting on from it, or one each.
        options
            As of a single environment; the same for all.

        Raises
        ------
        ValueError
            If the number of seeds or the mask is wrong, or an option is not allowed (`BadOptionError`).
        """
        n, given = self.num_envs, dict(options or {})
        mask = given.pop("reset_mask", np.ones(n, dtype=bool))
        if not isinstance(mask, np.ndarray) or mask.shape != (n,) or mask.dtype != np.bool_ or not mask.any():
            raise ValueError(f"options: reset_mask = {mask!r}: must be a bool array of shape ({n},), not all False")
        seeds = [seed + i for i in range(n)] if isinstance(seed, int) else list(seed or [None] * n)
        if len(seeds) != n:
            raise ValueError(f"seed: {len(seeds)} given, must be one or {n}")
        chosen = np.flatnonzero(mask).tolist()
        for i in chosen:
            if seeds[i] is not None:
                self._rngs[i] = seeding.np_random(seeds[i])[0]
        infos: Info = {}
        for i, info in self._restart(chosen, given).items():
            infos = self._add_info(infos, info, i)
        return self._batched({i: self._observed(i) for i in range(n)}), infos

    def step(self, actions: Any) -> tuple[Any, npt.NDArray[np.float64], Flags, Flags, Info]:
        """Advance all environments by one control period.

        Raises
        ------
        BadActionError
            If an action has a wrong shape or a value that the space does not hold; nothing was advanced.
        RuntimeError
            Before the first reset.
        """
        n = self.num_envs
        resetting = self._over if self._autoreset is AutoresetMode.NEXT_STEP else np.zeros(n, dtype=bool)
        if self._autoreset is AutoresetMode.DISABLED and self._over.any():
            raise RuntimeError(f"episodes {np.flatnonzero(self._over).tolist()} are over: reset them first")
        for episode, action, ended in zip(self._episodes, iterate(self.action_space, actions), resetting, strict=True):
            if not ended:
                episode.command(action)
        going = np.flatnonzero(~resetting).tolist()
        rewards, terminated, rows, told = self._advance(going)
        self._steps[going] += 1
        truncated = ~resetting & (self._steps >= (self._most or np.inf))
        self._over = terminated | truncated
        again = np.flatnonzero(resetting).tolist()
        if self._autoreset is AutoresetMode.SAME_STEP:
            again = np.flatnonzero(self._over).tolist()
            told |= {i: {"final_obs": rows[i], "final_info": told[i]} for i in again}
        infos = columns(told, n, self._add_info)
        for i, info in self._restart(again, {}).items():
            infos = self._add_info(infos, info, i)
        rows |= {i: self._observed(i) for i in again}
        return self._batched(rows), rewards, terminated, truncated, infos

    def _advance(self, going: list[int]) -> tuple[npt.NDArray[np.float64], Flags, dict[int, Any], dict[int, Info]]:
        """Advance some episodes and return rewards and ends, (n,), and their observations and infos by number."""
        rewards, terminated = np.zeros(self.num_envs), np.zeros(self.num_envs, dtype=bool)
        rows: dict[int, Any] = {}
        told: dict[int, Info] = {}

        def look(i: int) -> None:
            episode = self._episodes[i]
            rewards[i], terminated[i], told[i] = episode.judge(episode.spec.control_period_s)
            if self._camera_size is None:
                rows[i] = self._observed(i)

        self._lanes.advance(going, look)
        if self._camera_size is not None:
            # a context of its own for each, in this thread
            rows = {i: self._observed(i) for i in going}
        # whichever thread was first
        return rewards, terminated, rows, {i: told[i] for i in going}

    def _restart(self, chosen: list[int], options: dict[str, Any]) -> dict[int, Info]:
        """Reset some episodes and return their infos."""
        infos = {}
        for i in chosen:
            episode = self._episodes[i]
            drawn = episode.reset(self._rngs[i], options)
            infos[i] = episode.judge(0.0)[2] | drawn
            self._steps[i], self._over[i] = 0, False
        return infos

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads and free GL contexts."""
        del kwargs
        self._lanes.close()
        for pictures in self._pictures:
            pictures.close()

    def _batched(self, rows: Mapping[int, Any]) -> Any:
        out: Any = create_empty_array(self.single_observation_space, n=self.num_envs)
        return concatenate(self.single_observation_space, [rows[i] for i in range(self.num_envs)], out)

    def _observed(self, i: int) -> Any:
        episode, size = self._episodes[i], self._camera_size
        picture = None if size is None else self._pictures[i].camera(episode.here, size)
        return observed(episode, self._mode, picture)
