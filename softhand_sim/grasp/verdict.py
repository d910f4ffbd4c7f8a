"""The verdict on a grasp trial: a fixed list of outcomes and the thresholds that separate them."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from softhand_sim.checks import require_finite


class Outcome(StrEnum):
    """How a trial ended.

    HELD: still in the hand after the hold, slip and tilt below their thresholds.
    SLIPPED: still in the hand, but it moved more than that, or creeps faster than allowed.
    PENETRATED: still in the hand, but sunk into it deeper than allowed: the hold is the contact model's. Or a guard
        ended the trial because something sank too deep on the way.
    DROPPED: it left the table with the hand and was lost before the end.
    MISSED: it never left the table.
    CRASHED: the process that ran it died, twice.
    DIVERGED: the simulation became non-finite or the engine reported an instability, or memory too full for a contact.
    UNBALANCED: a guard saw mechanical energy appear from nowhere.
    EXTRAPOLATED: a guard saw a joint or a pressure far beyond what the finger was calibrated for.

    The last three, and a guard's PENETRATED, are of `softhand_sim.guards`: there is no verdict on the grasp.
    """

    HELD = "HELD"
    SLIPPED = "SLIPPED"
    PENETRATED = "PENETRATED"
    DROPPED = "DROPPED"
    MISSED = "MISSED"
    DIVERGED = "DIVERGED"
    UNBALANCED = "UNBALANCED"
    EXTRAPOLATED = "EXTRAPOLATED"
    CRASHED = "CRASHED"


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """Limits between outcomes (choices).

    Attributes
    ----------
    slip_m: largest displacement of the object in the palm's frame from the start of the lift to the end of the
        hold; 10 mm is what a person would still call held, and includes the fingers' sag under the load.
    tilt_rad: largest turn in the palm's frame over the same time.
    at_any_time: whether slip and tilt count at their largest since the mark, instead of at the end.
    creep_m_per_s: fastest steady drift during the hold; 1 mm/s loses the object's place within the 10 s of a pick and
        place.
    penetration_m: deepest contact with the hand during the hold; a tenth of a finger's thickness.
    lifted_m: height above rest that counts as off the table.
    held_fraction: share of the commanded lift that the object must have gained at the end.
    """

    slip_m: float = 0.010
    tilt_rad: float = 0.2617993877991494
    lifted_m: float = 0.020
    held_fraction: float = 0.7
    at_any_time: bool = False
    creep_m_per_s: float = 1e-3
    penetration_m: float = 2e-3

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if name == "at_any_time":
                if not isinstance(value, bool):
                    raise ValueError(f"{name}: {value!r} must be true or false")
            else:
                require_finite(name, value, above=0.0)


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What a verdict rests on.

    Attributes
    ----------
    commanded_lift_m, final_lift_m, highest_lift_m: height asked for, and that of the object at the end and at its most.
    slip_m, tilt_rad: at the end or at their largest, as `Thresholds.at_any_time` wants them.
    creep_m_per_s, penetration_m: during the hold.
    in_hand: whether hand and object touch at the end.
    diverged: whether the simulation failed.
    """

    commanded_lift_m: float
    final_lift_m: float
    highest_lift_m: float
    slip_m: float
    tilt_rad: float
    creep_m_per_s: float
    penetration_m: float
    in_hand: bool
    diverged: bool


def judge(thresholds: Thresholds, figures: Figures) -> Outcome:
    """Return the outcome that the measured figures of a trial mean."""
    if figures.diverged:
        return Outcome.DIVERGED
    if not figures.in_hand or figures.final_lift_m < thresholds.held_fraction * figures.commanded_lift_m:
        return Outcome.DROPPED if figures.highest_lift_m >= thresholds.lifted_m else Outcome.MISSED
    if figures.penetration_m > thresholds.penetration_m:
        return Outcome.PENETRATED
    steady = (
        figures.slip_m <= thresholds.slip_m
        and figures.tilt_rad <= thresholds.tilt_rad
        and figures.creep_m_per_s <= thresholds.creep_m_per_s
    )
    return Outcome.HELD if steady else Outcome.SLIPPED


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
