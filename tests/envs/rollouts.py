"""Rollouts under random actions, for tests and for the processes that they start."""

from typing import Any

import numpy as np


def rollout(env: Any, seed: int, steps: int, options: dict[str, Any] | None = None) -> np.ndarray:
    """Return observations and rewards, (steps, n + 1), under actions drawn from the seed."""
    env.action_space.seed(seed)
    env.reset(seed=seed, options=options)
    return go_on(env, steps)


def go_on(env: Any, steps: int) -> np.ndarray:
    """Return observations and rewards of further steps, (steps, n + 1)."""
    rows = []
    for _ in range(steps):
        observation, reward, *_ = env.step(env.action_space.sample())
        rows.append(np.append(observation, reward))
    return np.array(rows)
