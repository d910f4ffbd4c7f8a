"""The wrist's reference: moves to a target no faster than the arm may."""

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]


def limited_step(current: Vector, target: Vector, largest_m: float, largest_rad: float) -> Vector:
    """Return `current` moved toward `target` by at most the given path length and turn.

    Parameters
    ----------
    current, target: x, y, z (m), yaw, pitch, roll (rad), shape (6,).
    largest_m: longest move of the position, measured along the straight path.
    largest_rad: largest change of each angle.
    """
    step = target - current
    distance = float(np.linalg.norm(step[:3]))
    if distance > largest_m:
        step[:3] *= largest_m / distance
    step[3:] = np.clip(step[3:], -largest_rad, largest_rad)
    return current + step
