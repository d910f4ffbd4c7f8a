"""Cups and bowls: hollow bodies of revolution with a bottom, open at the top."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import trimesh

from softhand_sim.objects.geometry import SECTORS, FloatArray, ShapeGeometry, hull, require_positive, revolve

LEVELS = 12  # choice: rings up a curved wall; a bowl's profile is then within 0.1 mm of its curve
WALL_SECTORS = 16  # choice: a 22.5 degree piece of a 160 mm bowl bulges 1.5 mm into it
WALL_LEVELS = 3  # pieces one above the other where the wall is curved
SECTORS_A_PIECE = SECTORS // WALL_SECTORS


@dataclass(frozen=True, kw_only=True)
class _Wall:
    """Checked dimensions of a vessel (metres); see `vessel`."""

    low: float
    high: float
    height: float
    thickness: float
    bottom: float
    exponent: float
    lip_width: float
    lip_height: float

    def __post_init__(self) -> None:
        if not 0.2 <= self.exponent <= 1.0:
            raise ValueError(f"bulge_exponent is {self.exponent}, allowed 0.2 to 1")
        if not self.high >= self.low > self.thickness:
            raise ValueError(
                f"bottom_diameter_m is {2 * self.low}, needs > twice wall_thickness_m {self.thickness} and <= "
                f"top_diameter_m {2 * self.high}"
            )
        if not self.bottom < self.height:
            raise ValueError(f"bottom_thickness_m is {self.bottom}, needs < height_m {self.height}")
        if not (self.lip_width >= 0.0 and 0.0 <= self.lip_height < self.height - self.bottom):
            raise ValueError(f"lip_width_m {self.lip_width} and lip_height_m {self.lip_height} do not fit the wall")

    @property
    def straight(self) -> bool:
        """Whether the wall is a cone or a cylinder."""
        return self.exponent == 1.0 or self.low == self.high

    @property
    def has_lip(self) -> bool:
        """Whether a lip runs around the top."""
        return self.lip_width > 0.0 and self.lip_height > 0.0

    def radius(self, z: float | FloatArray) -> FloatArray:
        """Outer radius at a height."""
        return np.asarray(self.low + (self.high - self.low) * (np.asarray(z) / self.height) ** self.exponent)

    def heights(self, count: int) -> FloatArray:
        """Heights that divide the radius evenly: a power below one rises steeply at the bottom, shape (count + 1,)."""
        return np.asarray(self.height * np.linspace(0.0, 1.0, count + 1) ** (1.0 / self.exponent))

    def profile(self) -> FloatArray:
        """Radius and height from the bottom's centre outside, over the rim, to its centre inside, shape (n, 2)."""
        z = self.heights(1 if self.straight else LEVELS)
        outside = [(0.0, 0.0), *zip(self.radius(z), z, strict=True)]
        if self.has_lip:
            under, edge = self.height - self.lip_height, self.high + self.lip_width
            outside = [(r, h) for r, h in outside if h < under]
            outside += [(float(self.radius(under)), under), (edge, under), (edge, self.height)]
        # 1.001: no ring a hair above the bottom's
        z = np.concatenate([[self.bottom], z[z > 1.001 * self.bottom]])[::-1]
        inside = [*zip(self.radius(z) - self.thickness, z, strict=True), (0.0, self.bottom)]
        return np.array([*outside, *inside], dtype=np.float64)

    def parts(self) -> list[trimesh.Trimesh]:
        """Convex pieces of bottom, wall and lip."""
        parts = [hull(np.vstack([_circle(float(self.radius(h)), h) for h in (0.0, self.bottom)]))]
        cuts = np.array([self.bottom, self.height])
        if not self.straight:
            cuts = np.concatenate([cuts[:1], [h for h in self.heights(WALL_LEVELS)[1:] if h > 1.001 * self.bottom]])
        for start, end in pairwise(cuts):
            levels = np.linspace(start, end, 2 if self.straight else 4)
            parts += _pieces([(float(self.radius(h)) - s, h) for h in levels for s in (0.0, self.thickness)])
        if self.has_lip:
            start, edge = self.height - self.lip_height, self.high + self.lip_width
            parts += _pieces([(r, h) for h in (start, self.height) for r in (float(self.radius(h)), edge)])
        return parts


def vessel(
    *,
    bottom_diameter_m: float,
    top_diameter_m: float,
    height_m: float,
    wall_thickness_m: float,
    bottom_thickness_m: float,
    bulge_exponent: float,
    lip_width_m: float,
    lip_height_m: float,
) -> ShapeGeometry:
    """Return an open vessel standing upright, axis z.

    The outer radius is r0 + (r1 - r0) (z/height)^e with e = `bulge_exponent`: 1 is a cone, less than 1 a bowl. The
    inner wall has the same shape, one wall thickness (measured horizontally) smaller. A lip runs around the top
    outside; `lip_width_m` or `lip_height_m` of 0 leaves it out.

    Raises
    ------
    ValueError
        If a length is out of range or the parts do not fit together.
    """
    require_positive(
        bottom_diameter_m=bottom_diameter_m,
        top_diameter_m=top_diameter_m,
        height_m=height_m,
        wall_thickness_m=wall_thickness_m,
        bottom_thickness_m=bottom_thickness_m,
    )
    wall = _Wall(
        low=bottom_diameter_m / 2.0,
        high=top_diameter_m / 2.0,
        height=height_m,
        thickness=wall_thickness_m,
        bottom=bottom_thickness_m,
        exponent=bulge_exponent,
        lip_width=lip_width_m,
        lip_height=lip_height_m,
    )
    radius, height = wall.profile().T
    return ShapeGeometry(mesh=revolve(radius, height, SECTORS), convex_parts=tuple(wall.parts()))


def _circle(radius: float, height: float) -> FloatArray:
    angle = np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(SECTORS, height)])


def _pieces(ring: list[tuple[float, float]]) -> list[trimesh.Trimesh]:
    """Return the hulls of a ring's section (radius, height) swept over each of WALL_SECTORS sectors."""
    circles = np.stack([_circle(r, z) for r, z in ring])
    chosen = [np.arange(i, i + SECTORS_A_PIECE + 1) % SECTORS for i in range(0, SECTORS, SECTORS_A_PIECE)]
    return [hull(circles[:, columns].reshape(-1, 3)) for columns in chosen]


KINDS = {"vessel": vessel}
