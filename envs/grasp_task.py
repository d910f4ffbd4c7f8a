"""Reach, close, lift, hold: the task of ``SoftHandGrasp-v0``."""

import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from envs.errors import BadOptionError
from envs.observations import Field
from envs.task import Verdict
from envs.world import OTHER_FINGERS, THUMB_OR_PALM, World
from softhand_sim.checks import require_in
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.grasp.place import stand_off
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]

LIFTED_M = 0.10
HELD_S = 1.0
IN_HAND_M = 0.15
OUT_OF_REACH_M = 0.5
GOAL_REACHED_M = 0.02
# choice: above the table by half the lift up to one and a half, within a hand's breadth beside the object's place
GOAL_LOW_M, GOAL_HIGH_M = (-0.05, -0.05, 0.05), (0.05, 0.05, 0.15)


@dataclass(kw_only=True)
class GraspTask:
    """See `envs.grasp.SoftHandGraspEnv` for rewards and success."""

    target: tuple[Field, ...] = ()
    options: tuple[str, ...] = ("goal_position_m",)
    wrist_axes: int = 6
    goal_low: Vector = field(default_factory=lambda: np.full(3, -3.0))
    goal_high: Vector = field(default_factory=lambda: np.full(3, 3.0))
    lifted_s: float = 0.0
    approach_m: float | None = None

    def __post_init__(self) -> None:
        self._protocol = load_protocol()
        if self.approach_m is not None:
            require_in("approach_m", self.approach_m, 1e-3, 0.3)
            self._protocol = replace(self._protocol, approach_m=self.approach_m)
        self._home = self._goal = np.zeros(3)
        self._grasp, self._approach_m = np.zeros(6), self._protocol.approach_m
        self._plans: dict[str, GraspPlan] = {}

    def wrist_start(self, model: ObjectModel) -> Vector:
        """Return the pose before the default grasp of the object, (6,)."""
        # an environment's objects have different names
        plan = self._plans.get(model.name) or default_grasp(model)
        self._plans[model.name] = plan
        self._grasp = plan.standoff(0.0)
        return plan.standoff(self._protocol.approach_m)

    def stand_clear(self, world: World) -> None:
        """Go back along the approach."""
        plan = self._plans[world.object.name]
        self._approach_m = stand_off(world.simulation, plan, self._protocol.approach_m)

    def wrist_script(self, time_s: float) -> Vector:
        """Return the pose of the paper's protocol: at the object, and up when the fingers had time to close."""
        # the standoff is so far away, at 0.1 m/s (paper)
        closed_s = self._approach_m / 0.1 + self._protocol.settle_s + self._protocol.close_s
        up = np.array([0.0, 0.0, self._protocol.lift_m, 0.0, 0.0, 0.0])
        return self._grasp if time_s < closed_s else self._grasp + up

    def begin(self, world: World, rng: np.random.Generator, options: Mapping[str, Any]) -> None:
        """Remember the object's place and draw the goal."""
        self.lifted_s = 0.0
        self._home = world.simulation.data.xpos[world.body].copy()
        goal = self._home + rng.uniform(GOAL_LOW_M, GOAL_HIGH_M)
        if "goal_position_m" in options:
            goal = np.asarray(options["goal_position_m"], dtype=np.float64)
            if goal.shape != (3,) or not (np.abs(goal) <= 1.0).all():
                raise BadOptionError(f"options: goal_position_m = {goal}: must be x, y, z within 1 m")
        self._goal = goal

    def judge(self, world: World, elapsed_s: float) -> Verdict:
        """Return the rewards of the state that the world is in."""
        data = world.simulation.data
        position = data.xpos[world.body]
        height = float(position[2]) - world.rest_height_m
        distance = _length(position - data.site_xpos[world.grasp_site])
        in_hand = height >= LIFTED_M and distance <= IN_HAND_M
        self.lifted_s = self.lifted_s + elapsed_s if in_hand else 0.0
        # sums of periods: a margin for rounding
        success = self.lifted_s >= HELD_S - 1e-9
        touched = world.touching()
        terms = {
            "reach": 1.0 - math.tanh(10.0 * distance),
            "touch": 0.25 * bool(touched & THUMB_OR_PALM) + 0.25 * bool(touched & OTHER_FINGERS),
            "lift": 3.0 * min(max(height / LIFTED_M, 0.0), 1.0),
            "hold": float(success),
        }
        lost = _length(position - self._home) > OUT_OF_REACH_M
        return Verdict(terms, success, lost, {"object_height_m": height})

    def commanded(self) -> Vector:
        """Return nothing: a grasp has no target but the goal."""
        return np.zeros(0)

    def achieved(self, world: World) -> Vector:
        """Return the object's position [m], (3,)."""
        return np.asarray(np.clip(world.simulation.data.xpos[world.body], self.goal_low, self.goal_high))

    def desired(self) -> Vector:
        """Return the position wanted [m], (3,)."""
        return self._goal.copy()

    def goal_reward(self, achieved: Vector, desired: Vector) -> Vector:
        """Return 0 where the object is within 20 mm of the goal, -1 elsewhere."""
        return np.where(np.linalg.norm(achieved - desired, axis=-1) > GOAL_REACHED_M, -1.0, 0.0)

    def copy(self) -> "GraspTask":
        """Return a copy; its arrays are replaced, never written to."""
        return copy(self)


def _length(vector: Vector) -> float:
    # three numbers: faster than np.linalg.norm
    x, y, z = vector.tolist()
    return float((x * x + y * y + z * z) ** 0.5)
