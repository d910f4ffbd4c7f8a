"""Contact settings shared by the finger pads and by what they touch."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ContactSettings:
    """Soft-contact parameters of MuJoCo's constraint model (choices, by a stability study of 18 grasps).

    In that study a time constant of 0.02 s or 0.004 s changed two verdicts of 18 against a reference at
    0.5 ms; 0.006 s changed none. ``condim`` 3 changed three (no torsional friction), 4 and 6 none.

    Attributes
    ----------
    time_constant_s: time in which a penetration decays (``solref[0]``); at least twice the time step.
    damping_ratio: 1 is critical (``solref[1]``).
    condim: 4 adds torsional friction to sliding friction.
    torsional_m: torsional friction coefficient; about the radius of a pad's contact patch.
    pad_friction: sliding coefficient of TPU against table and fingers (choice: rubbery, unlubricated).
    """

    time_constant_s: float = 0.006
    damping_ratio: float = 1.0
    condim: int = 4
    torsional_m: float = 0.005
    rolling_m: float = 0.0001
    pad_friction: float = 0.8

    @property
    def solref(self) -> tuple[float, float]:
        """MuJoCo's ``solref`` pair (s, 1)."""
        return (self.time_constant_s, self.damping_ratio)

    def friction(self, sliding: float) -> tuple[float, float, float]:
        """MuJoCo's friction triple for a sliding coefficient (1, m, m)."""
        return (sliding, self.torsional_m, self.rolling_m)
