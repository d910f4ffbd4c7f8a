"""The action and observation layout of the grasp environment, and the checks on what comes in."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

ACTION_SIZE = 9


@dataclass(frozen=True, kw_only=True)
class Field:
    """One block of the observation: name, length, and the range its values are clipped to."""

    name: str
    size: int
    low: float
    high: float


OBSERVATION = (
    Field(name="pressure_reading_kpa_gauge", size=3, low=-82.0, high=150.0),
    Field(name="set_pressure_kpa_gauge", size=3, low=0.0, high=150.0),
    Field(name="wrist_position_m", size=3, low=-1.0, high=1.0),
    Field(name="wrist_angle_rad", size=3, low=-4.0, high=4.0),
    Field(name="joint_angle_rad", size=15, low=-2.0, high=3.0),
    Field(name="object_position_in_palm_m", size=3, low=-3.0, high=3.0),
    Field(name="object_quaternion_in_palm", size=4, low=-1.0, high=1.0),
    Field(name="object_height_m", size=1, low=-3.0, high=3.0),
)


def observation_bounds() -> tuple[Vector, Vector]:
    """Return the lowest and highest observation, each of shape (35,)."""
    low = np.concatenate([np.full(f.size, f.low) for f in OBSERVATION])
    high = np.concatenate([np.full(f.size, f.high) for f in OBSERVATION])
    return low, high


def pack(values: dict[str, npt.ArrayLike]) -> Vector:
    """Return the observation, shape (35,), each block clipped to its range."""
    parts = [np.clip(np.asarray(values[f.name], dtype=np.float64).ravel(), f.low, f.high) for f in OBSERVATION]
    return np.concatenate(parts)


def checked_action(action: npt.ArrayLike) -> Vector:
    """Return the action as floats, shape (9,).

    Raises
    ------
    ValueError
        If the shape is wrong, or a value is not a number in [-1, 1]; names the index and the value.
    """
    values = np.asarray(action, dtype=np.float64)
    if values.shape != (ACTION_SIZE,):
        raise ValueError(f"action: shape {values.shape} must be ({ACTION_SIZE},)")
    outside = np.flatnonzero(~(np.abs(values) <= 1.0))
    if outside.size:
        raise ValueError(f"action[{outside[0]}]: {values[outside[0]]} must be a number in [-1, 1]")
    return values
