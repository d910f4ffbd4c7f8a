"""A scripted top grasp, chosen from the object's shape alone (never from its name)."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from softhand_sim.objects.model import ObjectModel


class ShapeKind(StrEnum):
    """What the script tells apart: fingers go under round things, clamp upright ones, scoop long low ones."""

    ROUND = "round"
    UPRIGHT = "upright"
    LONG = "long"


@dataclass(frozen=True, kw_only=True)
class GraspPlan:
    """A top grasp in the object's frame (origin: mass centre; z up).

    Attributes
    ----------
    offset_m: palm centre relative to the object's centre along the palm's x axis (to the fingers).
    palm_height_m: height of the palm's surface above the table.
    yaw_rad: turn of the hand about the vertical, so that the fingers close over the object's short side.
    set_angle_deg: bending angle asked of thumb, index, middle-ring-little.
    """

    kind: ShapeKind
    offset_m: float
    palm_height_m: float
    yaw_rad: float
    set_angle_deg: tuple[float, float, float]

    def wrist_pose(self, object_xy_m: tuple[float, float]) -> npt.NDArray[np.float64]:
        """Wrist target x, y, z (m), yaw, pitch, roll (rad) for an object expected at `object_xy_m`, shape (6,)."""
        x = object_xy_m[0] + self.offset_m * np.cos(self.yaw_rad)
        y = object_xy_m[1] + self.offset_m * np.sin(self.yaw_rad)
        return np.array([x, y, self.palm_height_m, self.yaw_rad, 0.0, 0.0])


# choice: a ball fills 0.52 of its box, an upright cylinder 0.79, a box 1
ROUND_FILL = 0.65
# choice: outlines less long than this have no direction to turn to
ROUND_ASPECT = 1.1
# choice: length over width of the horizontal outline from which a thing is long
LONG_ASPECT = 2.0
# the paper's one stated angle, reached at 75 kPa; the relief of the real finger caps the force at 80 kPa
FIRM_ANGLE_DEG = 95.0


def classify(model: ObjectModel) -> tuple[ShapeKind, float]:
    """Return the shape's kind and the turn (rad) that lays its short horizontal side along the hand's x axis."""
    # about its long axis a body's moment of inertia is smallest
    _, axes = np.linalg.eigh(model.inertia_kg_m2[:2, :2])
    outline = np.asarray(model.mesh.vertices)[:, :2] @ axes
    long_m, short_m = outline.max(axis=0) - outline.min(axis=0)
    aspect = float(long_m / short_m)
    short_axis = axes[:, 1]
    yaw = float(np.arctan2(short_axis[1], short_axis[0])) if aspect > ROUND_ASPECT else 0.0
    # the short side has no sign: stay within a quarter turn
    yaw = (yaw + np.pi / 2) % np.pi - np.pi / 2
    fill = model.mesh.convex_hull.volume / float(long_m * short_m * model.extents_m[2])
    if aspect > LONG_ASPECT and model.extents_m[2] < long_m:
        return ShapeKind.LONG, yaw
    return (ShapeKind.ROUND if fill < ROUND_FILL else ShapeKind.UPRIGHT), yaw


def plan_grasp(model: ObjectModel) -> GraspPlan:
    """Return the scripted top grasp of an object standing in its rest pose.

    The heights and offsets are choices, found on plain spheres, cylinders and bent rods with a provisional
    finger before any of the catalogue's objects was tried: below them the fingertips meet the table before
    they are under a ball, above them they close over a cylinder's rim.
    """
    kind, yaw = classify(model)
    top_m = float(model.extents_m[2])
    offset_m, palm_height_m = {
        ShapeKind.ROUND: (-0.010, max(0.106, top_m + 0.030)),
        ShapeKind.UPRIGHT: (0.002, max(0.092, top_m + 0.012)),
        ShapeKind.LONG: (-0.020, max(0.100, top_m + 0.030)),
    }[kind]
    return GraspPlan(
        kind=kind,
        offset_m=offset_m,
        palm_height_m=palm_height_m,
        yaw_rad=yaw,
        set_angle_deg=(FIRM_ANGLE_DEG, FIRM_ANGLE_DEG, FIRM_ANGLE_DEG),
    )
