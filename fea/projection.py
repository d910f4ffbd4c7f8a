"""Closest points on faces of three or six nodes, on their edges where a point is past them."""

from dataclasses import dataclass, fields

import numpy as np

from fea.arrays import F64, I64, Bool
from fea.triangle import EDGE_NODES, bends, shapes, slopes

_ITERATIONS = 12
_EXACT = 1e-12
"""Newton's method for the closest point ends when no coordinate changes by more; it converges quadratically."""
_LARGEST_STEP = 0.5
_ON_EDGE = 1e-15
_STEEP = 0.9
"""Choice: a point as straight as this behind an edge is inside the solid."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Projection:
    """Closest points x of faces to given points y.

    Attributes
    ----------
    eta : array [n, 2]
        Where on the face.
    gap_m : array [n]
        Distance, positive outside the solid.
    normal : array [n, 3]
        Unit vector along which the gap grows: the face's normal, or away from the edge.
    on_edge : array [n]
        Whether the closest point is on an edge or a corner.
    shape : array [n, k]
        Shape functions there.
    tangents, slope : arrays [n, 2, 3] and [n, k, 2]
        Derivatives of position and shape functions by eta.
    """

    eta: F64
    gap_m: F64
    normal: F64
    on_edge: Bool
    shape: F64
    tangents: F64
    slope: F64

    def only(self, rows: I64) -> "Projection":
        """Return the projections of some points."""
        return Projection(**{item.name: getattr(self, item.name)[rows] for item in fields(self)})


def nearest(points_m: F64, faces_m: F64, start: I64, eta: F64, around: I64) -> tuple[I64, Projection]:
    """Return the face of a surface that each point [n, 3] is nearest to, and its closest point there.

    Parameters
    ----------
    faces_m : array [m, k, 3]
        The faces of the surface, nodes in the order of a normal into the solid (:func:`fea.lattice.free_faces`).
    start, eta : arrays [n] and [n, 2]
        Face and place where each search begins. Only points that leave this face look at those ``around`` it.
    around : array [m, p]
        Neighbours of each face, -1 where there are fewer than p.
    """
    eta = _foot(points_m, faces_m[start], eta)
    left = np.flatnonzero(_past(eta))
    face = start.copy()
    if left.size:
        ring = np.concatenate([start[left, None], around[start[left]]], axis=1)
        row, column = np.nonzero(ring >= 0)
        point, corners = points_m[left[row]], faces_m[ring[row, column]]
        foot = _foot(point, corners, np.full((len(row), 2), 1.0 / 3.0))
        past = _past(foot)
        foot[past] = _edge_foot(point[past], corners[past])
        distance, place = np.full(ring.shape, np.inf), np.zeros((*ring.shape, 2))
        distance[row, column] = np.linalg.norm(point - _at(corners, foot), axis=1)
        place[row, column] = foot
        best = distance.argmin(axis=1)
        face[left] = np.take_along_axis(ring, best[:, None], axis=1)[:, 0]
        eta[left] = place[np.arange(len(left)), best]
    return face, _described(points_m, faces_m[face], eta)


def _described(points_m: F64, faces_m: F64, eta: F64) -> Projection:
    """Return the projections with these closest points."""
    k = faces_m.shape[1]
    shape, slope = shapes(eta, k), np.array(slopes(eta, k))
    tangents = np.swapaxes(slope, 1, 2) @ faces_m
    normal = -np.cross(tangents[:, 0], tangents[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    away = points_m - (shape[:, None] @ faces_m)[:, 0]
    gap = np.einsum("ni,ni->n", away, normal)
    on_edge = np.minimum(eta.min(axis=1), 1.0 - eta.sum(axis=1)) <= _ON_EDGE
    distance = np.linalg.norm(away, axis=1)
    # off an edge a point is outside the solid, but for the wedge behind two faces that meet in a slight valley
    off = on_edge & (gap > -_STEEP * distance) & (distance > 0.0)
    gap[off] = distance[off]
    normal[off] = away[off] / distance[off, None]
    return Projection(eta=eta, gap_m=gap, normal=normal, on_edge=on_edge, shape=shape, tangents=tangents, slope=slope)


def _foot(points_m: F64, faces_m: F64, eta: F64) -> F64:
    """Return where the faces [n, k, 3], continued past their edges, are closest to points [n, 3]; starts at eta."""
    k = faces_m.shape[1]
    second = np.tensordot(faces_m, bends(k), axes=([1], [0]))  # [n, 3, 2, 2]
    eta = eta.copy()
    for _ in range(_ITERATIONS):
        tangents = np.swapaxes(slopes(eta, k), 1, 2) @ faces_m
        away = points_m - _at(faces_m, eta)
        metric = tangents @ np.swapaxes(tangents, 1, 2)
        curved = metric - np.einsum("ni,niab->nab", away, second)
        # far points see a surface that curves towards them as a saddle: then the surface's plane takes its place
        good = (_determinant(curved) > 0.1 * _determinant(metric)) & (curved[:, 0, 0] + curved[:, 1, 1] > 0.0)
        matrix = np.where(good[:, None, None], curved, metric)
        step = _solved(matrix, (tangents @ away[:, :, None])[..., 0])
        size = np.abs(step).max(axis=1, initial=0.0)
        eta += step * np.minimum(1.0, _LARGEST_STEP / np.maximum(size, 1e-300))[:, None]
        if size.max(initial=0.0) < _EXACT:
            break
    return eta


def _edge_foot(points_m: F64, faces_m: F64) -> F64:
    """Return the places [n, 2] on the edges of faces that are closest to points."""
    (i, j), corner = np.transpose(EDGE_NODES), np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    start, end = faces_m[:, i], faces_m[:, j]
    middle = faces_m[:, 3:] if faces_m.shape[1] == 6 else 0.5 * (start + end)
    slope, bend = 4.0 * middle - 3.0 * start - end, 2.0 * (start + end) - 4.0 * middle  # x = start + slope t + bend t^2
    t = np.full((len(points_m), 3), 0.5)
    for _ in range(_ITERATIONS):
        along = t[:, :, None]
        tangent = slope + 2.0 * bend * along
        away = points_m[:, None] - start - along * (slope + bend * along)
        size = (tangent**2).sum(axis=2)
        curved = size - 2.0 * (away * bend).sum(axis=2)
        step = (tangent * away).sum(axis=2) / np.where(curved > 0.1 * size, curved, size)
        t, before = np.clip(t + step, 0.0, 1.0), t
        if np.abs(t - before).max(initial=0.0) < _EXACT:
            break
    along = t[:, :, None]
    distance = np.linalg.norm(points_m[:, None] - start - along * (slope + bend * along), axis=2)
    best = distance.argmin(axis=1)
    share = np.take_along_axis(t, best[:, None], axis=1)
    return np.asarray(corner[i[best]] + share * (corner[j] - corner[i])[best])


def _at(faces_m: F64, eta: F64) -> F64:
    """Return the points [n, 3] of faces at eta [n, 2]."""
    return np.asarray((shapes(eta, faces_m.shape[1])[:, None] @ faces_m)[:, 0])


def _past(eta: F64) -> Bool:
    return np.asarray((eta.min(axis=1) < 0.0) | (eta.sum(axis=1) > 1.0))


def _determinant(matrix: F64) -> F64:
    return np.asarray(matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0])


def _solved(matrix: F64, right: F64) -> F64:
    """Return the solutions [n, 2] of systems of two unknowns."""
    (a, b), (c, d) = np.moveaxis(matrix, 0, -1)
    x, y = right.T
    return np.asarray(np.stack([d * x - b * y, a * y - c * x], axis=1) / (a * d - b * c)[:, None])


def neighbours(faces: I64) -> I64:
    """Return the faces that share a node with each face [m, p], -1 where there are fewer."""
    corner = faces[:, :3]
    order = np.argsort(corner.ravel(), kind="stable")
    owner, node = order // 3, corner.ravel()[order]
    starts = np.searchsorted(node, np.arange(corner.max() + 2))
    rings = []
    for k, row in enumerate(corner):
        ring = np.unique(np.concatenate([owner[starts[n] : starts[n + 1]] for n in row]))
        rings.append(ring[ring != k])
    table = np.full((len(faces), max(len(ring) for ring in rings)), -1, dtype=np.int64)
    for k, ring in enumerate(rings):
        table[k, : len(ring)] = ring
    return table
