"""Antipodal pairs of surface points: where two opposed contacts with friction can hold a body."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import trimesh

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class AntipodalPairs:
    """Pairs of points on a surface.

    Attributes
    ----------
    middle_m: midpoint of each pair, shape (n, 3).
    direction: unit vector from its first to its second point, shape (n, 3).
    width_m: distance of its points, shape (n,).
    """

    middle_m: Vector
    direction: Vector
    width_m: Vector

    def __len__(self) -> int:
        return len(self.width_m)


def antipodal_pairs(
    mesh: trimesh.Trimesh, rng: np.random.Generator, *, samples: int, friction: float, widest_m: float
) -> AntipodalPairs:
    """Return the antipodal pairs among random points of a surface and the points opposite.

    A pair holds by friction alone if the line between its points lies in both friction cones (V.-D. Nguyen,
    "Constructing force-closure grasps", International Journal of Robotics Research 7(3), 1988).

    Parameters
    ----------
    mesh: closed surface, its faces turned outward.
    rng: draws the points, evenly over the area, and a line within the friction cone at each.
    samples: points to draw; there are at most as many pairs.
    friction: coefficient of both contacts.
    widest_m: pairs further apart are left out.
    """
    points, faces = _on_surface(mesh, rng, samples)
    inward = -np.asarray(mesh.face_normals)[faces]
    lines = _tilted(inward, np.arctan(friction), rng)
    far, second = _opposite(mesh, points, lines, faces)
    met = second >= 0
    across = far - points
    width = np.linalg.norm(across, axis=1)
    # what leaves through the second point does so within its cone; the first one's holds by construction
    leaves = np.einsum("ij,ij->i", lines, np.asarray(mesh.face_normals)[second])
    good = met & (width > 1e-4) & (width <= widest_m) & (leaves >= np.cos(np.arctan(friction)))
    return AntipodalPairs(
        middle_m=0.5 * (points + far)[good], direction=across[good] / width[good, None], width_m=width[good]
    )


def _on_surface(mesh: trimesh.Trimesh, rng: np.random.Generator, count: int) -> tuple[Vector, npt.NDArray[np.int64]]:
    """Return points, shape (count, 3), even over the area, and their faces, shape (count,)."""
    area = np.asarray(mesh.area_faces)
    faces = rng.choice(len(area), size=count, p=area / area.sum())
    u, v = rng.uniform(size=(2, count))
    flip = u + v > 1.0
    u[flip], v[flip] = 1.0 - u[flip], 1.0 - v[flip]
    corner = np.asarray(mesh.triangles)[faces]
    edges = corner[:, 1:] - corner[:, :1]
    return corner[:, 0] + u[:, None] * edges[:, 0] + v[:, None] * edges[:, 1], faces


def _tilted(axis: Vector, largest_rad: float, rng: np.random.Generator) -> Vector:
    """Return unit vectors evenly spread in the cones of half angle `largest_rad` about unit vectors, shape (n, 3)."""
    cosine = rng.uniform(np.cos(largest_rad), 1.0, size=len(axis))
    turn = rng.uniform(0.0, 2.0 * np.pi, size=len(axis))
    helper = np.where(np.abs(axis[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(axis, first)
    sine = np.sqrt(1.0 - cosine**2)
    sideways = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    return np.asarray(cosine[:, None] * axis + sine[:, None] * sideways)


def _opposite(
    mesh: trimesh.Trimesh, points: Vector, lines: Vector, own: npt.NDArray[np.int64]
) -> tuple[Vector, npt.NDArray[np.int64]]:
    """Return the nearest points where lines through the body leave it, and their faces; -1 where there is none.

    Moeller and Trumbore's test of each line against each triangle ("Fast, minimum storage ray/triangle intersection",
    Journal of Graphics Tools 2(1), 1997), a line at a time.
    """
    corners = np.asarray(mesh.triangles)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    far, faces = points.copy(), np.full(len(points), -1, dtype=np.int64)
    for i, (point, line) in enumerate(zip(points, lines, strict=True)):
        cross = np.cross(line, second)
        volume = np.einsum("ij,ij->i", first, cross)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = point - corners[:, 0]
            u = np.einsum("ij,ij->i", away, cross) / volume
            turned = np.cross(away, first)
            v = turned @ line / volume
            reach = np.einsum("ij,ij->i", second, turned) / volume
        hit = (volume != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (reach > 1e-6)
        hit[own[i]] = False
        if hit.any():
            nearest = int(np.argmin(np.where(hit, reach, np.inf)))
            far[i], faces[i] = point + reach[nearest] * line, nearest
    return far, faces
