"""What a trial does before its protocol's phases: where the hand goes, how it comes in, how far it closes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from softhand_sim.checks import require_in
from softhand_sim.hand.hand import HINGE_RANGE_RAD, PALM_DOWN, SLIDE_RANGE_M

Vector = npt.NDArray[np.float64]

# the paper's one stated angle, reached at 75 kPa; the relief of the real finger caps the force at 80 kPa
FIRM_ANGLE_DEG = 95.0
LARGEST_ANGLE_DEG = 180.0
_DOWN = Rotation.from_quat(PALM_DOWN, scalar_first=True)


@dataclass(frozen=True, kw_only=True)
class GraspPlan:
    """A grasp pose for an object whose mass centre stands above the world's origin.

    Attributes
    ----------
    wrist_pose: x, y, z (m) of the palm's centre, yaw, pitch, roll (rad), shape (6,).
    retreat: unit vector, shape (3,), along which the hand backs off from the pose, and comes in.
    set_angle_deg: bending angle asked of thumb, index, middle-ring-little; a finger that is calibrated for less gets
        its highest pressure.

    Raises
    ------
    ValueError
        If a value is out of the wrist's or the fingers' range, or `retreat` is no unit vector.
    """

    wrist_pose: tuple[float, ...]
    retreat: tuple[float, ...]
    set_angle_deg: tuple[float, ...] = (FIRM_ANGLE_DEG, FIRM_ANGLE_DEG, FIRM_ANGLE_DEG)

    def __post_init__(self) -> None:
        for name, size in (("wrist_pose", 6), ("retreat", 3), ("set_angle_deg", 3)):
            if len(getattr(self, name)) != size:
                raise ValueError(f"{name}: {len(getattr(self, name))} numbers given, must be {size}")
        for value, (low, high) in zip(self.wrist_pose, (*SLIDE_RANGE_M, *[HINGE_RANGE_RAD] * 3), strict=True):
            require_in("wrist_pose", value, low, high)
        for value in self.set_angle_deg:
            require_in("set_angle_deg", value, 0.0, LARGEST_ANGLE_DEG)
        length = float(np.linalg.norm(self.retreat))
        if not abs(length - 1.0) < 1e-6:
            raise ValueError(f"retreat: {tuple(self.retreat)} has length {length:g}, must be 1")

    def standoff(self, distance_m: float) -> Vector:
        """Return the wrist's pose `distance_m` before the grasp, shape (6,)."""
        return np.array(self.wrist_pose) + distance_m * np.array([*self.retreat, 0.0, 0.0, 0.0])


def pose_of_palm(position_m: Vector, axes: Vector) -> tuple[float, ...]:
    """Return the wrist's pose that puts the palm's frame at a position, shape (3,), with the given axes.

    Parameters
    ----------
    position_m: of the palm's centre in the world.
    axes: shape (3, 3), columns the palm's x (to the fingers), y and z (out of the palm) in the world.
    """
    yaw, pitch, roll = (Rotation.from_matrix(axes) * _DOWN.inv()).as_euler("ZYX")
    return (*(float(v) for v in position_m), float(yaw), float(pitch), float(roll))


def palm_axes(wrist_pose: tuple[float, ...]) -> Vector:
    """Return the palm's axes in the world, shape (3, 3), columns x, y, z, at a wrist's pose."""
    return np.asarray((Rotation.from_euler("ZYX", wrist_pose[3:]) * _DOWN).as_matrix())
