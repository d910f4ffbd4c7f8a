"""Contact settings shared by the finger pads and by what they touch."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ContactSettings:
    """Soft-contact parameters of MuJoCo's constraint model (choices, by a stability study of 18 grasps).

    Attributes
    ----------
    time_constant_s, damping_ratio
        MuJoCo's ``solref``. In that study a time constant of 20 or 4 ms changed two verdicts each against a
        reference at 0.5 ms, 6 ms none. At least twice the time step.
    condim
        4: sliding and torsional friction. In that study 3 changed three verdicts, 4 and 6 none.
    patch_radius_m
        Radius a of a pad's contact patch; the torsional coefficient is 2/3 mu a (disc under uniform pressure).
        Choice: half a fingertip's radius.
    rolling_friction_m
        Used with condim 6 only. MuJoCo's default.
    pad_friction
        Sliding coefficient of TPU against table and fingers (choice: rubbery, unlubricated).
    object_priority
        Above the hand's and table's 0, so that an object's own friction holds in each of its contacts, instead of
        the larger of the two bodies' values: an oiled object is slippery however rough the finger is.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    time_constant_s: float = 0.006
    damping_ratio: float = 1.0
    condim: int = 4
    patch_radius_m: float = 0.004
    rolling_friction_m: float = 1e-4
    pad_friction: float = 0.8
    object_priority: int = 1

    def __post_init__(self) -> None:
        if self.condim not in (1, 3, 4, 6):
            raise ValueError(f"condim is {self.condim}, allowed 1, 3, 4, 6")
        for name in ("patch_radius_m", "rolling_friction_m", "pad_friction"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}, needs a finite number >= 0")
        for name in ("time_constant_s", "damping_ratio"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}, needs a finite number > 0")

    @property
    def solref(self) -> tuple[float, float]:
        """MuJoCo's ``solref`` pair (s, 1)."""
        return (self.time_constant_s, self.damping_ratio)

    def friction(self, sliding: float) -> tuple[float, float, float]:
        """MuJoCo's friction triple for a sliding coefficient (1, m, m)."""
        return (sliding, 2.0 / 3.0 * sliding * self.patch_radius_m, self.rolling_friction_m)
