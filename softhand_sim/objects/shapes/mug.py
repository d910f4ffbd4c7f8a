"""The mug: a hollow cup with a bottom and a strap handle, one closed surface without any boolean operation.

The cup's outer wall is a grid in angle and height with two rectangular windows left open; the handle is a
tube whose first and last ring are the rims of those windows.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import trimesh

from softhand_sim.objects.geometry import (
    FloatArray,
    IntArray,
    ShapeGeometry,
    fan,
    hull,
    join_rings,
    require_positive,
    surface,
)

SIDES = 60  # choice: faces around; divisible by the number of wall parts
WINDOW_COLUMNS = 3  # grid cells of a handle window around ...
WINDOW_ROWS = 2  # ... and up
GAP_ROWS = 6  # choice: rows of the wall between the windows
WALL_PARTS = 12  # choice: a 30 degree piece of wall bulges 1.3 mm into the cup
HANDLE_PARTS = 5  # choice: a 36 degree piece of the handle bulges 1 mm into its hole
STEPS_PER_HANDLE_PART = 4


@dataclass(frozen=True, kw_only=True)
class _Cup:
    """Checked dimensions of a mug (metres); see `mug`."""

    radius: float
    height: float
    wall: float
    bottom: float
    reach: float
    handle_height: float
    strap: float
    strap_width: float

    def __post_init__(self) -> None:
        if not (self.wall < self.radius and self.bottom < self.height):
            raise ValueError("wall_thickness_m and bottom_thickness_m need to be < the radius and the height")
        if min(self.semi_x, self.semi_z) <= 0.0 or self._tightest_bend <= self.strap / 2.0:
            raise ValueError(
                f"handle_reach_m {self.reach} and handle_height_m {self.handle_height} leave no hole inside a strap of "
                f"strap_thickness_m {self.strap}"
            )
        if not (self.bottom < self.low and self.high < self.height):
            raise ValueError(f"the handle spans z = {self.low:.4f} to {self.high:.4f} m, needs to lie on the wall")
        if not self.strap_width < self.radius:
            raise ValueError(f"strap_width_m is {self.strap_width}, needs < the cup's radius {self.radius}")

    @property
    def semi_x(self) -> float:
        """Half axis of the handle's centre line along x."""
        return self.reach - self.strap / 2.0

    @property
    def semi_z(self) -> float:
        """Half axis of the handle's centre line along z."""
        return (self.handle_height - self.strap) / 2.0

    @property
    def _tightest_bend(self) -> float:
        return min(self.semi_x, self.semi_z) ** 2 / max(self.semi_x, self.semi_z)

    @property
    def low(self) -> float:
        """Lower end of the handle: it sits half-way up the cup."""
        return (self.height - self.handle_height) / 2.0

    @property
    def high(self) -> float:
        """Upper end of the handle."""
        return (self.height + self.handle_height) / 2.0


def mug(
    *,
    diameter_m: float,
    height_m: float,
    wall_thickness_m: float,
    bottom_thickness_m: float,
    handle_reach_m: float,
    handle_height_m: float,
    strap_thickness_m: float,
    strap_width_m: float,
) -> ShapeGeometry:
    """Return an upright mug: axis z, table at z = 0, handle towards +x, half-way up.

    The handle's centre line is half an ellipse from wall to wall; its outside reaches `handle_reach_m` from
    the wall and spans `handle_height_m`. Its section is a rectangle, `strap_width_m` along y.

    Raises
    ------
    ValueError
        If a length is not positive or the parts do not fit together.
    """
    require_positive(**dict(locals()))
    cup = _Cup(
        radius=diameter_m / 2.0,
        height=height_m,
        wall=wall_thickness_m,
        bottom=bottom_thickness_m,
        reach=handle_reach_m,
        handle_height=handle_height_m,
        strap=strap_thickness_m,
        strap_width=strap_width_m,
    )
    angle = _angles(float(np.arcsin(cup.strap_width / 2.0 / cup.radius)))
    vertices, faces, lower, upper = _cup_surface(cup, angle)
    rings = _handle_rings(cup, vertices[lower])
    loops = np.concatenate([vertices[lower][None], rings, vertices[upper][None]])
    parts = _cup_parts(cup, angle)
    for first in range(0, HANDLE_PARTS * STEPS_PER_HANDLE_PART, STEPS_PER_HANDLE_PART):
        parts.append(hull(loops[first : first + STEPS_PER_HANDLE_PART + 1].reshape(-1, 3)))
    index = len(vertices) + np.arange(rings.shape[0] * rings.shape[1]).reshape(rings.shape[:2])
    chain = [lower, *index, upper]
    handle_faces = [join_rings(a, b) for a, b in pairwise(chain)]
    mesh = surface(np.vstack([vertices, rings.reshape(-1, 3)]), np.vstack([faces, *handle_faces]))
    mesh.remove_unreferenced_vertices()  # the grid points inside the windows
    return ShapeGeometry(mesh=mesh, convex_parts=tuple(parts))


