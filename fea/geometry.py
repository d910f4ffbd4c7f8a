"""Dimensions of the finger. The paper gives them in figures only, so every one here is a choice with its reason."""

from dataclasses import asdict, dataclass, field, fields
from math import pi
from typing import Any

MINIMUM_WALL_M = 2e-3
"""Minimum wall thickness of actuator and exoskeleton: Alves et al., section 2.2."""

JOINT_NAMES = ("proximal", "middle", "distal")


def _choice(default: Any, reason: str) -> Any:
    return field(default=default, metadata={"choice": reason})


@dataclass(frozen=True, kw_only=True)
class FingerGeometry:
    """Dimensions of one finger in metres; straight along +z, base plane z = 0, palm side +x (theta = 0).

    The metadata of each field holds the reason for its default (:func:`choices`).

    Raises
    ------
    ValueError
        If a wall is thinner than 2 mm or parts do not fit; the message names field, value and allowed range.
    """

    actuator_inner_radius_m: float = _choice(3.0e-3, "2.5 mm wall: the thinner 4/6 mm actuator kinked below 75 kPa")
    ring_radius_m: float = _choice(4.5e-3, "middle radius of the rings; 1.25 mm of silicone inside, the first layer")
    actuator_outer_radius_m: float = _choice(5.5e-3, "fits a tube of human finger width with a 2 mm wall")
    actuator_length_m: float = _choice(90.0e-3, "length of a human index finger with its end plate")
    cap_thickness_m: float = _choice(3.0e-3, "stiff against bulging at 80 kPa")
    ring_count: int = field(default=44, metadata={"source": "Alves et al., section 2.2: 44 equally spaced rings"})
    ring_width_m: float = _choice(0.5e-3, "0.5 mm x 0.5 mm gives the paper's section of 0.25 mm^2")
    ring_height_m: float = _choice(0.5e-3, "0.5 mm x 0.5 mm gives the paper's section of 0.25 mm^2")
    clearance_m: float = _choice(0.2e-3, "sliding fit of the actuator in the printed tube")
    tube_wall_m: float = _choice(2.0e-3, "the paper's minimum wall: lightest printable exoskeleton")
    sector_half_angle_rad: float = _choice(
        62.2 * pi / 180.0,
        "analysis (iii) with friction 0.3 reaches 95 degrees at 75 kPa (calibration mesh); a degree costs 2.8 degrees",
    )
    flexure_thickness_m: float = _choice(3.3e-3, "between wall and human finger width; a weak handle on the angle")
    gap_length_m: float = _choice(
        5.0e-3, "a study of the complete finger: longer gaps let the actuator lift out of the middle one below 80 kPa"
    )
    gap_start_m: tuple[float, float, float] = _choice((5.4e-3, 36.0e-3, 60.0e-3), "human proportions of the phalanges")
    end_plate_m: float = _choice(2.0e-3, "the paper's minimum wall; carries the thrust of the cap")

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name.endswith("_m") and isinstance(value, float) and not 0.0 < value < 0.3:
                raise ValueError(f"{item.name} = {value:g} m must lie in (0, 0.3) m; are the units metres?")
        self._check_walls()
        self._check_rings()
        self._check_gaps()

    def _check_walls(self) -> None:
        inner, outer = self.actuator_inner_radius_m, self.actuator_outer_radius_m
        if inner >= outer:
            raise ValueError(f"actuator_inner_radius_m = {inner:.6g} m: chamber larger than actuator ({outer:.6g} m)")
        if self.cap_thickness_m >= self.actuator_length_m:
            raise ValueError(
                f"cap_thickness_m = {self.cap_thickness_m:.6g} m must be below actuator_length_m"
                f" = {self.actuator_length_m:.6g} m: it leaves no chamber"
            )
        walls = {
            "actuator_outer_radius_m - actuator_inner_radius_m": self.actuator_wall_m,
            "cap_thickness_m": self.cap_thickness_m,
            "tube_wall_m": self.tube_wall_m,
            "end_plate_m": self.end_plate_m,
            "flexure_thickness_m": self.flexure_thickness_m,
        }
        for name, wall in walls.items():
            if wall < MINIMUM_WALL_M - 1e-9:
                raise ValueError(
                    f"{name} = {wall:.6g} m must be at least {MINIMUM_WALL_M} m (the paper's minimum wall)"
                )
        if self.flexure_thickness_m < self.tube_wall_m:
            raise ValueError(f"flexure_thickness_m = {self.flexure_thickness_m} must be at least tube_wall_m")
        if not 0.3 <= self.sector_half_angle_rad <= pi / 2.0:
            raise ValueError(f"sector_half_angle_rad = {self.sector_half_angle_rad} must lie in [0.3, pi/2]")

    def _check_rings(self) -> None:
        if not 1 <= self.ring_count <= 200:
            raise ValueError(f"ring_count = {self.ring_count} must lie in [1, 200]")
        cover = 0.1e-3
        low = self.actuator_inner_radius_m + 0.5 * self.ring_height_m + cover
        high = self.actuator_outer_radius_m - 0.5 * self.ring_height_m - cover
        if not low <= self.ring_radius_m <= high:
            raise ValueError(
                f"ring_radius_m = {self.ring_radius_m} must lie in [{low:.6g}, {high:.6g}], inside the wall"
            )
        if self.ring_width_m > 0.9 * self.ring_pitch_m:
            raise ValueError(
                f"ring_width_m = {self.ring_width_m} must be below 0.9 of the pitch {self.ring_pitch_m:.6g}"
            )

    def _check_gaps(self) -> None:
        if len(self.gap_start_m) != 3:
            raise ValueError(f"gap_start_m = {self.gap_start_m} must hold three positions")
        end = 0.0
        for i, start in enumerate(self.gap_start_m):
            if start < end + MINIMUM_WALL_M:
                raise ValueError(f"gap_start_m[{i}] = {start} must be at least {end + MINIMUM_WALL_M:.6g} m")
            end = start + self.gap_length_m
        if end > self.actuator_length_m - MINIMUM_WALL_M:
            raise ValueError(f"gap_start_m[2] + gap_length_m = {end:.6g} must stay 2 mm inside actuator_length_m")

    @property
    def actuator_wall_m(self) -> float:
        """Thickness of the actuator's wall as a whole [m]."""
        return self.actuator_outer_radius_m - self.actuator_inner_radius_m

    @property
    def chamber_length_m(self) -> float:
        """Length of the chamber: actuator without cap [m]."""
        return self.actuator_length_m - self.cap_thickness_m

    @property
    def ring_pitch_m(self) -> float:
        """Axial distance of the rings [m]."""
        return self.chamber_length_m / self.ring_count

    @property
    def tube_inner_radius_m(self) -> float:
        """Inner radius of the exoskeleton's tube [m]."""
        return self.actuator_outer_radius_m + self.clearance_m

    @property
    def tube_outer_radius_m(self) -> float:
        """Outer radius of the exoskeleton's tube [m]."""
        return self.tube_inner_radius_m + self.tube_wall_m

    @property
    def finger_length_m(self) -> float:
        """Length of the finger with its end plate [m]."""
        return self.actuator_length_m + self.end_plate_m

    @property
    def joint_position_m(self) -> tuple[float, ...]:
        """Middle of each joint gap along the finger [m]."""
        return tuple(start + 0.5 * self.gap_length_m for start in self.gap_start_m)

    def as_dict(self) -> dict[str, Any]:
        """Return every field, JSON ready."""
        return {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(self).items()}


def choices() -> dict[str, str]:
    """Return for every dimension why it has its default (or the source, where the paper states it)."""
    return {item.name: f"{kind}: {text}" for item in fields(FingerGeometry) for kind, text in item.metadata.items()}
