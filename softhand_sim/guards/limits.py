"""What a running trial may not pass."""

from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any

from softhand_sim.checks import require_finite


class AlarmKind(StrEnum):
    """Which guard fired; the same words as `softhand_sim.grasp.verdict.Outcome`."""

    DIVERGED = "DIVERGED"
    UNBALANCED = "UNBALANCED"
    PENETRATED = "PENETRATED"
    EXTRAPOLATED = "EXTRAPOLATED"


@dataclass(frozen=True, kw_only=True)
class Alarm:
    """A guard that fired.

    Attributes
    ----------
    kind: which one.
    quantity: what passed its limit, with its SI unit in the name.
    figure, limit: the value and what was allowed; a figure that is not finite is given as 0, with limit 0.
    time_s: simulated time.
    """

    kind: AlarmKind
    quantity: str
    figure: float
    limit: float
    time_s: float

    def data(self) -> dict[str, Any]:
        """Return the alarm for a JSON file."""
        return {**vars(self), "kind": self.kind.value}

    def text(self) -> str:
        """Return the alarm in a line."""
        return f"{self.kind.value} at {self.time_s:.2f} s: {self.quantity} {self.figure:.4g}, allowed {self.limit:.4g}"


@dataclass(frozen=True, kw_only=True)
class Guards:
    """Limits of a trial; None takes a guard away. Divergence has no limit and is always watched.

    Attributes
    ----------
    energy_j: mechanical energy that may appear beyond the actuators' work (`softhand_sim.guards.energy`). Choice: in a
        trial of each of the forty objects 36 stay below 1 mJ and 38 below 2.4; the others, 16 and 67 mJ, have a joint
        bent backward by 1.1 and 2.0 rad.
    penetration_m: deepest contact of the object with anything, or of one finger with another. Choice: a quarter of a
        finger's thickness; the deepest of the forty is 2.3 mm.
    past_stop_rad: angle of a joint beyond its stops. Choice: stops are soft, held objects pass them by 0.1 rad, lost
        ones by up to 0.42; beyond half a radian there is no such finger.
    past_pressure_pa: set pressure, or pressure in a finger, beyond the calibration's highest. Choice: an eighth of the
        range. Less than that is told in `TrialResult.beyond_calibration`.

    Raises
    ------
    ValueError
        If a limit is no positive number.
    """

    energy_j: float | None = 0.010
    penetration_m: float | None = 0.005
    past_stop_rad: float | None = 0.5
    past_pressure_pa: float | None = 10e3

    def __post_init__(self) -> None:
        for item in fields(self):
            if getattr(self, item.name) is not None:
                require_finite(item.name, getattr(self, item.name), above=0.0)
