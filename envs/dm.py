"""The same environments for users of dm_control: `dm_env.Environment` over a Gymnasium one."""

from typing import Any

import dm_env
import numpy as np
import numpy.typing as npt
from dm_env import specs
from gymnasium import spaces

from envs.hand_env import SoftHandEnv

Vector = npt.NDArray[np.float64]


class DmSoftHand(dm_env.Environment):  # type: ignore[misc]
    """Episodes as time steps; the vector is split into its fields, by the names of `envs.observations`.

    A lost episode ends with discount 0, one that reaches the time limit with discount 1. Steps are those of the
    environment underneath, bit for bit.

    Parameters
    ----------
    env
        What runs; its observation mode may be any, with or without a camera.
    time_limit_s
        Simulated time of an episode [s].
    seed
        Of the first episode; the others follow from it.
    """

    def __init__(self, env: SoftHandEnv, *, time_limit_s: float = 10.0, seed: int | None = None) -> None:
        if not 0.0 < time_limit_s < float("inf"):
            raise ValueError(f"time_limit_s = {time_limit_s!r}: must be a finite number of seconds > 0")
        self._env = env
        self._seed = seed
        self._steps = round(time_limit_s / env.episode.spec.control_period_s)
        self._done = self._steps
        self._over = True

    @property
    def gymnasium_env(self) -> SoftHandEnv:
        """The environment underneath."""
        return self._env

    def reset(self) -> dm_env.TimeStep:
        """Return the first time step of a new episode."""
        seen, _ = self._env.reset(seed=self._seed)
        self._seed, self._done, self._over = None, 0, False
        return dm_env.restart(self._split(seen))

    def step(self, action: npt.ArrayLike) -> dm_env.TimeStep:
        """Advance by one control period; after the last step of an episode start a new one, whatever the action.

        Raises
        ------
        BadActionError
            If the action has a wrong shape or a value that the spec does not hold.
        """
        if self._over:
            return self.reset()
        seen, reward, terminated, _, _ = self._env.step(action)
        self._done += 1
        self._over = terminated or self._done >= self._steps
        if terminated:
            return dm_env.termination(reward, self._split(seen))
        if self._over:
            return dm_env.truncation(reward, self._split(seen))
        return dm_env.transition(reward, self._split(seen))

    def action_spec(self) -> specs.BoundedArray:
        """Return what `step` takes."""
        space = self._env.action_space
        if isinstance(space, spaces.Box):
            return specs.BoundedArray(space.shape, space.dtype, space.low, space.high, name="action")
        return specs.BoundedArray(space.shape, space.dtype, 0, 1, name="action")

    def observation_spec(self) -> dict[str, specs.Array]:
        """Return the fields of a time step's observation."""
        layout = self._env.episode.spec.layout
        out = {f.name: specs.BoundedArray((f.size,), np.float64, f.low, f.high, name=f.name) for f in layout.fields}
        space = self._env.observation_space
        if isinstance(space, spaces.Dict):
            for name, part in space.spaces.items():
                if name != "observation" and isinstance(part, spaces.Box):
                    out[name] = specs.BoundedArray(part.shape, part.dtype, part.low, part.high, name=name)
        return out

    def close(self) -> None:
        """Free windows and GL contexts."""
        self._env.close()

    def _split(self, seen: Any) -> dict[str, npt.NDArray[Any]]:
        others = dict(seen) if isinstance(seen, dict) else {"observation": seen}
        vector = others.pop("observation")
        where = self._env.episode.spec.layout.where
        return {name: vector[part].copy() for name, part in where.items()} | others
