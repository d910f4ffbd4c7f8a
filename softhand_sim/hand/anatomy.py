"""Where the five identical fingers sit on the palm: the one place that holds the hand's layout."""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.elements import FINGERS

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FingerMount:
    """Pose of a finger's base in the palm's frame (x to the fingertips, y radial, z out of the palm).

    Attributes
    ----------
    base_m: centre of the finger's base plane, shape (3,).
    azimuth_deg, elevation_deg: direction of the straight finger, from +x about z, then out of the palm.
    curl_to_m: point of the palm's frame toward which the finger curls, shape (3,).
    """

    base_m: tuple[float, float, float]
    azimuth_deg: float
    elevation_deg: float
    curl_to_m: tuple[float, float, float]

    def rotation(self) -> Vector:
        """Rotation from finger to palm frame, shape (3, 3): columns curl direction x, hinge axis y, axis z."""
        azimuth, elevation = math.radians(self.azimuth_deg), math.radians(self.elevation_deg)
        along = np.array(
            [
                math.cos(elevation) * math.cos(azimuth),
                math.cos(elevation) * math.sin(azimuth),
                math.sin(elevation),
            ]
        )
        toward = np.asarray(self.curl_to_m) - np.asarray(self.base_m)
        across = toward - along * float(toward @ along)
        size = float(np.linalg.norm(across))
        if size < 1e-6:
            raise ValueError(f"curl_to_m {self.curl_to_m}: lies on the finger's own axis; move it off by > 1e-6 m")
        curl = across / size
        return np.column_stack([curl, np.cross(along, curl), along])


def _long_finger(x_m: float, y_m: float, fan_deg: float) -> FingerMount:
    return FingerMount(
        base_m=(x_m, y_m, 0.004),
        azimuth_deg=fan_deg,
        # a claw at rest: 95 degrees of bending close a hand with flat fingers only half
        elevation_deg=74.9,
        # the fingers converge a little, so that a ball is not squeezed out between them
        curl_to_m=(-0.035, 0.83 * y_m, 0.045),
    )


def _default_mounts() -> dict[str, FingerMount]:
    return {
        "thumb": FingerMount(
            base_m=(-0.0314, -0.0019, 0.005),
            azimuth_deg=185.9,
            elevation_deg=62.4,
            curl_to_m=(0.050, 0.0069, 0.040),
        ),
        "index": _long_finger(0.046, 0.0315, 7.6),
        "middle": _long_finger(0.054, 0.0105, 2.5),
        "ring": _long_finger(0.050, -0.0105, -2.5),
        "little": _long_finger(0.040, -0.0315, -7.6),
    }


@dataclass(frozen=True, kw_only=True)
class HandAnatomy:
    """Palm, finger mounts and wrist. The paper gives no dimensions: every default here is a choice.

    Four fingers 21 mm apart oppose one thumb 85 mm behind them, wide enough for a 75 mm fruit. Thumb and curl
    directions come from a random search for the layout that holds plain spheres (65 and 75 mm) and a cylinder
    with a handle (80 mm) from the most offsets within +-10 mm; none of the catalogue's objects was in it. The
    palm's mass makes the whole hand the paper's 100 g.

    Attributes
    ----------
    palm_size_m: full sides of the palm's box, shape (3,).
    hand_mass_kg: mass of palm and five fingers together (paper: about 100 g).
    wrist_speed_m_per_s: largest speed of the wrist (paper: 100 mm/s); wrist_rate_rad_per_s: largest turning
        rate (choice: 100 mm/s at an arm of 0.1 m).
    wrist_stiffness_n_per_m, wrist_stiffness_n_m_per_rad, wrist_armature_kg, wrist_armature_kg_m2: the arm that
        carries the wrist, stiff beside the fingers (choice: 0.25 mm of sag under the hand's weight).
    """

    mounts: dict[str, FingerMount] = field(default_factory=_default_mounts)
    palm_size_m: tuple[float, float, float] = (0.090, 0.080, 0.012)
    hand_mass_kg: float = 0.100
    wrist_speed_m_per_s: float = 0.1
    wrist_rate_rad_per_s: float = 1.0
    wrist_stiffness_n_per_m: float = 4000.0
    wrist_stiffness_n_m_per_rad: float = 40.0
    wrist_armature_kg: float = 1.0
    wrist_armature_kg_m2: float = 0.01

    def __post_init__(self) -> None:
        if list(self.mounts) != list(FINGERS):
            raise ValueError(f"mounts: {list(self.mounts)} must be {list(FINGERS)} in this order")
        for name in ("hand_mass_kg", "wrist_speed_m_per_s", "wrist_rate_rad_per_s", "wrist_stiffness_n_per_m"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name}: {getattr(self, name)} must be above 0")
