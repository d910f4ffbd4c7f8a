"""Turn a bar that lies on the table by the fingers alone: the task of ``SoftHandReorient-v0``."""

import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from envs.errors import BadOptionError
from envs.observations import Field
from envs.task import Verdict
from envs.world import World
from softhand_sim.objects.model import ObjectModel, build_object
from softhand_sim.objects.shapes.boxes import box

Vector = npt.NDArray[np.float64]

TARGET_RAD = math.radians(15.0)
"""Choice: the fingers sweep the bar of `foam_bar` to 20 degrees either way before its end slips past their tips."""
LEAST_TURN_RAD = math.radians(6.0)
REACHED_RAD = math.radians(3.0)
HELD_S = 0.5
TIPPED_COS = math.cos(math.radians(30.0))
OUT_OF_REACH_M = 0.10
# choice: the object's centre lies 28 mm before the palm's, where index and the other fingers reach both its ends, and
# clear of the thumb; a palm at 100 mm keeps the tips of straight fingers 10 mm above the table
BEFORE_PALM_M, PALM_HEIGHT_M, CLEARANCE_M = 0.028, 0.100, 0.030
CLEAR_STEP_M, FARTHEST_M = 0.001, 0.05
"""Choices: what overlaps at the start is thrown; a bar that is turned by the largest yaw of all is cleared sooner."""


def foam_bar() -> ObjectModel:
    """Return the task's own object: 30 x 120 x 50 mm of foam.

    Choice: volume and mass of the YCB set's foam brick (28 g), friction of the catalogue, longer than the fingers are
    apart, so that a finger at either end turns it. A heavier one than 60 g isn't moved by the index finger alone.
    """
    return build_object(
        box(depth_m=0.030, width_m=0.120, height_m=0.050),
        name="foam_bar",
        kind="box",
        mass_kg=0.028,
        friction=0.8,
        rgba=(0.86, 0.45, 0.20, 1.0),
    )


@dataclass(kw_only=True)
class ReorientTask:
    """See `envs.reorient.SoftHandReorientEnv` for rewards and success."""

    target: tuple[Field, ...] = (Field(name="target_yaw_rad", size=1, low=-math.pi, high=math.pi),)
    options: tuple[str, ...] = ("target_yaw_rad",)
    wrist_axes: int = 3
    goal_low: Vector = field(default_factory=lambda: np.full(2, -1.0))
    goal_high: Vector = field(default_factory=lambda: np.full(2, 1.0))
    reached_s: float = 0.0

    def __post_init__(self) -> None:
        self._pose = np.zeros(6)
        self._home = np.zeros(3)
        self._target_rad = 0.0

    def wrist_start(self, model: ObjectModel) -> Vector:
        """Return the pose above the object, palm down, (6,)."""
        height = max(PALM_HEIGHT_M, float(model.extents_m[2]) + CLEARANCE_M)
        self._pose = np.array([-BEFORE_PALM_M, 0.0, height, 0.0, 0.0, 0.0])
        return self._pose

    def stand_clear(self, world: World) -> None:
        """Go forward, away from the object that lies before the fingers."""
        simulation, moved_m = world.simulation, 0.0
        while moved_m < FARTHEST_M and world.contacts.of_object(simulation.data).size:
            moved_m += CLEAR_STEP_M
            self._pose = self._pose + np.array([CLEAR_STEP_M, 0.0, 0.0, 0.0, 0.0, 0.0])
            simulation.stand(self._pose)

    def wrist_script(self, time_s: float) -> Vector:
        """Return the pose of the start: the hand stands still."""
        del time_s
        return self._pose

    def begin(self, world: World, rng: np.random.Generator, options: Mapping[str, Any]) -> None:
        """Remember the object's place and draw the target, evenly, but not where the object lies already."""
        self.reached_s = 0.0
        self._home = world.simulation.data.xpos[world.body].copy()
        start = yaw_rad(world)
        # the share of [-TARGET, TARGET] that is far enough from the start, laid end to end
        low = (-TARGET_RAD, max(-TARGET_RAD, min(TARGET_RAD, start - LEAST_TURN_RAD)))
        high = (min(TARGET_RAD, max(-TARGET_RAD, start + LEAST_TURN_RAD)), TARGET_RAD)
        along = rng.uniform() * (low[1] - low[0] + high[1] - high[0])
        target = low[0] + along if along < low[1] - low[0] else high[0] + along - (low[1] - low[0])
        if "target_yaw_rad" in options:
            target = options["target_yaw_rad"]
            if isinstance(target, bool) or not isinstance(target, int | float) or not abs(target) <= math.pi:
                raise BadOptionError(f"options: target_yaw_rad = {target!r}: must be a number in [-pi, pi]")
        self._target_rad = float(target)

    def judge(self, world: World, elapsed_s: float) -> Verdict:
        """Return the rewards of the state that the world is in."""
        data = world.simulation.data
        error = self.error_rad(world)
        upright = float(data.xmat[world.body, 8])
        reached = abs(error) <= REACHED_RAD and upright >= TIPPED_COS
        self.reached_s = self.reached_s + elapsed_s if reached else 0.0
        # sums of periods: a margin for rounding
        success = self.reached_s >= HELD_S - 1e-9
        terms = {"align": 1.0 - math.tanh(abs(error) / 0.1), "hold": float(success)}
        away = data.xpos[world.body] - self._home
        lost = upright < TIPPED_COS or float(away @ away) > OUT_OF_REACH_M**2
        return Verdict(terms, success, lost, {"error_rad": error})

    def error_rad(self, world: World) -> float:
        """Return how far the object must still turn [rad], from -pi to pi."""
        return math.remainder(self._target_rad - yaw_rad(world), 2.0 * math.pi)

    def commanded(self) -> Vector:
        """Return the target [rad], (1,)."""
        return np.array([self._target_rad])

    def achieved(self, world: World) -> Vector:
        """Return cosine and sine of the object's turn, (2,)."""
        yaw = yaw_rad(world)
        return np.array([math.cos(yaw), math.sin(yaw)])

    def desired(self) -> Vector:
        """Return cosine and sine of the target, (2,)."""
        return np.array([math.cos(self._target_rad), math.sin(self._target_rad)])

    def goal_reward(self, achieved: Vector, desired: Vector) -> Vector:
        """Return 0 where the object is within 3 degrees of the target, -1 elsewhere."""
        angle = np.arctan2(achieved[..., 1], achieved[..., 0]) - np.arctan2(desired[..., 1], desired[..., 0])
        return np.where(np.abs(np.sin(0.5 * angle)) > math.sin(0.5 * REACHED_RAD), -1.0, 0.0)

    def copy(self) -> "ReorientTask":
        """Return a copy; its arrays are replaced, never written to."""
        return copy(self)


def yaw_rad(world: World) -> float:
    """Return the object's turn about the vertical [rad]."""
    turned = world.simulation.data.xmat[world.body]
    return math.atan2(turned[3], turned[0])
