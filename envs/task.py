"""What a task is to the environment: where an episode starts, what it rewards, when it has succeeded or failed."""

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from envs.observations import Field
from envs.world import World
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]


class Verdict(NamedTuple):
    """A step's reward by terms, whether the task is solved at this moment, and whether the episode is lost."""

    terms: dict[str, float]
    success: bool
    lost: bool
    figures: dict[str, float]


class Task(Protocol):
    """Mutable on purpose: it remembers what its success needs; a copy of it is a copy of that.

    Attributes
    ----------
    target
        Fields of what is commanded in an episode, beside the fingers.
    options
        Options of ``reset`` that are this task's own.
    wrist_axes
        Of x, y, z, yaw, pitch, roll, how many an action may move: 3 or 6.
    goal_low, goal_high
        Bounds of a goal, (g,).
    """

    @property
    def target(self) -> tuple[Field, ...]: ...  # noqa: D102

    @property
    def options(self) -> tuple[str, ...]: ...  # noqa: D102

    @property
    def wrist_axes(self) -> int: ...  # noqa: D102

    @property
    def goal_low(self) -> Vector: ...  # noqa: D102

    @property
    def goal_high(self) -> Vector: ...  # noqa: D102

    def wrist_start(self, model: ObjectModel) -> Vector:
        """Return the wrist's pose at the start of an episode, (6,)."""
        ...

    def stand_clear(self, world: World) -> None:
        """Back the hand off from its start as long as it overlaps the displaced object."""
        ...

    def wrist_script(self, time_s: float) -> Vector:
        """Return the wrist's target pose, (6,), at a time, for policies that move the fingers alone."""
        ...

    def begin(self, world: World, rng: np.random.Generator, options: Mapping[str, Any]) -> None:
        """Start an episode in a world that was just reset; as many numbers are drawn whatever the options."""
        ...

    def judge(self, world: World, elapsed_s: float) -> Verdict:
        """Look at the world after a control period of ``elapsed_s`` [s]; 0 at the start."""
        ...

    def commanded(self) -> Vector:
        """Return the values of the fields in `target`, (t,)."""
        ...

    def achieved(self, world: World) -> Vector:
        """Return what the world has come to, in terms of a goal, (g,)."""
        ...

    def desired(self) -> Vector:
        """Return the goal, (g,)."""
        ...

    def goal_reward(self, achieved: Vector, desired: Vector) -> Vector:
        """Return the sparse reward of goals (..., g): 0 where reached, -1 elsewhere."""
        ...

    def copy(self) -> "Task":
        """Return a copy that later steps of this one leave alone."""
        ...
