"""Common refinement of two surfaces: integration points of the part of each face that lies in front of another one.

A face of the first surface is cut along the edges of the faces of the second one that it faces, seen along its own
normal, so that what is integrated over a piece is smooth. Without the cuts forces on faces that do not match are not
those of a uniform pressure (Puso & Laursen 2004, Comput. Methods Appl. Mech. Eng. 193, on segments of mortar methods).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fea.arrays import F64, I64, Bool
from fea.triangle import RULE, shapes

_SMALLEST = 1e-12
"""Choice: pieces below this share of a face are dropped; what they lack is below what the tests can see."""
_ON_EDGE = 1e-9
"""Barycentric coordinate down to which a point on an edge is covered."""
_FACING = 0.2
"""Choice: cosine of the angle between normals from which faces look at one another; a surface's own folds do not."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Points:
    """Integration points of the overlap.

    Attributes
    ----------
    first, second : arrays [n]
        Face of each surface that the point belongs to.
    xi : array [n, 2]
        Place in the face of the first surface.
    weight : array [n]
        Share of the unit triangle; those of a face that is covered add up to one half.
    """

    first: I64
    second: I64
    xi: F64
    weight: F64


def overlap(first_m: F64, second_m: F64, reach_m: float) -> Points:
    """Return the points where surfaces face one another.

    Parameters
    ----------
    first_m, second_m : arrays [n, 3, 3] and [m, 3, 3]
        Corners of the faces; the normals of both point into their solids, or of both out of them.
    reach_m : float
        Faces further apart than this are left out.
    """
    i, j = _candidates(first_m, second_m, reach_m)
    seen, height = _seen_from(first_m[i], second_m[j])
    polygon = _clipped(seen)
    area = 0.5 * _cross(polygon[:, 1:-1] - polygon[:, :1], polygon[:, 2:] - polygon[:, :1])  # [k, fans], signed
    piece, fan = np.nonzero(np.abs(area) > _SMALLEST)
    corners = np.stack([polygon[piece, 0], polygon[piece, fan + 1], polygon[piece, fan + 2]], axis=1)
    at, share = RULE
    xi = np.einsum("qc,pcd->pqd", shapes(at, 3), corners).reshape(-1, 2)
    pair = np.repeat(piece, len(share))
    weight = (2.0 * np.abs(area[piece, fan])[:, None] * share).ravel()
    kept = _in_front(xi, pair, i, seen, height)
    return Points(first=i[pair][kept], second=j[pair][kept], xi=xi[kept], weight=weight[kept])


def _in_front(xi: F64, pair: I64, first: I64, seen: F64, height_m: F64) -> Bool:
    """Return which points [n] see the face of their pair, and none that is nearer along the normal."""
    starts = np.searchsorted(first, np.arange(first[-1] + 2)) if len(first) else np.zeros(1, dtype=np.int64)
    count = np.diff(starts)[first[pair]]
    point = np.repeat(np.arange(len(xi)), count)
    other = np.arange(len(point)) - np.repeat(np.cumsum(count) - count - starts[first[pair]], count)
    share = _barycentric(xi[point], seen[other])
    distance = np.abs((share * height_m[other]).sum(axis=1))
    own = other == pair[point]
    nearer = (share.min(axis=1) > -_ON_EDGE) & (distance < np.repeat(distance[own], count) * (1.0 - 1e-6))
    return np.asarray(np.bincount(point[nearer & ~own], minlength=len(xi)) == 0)


def _barycentric(xi: F64, triangle: F64) -> F64:
    """Return the barycentric coordinates [n, 3] of points [n, 2] in triangles [n, 3, 2]."""
    a, b, c = np.moveaxis(triangle, 1, 0)
    share = np.stack([_cross(b - xi, c - xi), _cross(c - xi, a - xi), _cross(a - xi, b - xi)], axis=1)
    return np.asarray(share / _cross(b - a, c - a)[:, None])


def _candidates(first_m: F64, second_m: F64, reach_m: float) -> tuple[I64, I64]:
    """Return the pairs of faces that look at one another and whose boxes are within reach."""
    low = [corners.min(axis=1) for corners in (first_m, second_m)]
    high = [corners.max(axis=1) for corners in (first_m, second_m)]
    middle = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
    radius = [np.linalg.norm(b - a, axis=1).max() / 2.0 for a, b in zip(low, high, strict=True)]
    near = cKDTree(middle[0]).query_ball_tree(cKDTree(middle[1]), radius[0] + radius[1] + reach_m)
    i = np.repeat(np.arange(len(first_m)), [len(found) for found in near])
    j = np.concatenate([np.array(found, dtype=np.int64) for found in near]) if len(i) else np.zeros(0, dtype=np.int64)
    apart = np.maximum(low[1][j] - high[0][i], low[0][i] - high[1][j]).max(axis=1)
    facing = np.einsum("ki,ki->k", _normal(first_m)[i], _normal(second_m)[j]) < -_FACING
    kept = (apart < reach_m) & facing
    return i[kept], j[kept]


def _seen_from(face_m: F64, other_m: F64) -> tuple[F64, F64]:
    """Return the corners of other faces [k, 3, 2] in the coordinates of faces [k, 3, 3], and their heights [k, 3]."""
    edges, away = face_m[:, 1:] - face_m[:, :1], other_m - face_m[:, :1]
    metric = edges @ np.swapaxes(edges, 1, 2)
    along = edges @ np.swapaxes(away, 1, 2)
    seen = np.swapaxes(np.linalg.solve(metric, along), 1, 2)
    return seen, (away @ _normal(face_m)[:, :, None])[..., 0]


def _clipped(polygon: F64) -> F64:
    """Return polygons [k, m, 2] cut by the unit triangle (Sutherland & Hodgman 1974); spare corners repeat the last."""
    for normal, offset in ((np.array([1.0, 0.0]), 0.0), (np.array([0.0, 1.0]), 0.0), (np.array([-1.0, -1.0]), 1.0)):
        start, end = polygon, np.roll(polygon, -1, axis=1)
        here, there = start @ normal + offset, end @ normal + offset
        crosses = (here > 0.0) != (there > 0.0)
        share = np.where(crosses, here / np.where(crosses, here - there, 1.0), 0.0)
        cut = start + share[..., None] * (end - start)
        corners = np.stack([cut, end], axis=2).reshape(len(polygon), 2 * polygon.shape[1], 2)
        kept = np.stack([crosses, there > 0.0], axis=2).reshape(len(polygon), 2 * polygon.shape[1])
        polygon = _packed(corners, kept)
    return polygon


def _packed(corners: F64, kept: np.ndarray) -> F64:
    """Return the kept corners of each polygon first, the last one of them repeated; at least three columns."""
    count = kept.sum(axis=1)
    order = np.argsort(~kept, axis=1, kind="stable")[:, : max(3, int(count.max(initial=0)))]
    column = np.minimum(np.arange(order.shape[1]), np.maximum(count - 1, 0)[:, None])
    order = np.take_along_axis(order, column, axis=1)
    packed = np.take_along_axis(corners, order[..., None], axis=1)
    return np.asarray(np.where((count > 0)[:, None, None], packed, 0.0))


def _normal(corners_m: F64) -> F64:
    """Return unit normals [n, 3] of faces [n, 3, 3]."""
    normal = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _cross(a: F64, b: F64) -> F64:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
