"""What a trial does: approach, close, lift, hold; and how the object may lie differently from what is expected."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class LiftProtocol:
    """The paper's grasp: close to set angles, lift at 100 mm/s, hold.

    Attributes
    ----------
    approach_m: distance from the grasp pose at which the hand starts (choice).
    close_s: time given to the valves to fill the fingers (choice: the triple element fills in about 1 s).
    lift_m, hold_s: height and duration of the hold. The lift runs at the wrist's speed limit (paper: 100 mm/s).
    settle_s: rest between phases, so that slip is measured from a standing hand (choice).
    position_noise_m, yaw_noise_rad: largest offset of the object from where the hand expects it, uniform (choice).
    """

    approach_m: float = 0.05
    close_s: float = 2.5
    lift_m: float = 0.15
    hold_s: float = 3.0
    settle_s: float = 0.3
    position_noise_m: float = 0.010
    yaw_noise_rad: float = 0.17453292519943295

    def __post_init__(self) -> None:
        for name in ("approach_m", "close_s", "lift_m", "hold_s"):
            if not 0.0 < getattr(self, name) < 100.0:
                raise ValueError(f"{name}: {getattr(self, name)} must lie in (0, 100)")
        for name in ("settle_s", "position_noise_m", "yaw_noise_rad"):
            if not 0.0 <= getattr(self, name) < 10.0:
                raise ValueError(f"{name}: {getattr(self, name)} must lie in [0, 10)")

    def draw_offset(self, rng: np.random.Generator) -> tuple[float, float, float]:
        """Draw the object's displacement x, y (m) and turn about the vertical (rad)."""
        x, y = rng.uniform(-self.position_noise_m, self.position_noise_m, size=2)
        return float(x), float(y), float(rng.uniform(-self.yaw_noise_rad, self.yaw_noise_rad))
