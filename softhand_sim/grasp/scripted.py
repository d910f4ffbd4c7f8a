"""A scripted grasp, chosen from the object's shape alone (never from its name)."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]

# choice: a ball fills 0.52 of its box, an upright cylinder 0.79, a box 1
ROUND_FILL = 0.65
# choice: length over width of the horizontal outline from which a thing is long
LONG_ASPECT = 2.0
# choice: outlines less long than this have no direction to turn to
ROUND_ASPECT = 1.1


class ShapeKind(StrEnum):
    """What the script tells apart: fingers go under round things, around upright ones, over long low ones."""

    ROUND = "round"
    UPRIGHT = "upright"
    LONG = "long"


@dataclass(frozen=True, kw_only=True)
class Outline:
    """An object's shape as the script sees it.

    Attributes
    ----------
    kind: round, upright or long.
    yaw_rad: turn about the vertical that lays the short horizontal side along x and the far end (a handle) to -y.
    near_m: reach of the outline from the mass centre on the other side, +y.
    height_m: height of the object as it stands.
    """

    kind: ShapeKind
    yaw_rad: float
    near_m: float
    height_m: float


def outline(model: ObjectModel) -> Outline:
    """Classify an object's shape and find its horizontal axes."""
    # about its long axis a body's moment of inertia is smallest
    _, axes = np.linalg.eigh(model.inertia_kg_m2[:2, :2])
    points = np.asarray(model.mesh.vertices)[:, :2]
    along = points @ axes
    long_m, short_m = np.ptp(along, axis=0)
    yaw = float(np.arctan2(axes[1, 1], axes[0, 1])) if long_m > ROUND_ASPECT * short_m else 0.0
    # the short side has no sign: stay within a quarter turn, then turn the far end away
    yaw = (yaw + np.pi / 2) % np.pi - np.pi / 2
    across = points @ np.array([-np.sin(yaw), np.cos(yaw)])
    if across.max() > -across.min() + 1e-3:
        yaw, across = yaw - np.sign(yaw or 1.0) * np.pi, -across
    height_m = float(model.extents_m[2])
    fill = model.mesh.convex_hull.volume / (long_m * short_m * height_m)
    if long_m > LONG_ASPECT * short_m and height_m < long_m:
        kind = ShapeKind.LONG
    else:
        kind = ShapeKind.ROUND if fill < ROUND_FILL else ShapeKind.UPRIGHT
    return Outline(kind=kind, yaw_rad=float(yaw), near_m=float(across.max()), height_m=height_m)


def plan_grasp(model: ObjectModel) -> GraspPlan:
    """Return the scripted grasp of an object standing in its rest pose.

    Distances are choices, found on plain spheres, a cylinder and a bent rod, but for ``SIDE_GAP_M``.
    """
    seen = outline(model)
    if seen.kind is ShapeKind.UPRIGHT:
        return _from_the_side(seen)
    if seen.kind is ShapeKind.ROUND:
        return _from_above(seen, x_m=-0.010, palm_height_m=max(0.106, seen.height_m + 0.030))
    return _from_above(seen, x_m=-0.010, palm_height_m=max(0.100, seen.height_m + 0.030))


def _from_above(seen: Outline, *, x_m: float, palm_height_m: float) -> GraspPlan:
    """Palm down; `x_m` shifts the palm along its own x axis, `palm_height_m` is that of its surface."""
    turn = seen.yaw_rad
    pose = (x_m * math.cos(turn), x_m * math.sin(turn), palm_height_m, turn, 0.0, 0.0)
    return GraspPlan(wrist_pose=pose, retreat=(0.0, 0.0, 1.0))


def _from_the_side(seen: Outline) -> GraspPlan:
    """Palm upright against the near side, little finger lowest: fingers and thumb close around the object.

    Four fingers that press an object into the palm carry about twice what they carry against one thumb.
    """
    turn = seen.yaw_rad
    # the palm's lower edge and the little finger clear the table by 6 mm; high things are held at 60 % of their height
    height_m = max(0.046, 0.6 * seen.height_m)
    x_m, y_m = SIDE_OFFSET_M, seen.near_m + SIDE_GAP_M
    pose = (
        x_m * math.cos(turn) - y_m * math.sin(turn),
        x_m * math.sin(turn) + y_m * math.cos(turn),
        height_m, turn, 0.0, -math.pi / 2,
    )  # fmt: skip
    return GraspPlan(wrist_pose=pose, retreat=(-math.sin(turn), math.cos(turn), 0.0))


# choice: middle of the opening between thumb and fingers at 40 mm from the palm
SIDE_OFFSET_M = -0.005
# choice: the palm pushes the object 10 mm along the table, so that one which stands 10 mm too far still meets it:
# fingers that close on an object away from the palm squeeze it out. Decided on the mug, of which 20 trials hold 10 with
# a gap of 4 mm, 13 with -4 mm, 15 with -8 mm and 18 with -10 mm
SIDE_GAP_M = -0.010
