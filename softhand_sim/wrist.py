"""The wrist's reference: moves to a target no faster than the arm may."""

import math

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
    # six plain numbers are quicker than small arrays
    x, y, z, *turns = (target - current).tolist()
    distance = math.sqrt(x * x + y * y + z * z)
    share = largest_m / distance if distance > largest_m else 1.0
    turned = [min(max(turn, -largest_rad), largest_rad) for turn in turns]
    return np.asarray(current + np.array([x * share, y * share, z * share, *turned]))


def move_wrists(reference: Vector, target: Vector, largest_m: float, largest_rad: float) -> None:
    """Move n wrists, (n, 6), each as `limited_step`, in place."""
    for w in np.flatnonzero((reference != target).any(axis=1)):
        reference[w] = limited_step(reference[w], target[w], largest_m, largest_rad)
