"""What the open hand spans, and what of it must stay above the table."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.elements import FINGERS
from softhand_sim.hand.anatomy import HandAnatomy

Vector = npt.NDArray[np.float64]

# choice: how far fingertips may scrape along the table; straight, they give way to about 0.1 N there
TABLE_PRESS_M = 0.014
# choice: the palm's edge and the lowest finger clear the table by this
TABLE_GAP_M = 0.006
# places along a finger that are kept above the table, as shares of its length
_ALONG = (0.0, 0.5, 1.0)


@dataclass(frozen=True, kw_only=True)
class HandReach:
    """What the open hand spans, in the palm's frame.

    Attributes
    ----------
    depth_m: of the straight fingertips below the palm.
    opening_m: between thumb and middle finger at half that depth, pads' thickness taken off.
    centre_m: middle of that opening along the palm's x axis.
    half_width_m: of palm and fingers along y.
    half_palm_m: half sides of the palm along x and y, shape (2,).
    points_m: corners of the palm, and points along the fingers' axes, shape (n, 3).
    above_m: height that each point keeps over the table, shape (n,).
    tip: which of the points are fingertips, shape (n,).
    """

    depth_m: float
    opening_m: float
    centre_m: float
    half_width_m: float
    half_palm_m: Vector
    points_m: Vector
    above_m: Vector
    tip: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, calibration: FingerCalibration, anatomy: HandAnatomy) -> "HandReach":
        """Measure a hand at rest."""
        finger, mounts = calibration.finger, anatomy.mounts
        radius = finger.outer_radius_m
        tips = {n: np.array(mounts[n].base_m) + finger.length_m * mounts[n].rotation()[:, 2] for n in FINGERS}
        depth = max(tip[2] for tip in tips.values())
        middles = {}
        for name in ("thumb", "middle"):
            base = np.array(mounts[name].base_m)
            middles[name] = base[0] + (0.5 * depth - base[2]) / (tips[name][2] - base[2]) * (tips[name][0] - base[0])
        widest = max(0.5 * anatomy.palm_size_m[1], *(abs(tip[1]) + radius for tip in tips.values()))
        half = 0.5 * np.array(anatomy.palm_size_m)
        corners = [(x, y, z) for x in (-half[0], half[0]) for y in (-half[1], half[1]) for z in (-2.0 * half[2], 0.0)]
        along = [
            np.array(mounts[n].base_m) + share * (finger.length_m - radius) * mounts[n].rotation()[:, 2]
            for n in FINGERS
            for share in _ALONG
        ]
        return cls(
            depth_m=float(depth),
            opening_m=float(middles["middle"] - middles["thumb"] - 2.0 * radius),
            centre_m=float(0.5 * (middles["middle"] + middles["thumb"])),
            half_width_m=float(widest),
            half_palm_m=half[:2],
            points_m=np.array([*corners, *along]),
            above_m=np.array([TABLE_GAP_M] * len(corners) + [radius] * len(along)),
            tip=np.array([False] * len(corners) + [share == 1.0 for _ in FINGERS for share in _ALONG]),
        )

    def too_low_m(self, place_m: Vector, axes: Vector, press_m: float) -> float:
        """Return by how much (m) the open hand must rise to clear the table, 0 if it does.

        Parameters
        ----------
        place_m: of the palm's centre in the world, shape (3,).
        axes: shape (3, 3), columns the palm's axes in the world.
        press_m: how far fingertips may press into the table.
        """
        height = place_m[2] + self.points_m @ axes[2]
        return max(0.0, float((self.above_m - press_m * self.tip - height).max()))
