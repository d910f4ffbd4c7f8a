"""Triangle surfaces built from profiles and rings, and what a shape generator returns."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
import trimesh

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

SECTORS = 64  # choice: a 64-gon has 0.16 % less area than its circle
HULL_SECTORS = 32  # choice: facets of a collision hull stay within 0.2 mm of a 40 mm radius


LARGEST_M = 100.0
"""Choice: no hand holds it; numbers without a meaning stop here and not in the mesh library."""


def require_positive(**lengths: float) -> None:
    """Raise ValueError, naming the length, unless every length is above zero and below `LARGEST_M`."""
    for name, value in lengths.items():
        if not 0.0 < value < LARGEST_M:
            raise ValueError(f"{name} is {value}, needs a finite number > 0, and < {LARGEST_M:g}")


@dataclass(frozen=True, kw_only=True)
class Primitive:
    """A shape that the physics engine knows by itself, centred at the origin and aligned with the axes.

    Attributes
    ----------
    kind : {"sphere", "cylinder", "box"}
        A cylinder's axis is z.
    size_m : tuple of float
        MuJoCo's sizes: (radius,), (radius, half height) or the three half sides.
    """

    kind: Literal["sphere", "cylinder", "box"]
    size_m: tuple[float, ...]

    def __post_init__(self) -> None:
        count = {"sphere": 1, "cylinder": 2, "box": 3}[self.kind]
        if len(self.size_m) != count or min(self.size_m) <= 0.0:
            raise ValueError(f"size_m of a {self.kind} needs {count} positive lengths, not {self.size_m}")


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapeGeometry:
    """What a generator makes: metres, z up, in its resting pose; the origin is wherever the generator likes.

    Attributes
    ----------
    mesh : trimesh.Trimesh
        Closed surface, normals outward; a cavity is a second surface with normals into the cavity.
    convex_parts : tuple of trimesh.Trimesh
        Convex solids that together stand for the body in collisions.
    primitive : Primitive, optional
        The same solid as an engine primitive, centred at the mass centre.
    """

    mesh: trimesh.Trimesh
    convex_parts: tuple[trimesh.Trimesh, ...]
    primitive: Primitive | None = None


def surface(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> trimesh.Trimesh:
    """Return a mesh of exactly these triangles: nothing merged, reordered or dropped."""
    return trimesh.Trimesh(
        vertices=np.asarray(vertices, dtype=np.float64),
        faces=np.asarray(faces, dtype=np.int64),
        process=False,
    )


def hull(points: npt.ArrayLike) -> trimesh.Trimesh:
    """Return the convex hull of points, shape (n, 3), as a mesh with outward normals."""
    return trimesh.convex.convex_hull(np.asarray(points, dtype=np.float64))


def join_rings(first: npt.ArrayLike, second: npt.ArrayLike) -> IntArray:
    """Return triangles, shape (2n, 3), between two closed rings of n vertex indices each.

    With both rings anticlockwise seen against the direction first -> second, the normals point out of the
    tube.
    """
    a, b = np.asarray(first, dtype=np.int64), np.asarray(second, dtype=np.int64)
    a_next, b_next = np.roll(a, -1), np.roll(b, -1)
    return np.vstack([np.column_stack([a, a_next, b_next]), np.column_stack([a, b_next, b])])


def fan(ring: npt.ArrayLike, apex: int, *, reverse: bool = False) -> IntArray:
    """Return triangles, shape (n, 3), from a closed ring of n vertex indices to one apex vertex."""
    ring = np.asarray(ring, dtype=np.int64)
    triangles = np.column_stack([ring, np.roll(ring, -1), np.full(len(ring), apex, dtype=np.int64)])
    return triangles[:, ::-1] if reverse else triangles


def tube(start: npt.ArrayLike, rings: npt.ArrayLike, end: npt.ArrayLike) -> trimesh.Trimesh:
    """Return the closed surface through rings, shape (m, n, 3), shut by one apex point at each end.

    The rings run anticlockwise seen from the side of `end`.
    """
    points = np.asarray(rings, dtype=np.float64)
    m, n, _ = points.shape
    vertices = np.vstack([points.reshape(-1, 3), np.atleast_2d(start), np.atleast_2d(end)])
    index = np.arange(m * n).reshape(m, n)
    sides = [join_rings(index[i], index[i + 1]) for i in range(m - 1)]
    caps = [fan(index[0], m * n, reverse=True), fan(index[-1], m * n + 1)]
    return surface(vertices, np.vstack([*caps[:1], *sides, *caps[1:]]))


def revolve(radius_m: FloatArray, height_m: FloatArray, sectors: int) -> trimesh.Trimesh:
    """Return the closed surface of revolution about z of a profile, both shape (m,), from bottom to top.

    The first and last radius are on the axis (their value is ignored).
    """
    angle = np.linspace(0.0, 2.0 * np.pi, sectors, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(sectors)])
    rings = radius_m[1:-1, None, None] * circle + height_m[1:-1, None, None] * np.array([0.0, 0.0, 1.0])
    return tube((0.0, 0.0, height_m[0]), rings, (0.0, 0.0, height_m[-1]))
