"""Environments that several tests share: a scene takes a second to compile, so each is made once."""

from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import pytest

import envs


@pytest.fixture(scope="session")
def made() -> Iterator[Callable[..., Any]]:
    """Return a function that makes a bare environment by its id and arguments, and keeps it."""
    kept: dict[str, Any] = {}

    def make(env_id: str = envs.GRASP_ENV_ID, **arguments: Any) -> Any:
        key = f"{env_id} {sorted(arguments.items())}"
        if key not in kept:
            kept[key] = gymnasium.make(env_id, **arguments)
        return kept[key].unwrapped

    yield make
    for env in kept.values():
        env.close()
