"""The verdict on a grasp trial: a fixed list of outcomes and the thresholds that separate them."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt


class Outcome(StrEnum):
    """How a trial ended.

    HELD: still in the hand after the hold, slip and tilt below their thresholds.
    SLIPPED: still in the hand, but it moved more than that.
    DROPPED: it left the table with the hand and was lost before the end.
    MISSED: it never left the table.
    DIVERGED: the simulation became non-finite or the engine reported an instability.
    """

    HELD = "HELD"
    SLIPPED = "SLIPPED"
    DROPPED = "DROPPED"
    MISSED = "MISSED"
    DIVERGED = "DIVERGED"


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """Limits between outcomes (choices).

    Attributes
    ----------
    slip_m: largest displacement of the object in the palm's frame from the start of the lift to the end of the
        hold; 10 mm is what a person would still call held, and includes the fingers' sag under the load.
    tilt_rad: largest turn in the palm's frame over the same time.
    lifted_m: height above rest that counts as off the table.
    held_fraction: share of the commanded lift that the object must have gained at the end.
    """

    slip_m: float = 0.010
    tilt_rad: float = 0.2617993877991494
    lifted_m: float = 0.020
    held_fraction: float = 0.7

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not value > 0.0:
                raise ValueError(f"{name}: {value} must be above 0")


def judge(
    *,
    thresholds: Thresholds,
    commanded_lift_m: float,
    final_lift_m: float,
    highest_lift_m: float,
    slip_m: float,
    tilt_rad: float,
    diverged: bool,
) -> Outcome:
    """Return the outcome that the measured figures of a trial mean."""
    if diverged:
        return Outcome.DIVERGED
    if final_lift_m >= thresholds.held_fraction * commanded_lift_m:
        steady = slip_m <= thresholds.slip_m and tilt_rad <= thresholds.tilt_rad
        return Outcome.HELD if steady else Outcome.SLIPPED
    return Outcome.DROPPED if highest_lift_m >= thresholds.lifted_m else Outcome.MISSED


def creep_rate_m_per_s(time_s: npt.NDArray[np.float64], position_m: npt.NDArray[np.float64]) -> float:
    """Speed of the steady drift of an object in the hand: least-squares slope of its path, |v| (m/s).

    Parameters
    ----------
    time_s: sample times, shape (n,), n >= 2.
    position_m: the object's position in the palm's frame, shape (n, 3).
    """
    centred = time_s - time_s.mean()
    slope = centred @ (position_m - position_m.mean(axis=0)) / (centred @ centred)
    return float(np.linalg.norm(slope))