def _angles(half_window: float) -> FloatArray:
    """Return SIDES angles, anticlockwise; the first WINDOW_COLUMNS cells are the handle's window about +x."""
    window = np.linspace(-half_window, half_window, WINDOW_COLUMNS + 1)
    rest = np.linspace(half_window, 2.0 * np.pi - half_window, SIDES - WINDOW_COLUMNS + 1)[1:-1]
    return np.concatenate([window, rest])


def _circle(radius: float, z: float, angle: FloatArray) -> FloatArray:
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), z)])


def _cup_surface(cup: _Cup, angle: FloatArray) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """Return vertices and faces of the cup with its two windows, and their rims in the order of the handle's rings."""
    edges = [0.0, cup.bottom, cup.low, cup.low + cup.strap, cup.high - cup.strap, cup.high, cup.height]
    cells = [1, 1, WINDOW_ROWS, GAP_ROWS, WINDOW_ROWS, 1]
    levels = [np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairwise(edges), cells, strict=True)]
    z = np.concatenate([[0.0], *levels])
    blocks = [_circle(cup.radius, h, angle) for h in z]
    blocks += [_circle(cup.radius - cup.wall, h, angle) for h in (cup.height, cup.bottom)]
    vertices = np.vstack([*blocks, [[0.0, 0.0, 0.0]], [[0.0, 0.0, cup.bottom]]])
    grid = np.arange(len(blocks) * SIDES).reshape(len(blocks), SIDES)
    lower_row, upper_row = 2, 2 + WINDOW_ROWS + GAP_ROWS
    open_rows = {row + i for row in (lower_row, upper_row) for i in range(WINDOW_ROWS)}
    faces = [fan(grid[0], grid.size, reverse=True)]
    for row in range(len(blocks) - 1):  # up the outer wall, over the rim, down the inner wall
        strip = join_rings(grid[row], grid[row + 1]).reshape(2, SIDES, 3)
        faces.append(strip[:, WINDOW_COLUMNS if row in open_rows else 0 :].reshape(-1, 3))
    faces.append(fan(grid[-1], grid.size + 1))
    # the outside of the bend is the lower window's bottom edge but the upper window's top edge
    upper = _window_rim(grid, upper_row)[_UP_DOWN_MIRROR]
    return vertices, np.vstack(faces), _window_rim(grid, lower_row), upper


def _window_rim(grid: IntArray, row: int) -> IntArray:
    """Return the rim of a window, anticlockwise seen from outside, starting at its lower -y corner."""
    top, last = row + WINDOW_ROWS, WINDOW_COLUMNS
    sides = [grid[row, :last], grid[row:top, last], grid[top, last:0:-1], grid[top:row:-1, 0]]
    return np.concatenate(sides)


_RIM_LENGTH = 2 * (WINDOW_COLUMNS + WINDOW_ROWS)
# entry k of a mirrored rim is the entry straight above or below entry k of the rim
_UP_DOWN_MIRROR = (2 * WINDOW_COLUMNS + WINDOW_ROWS - np.arange(_RIM_LENGTH)) % _RIM_LENGTH


def _handle_rings(cup: _Cup, lower_rim: FloatArray) -> FloatArray:
    """Return the handle's sections between its two roots, shape (steps - 1, rim length, 3)."""
    root = float(lower_rim[:, 0].mean())
    outward = lower_rim[:, 2].mean() - lower_rim[:, 2]  # coordinate along the outer normal of the bend
    rings = []
    for t in np.linspace(0.0, np.pi, HANDLE_PARTS * STEPS_PER_HANDLE_PART + 1)[1:-1]:
        normal = np.array([cup.semi_z * np.sin(t), -cup.semi_x * np.cos(t)])
        normal /= np.linalg.norm(normal)
        x = root + cup.semi_x * np.sin(t) + outward * normal[0]
        z = cup.height / 2.0 - cup.semi_z * np.cos(t) + outward * normal[1]
        rings.append(np.column_stack([x, lower_rim[:, 1], z]))
    return np.stack(rings)


def _cup_parts(cup: _Cup, angle: FloatArray) -> list[trimesh.Trimesh]:
    """Return the bottom disc and the wall pieces as convex hulls; together they fill the cup's material."""
    parts = [hull(np.vstack([_circle(cup.radius, z, angle) for z in (0.0, cup.bottom)]))]
    per_part = SIDES // WALL_PARTS
    for i in range(WALL_PARTS):
        piece = angle[np.arange(i * per_part, (i + 1) * per_part + 1) % SIDES]
        radii = (cup.radius, cup.radius - cup.wall)
        parts.append(hull(np.vstack([_circle(r, z, piece) for r in radii for z in (cup.bottom, cup.height)])))
    return parts


KINDS = {"mug": mug}
