"""Solids put together from blocks, closed without any boolean operation."""

from collections.abc import Sequence

import numpy as np

from softhand_sim.objects.geometry import IntArray, ShapeGeometry, hull, surface

Block = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lower and upper corner (m)."""

# the two triangles of a cell's side, corners numbered 4 i + 2 j + k, normals outward: -x, +x, -y, +y, -z, +z
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_OUTWARD = ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))


def blocks(parts: Sequence[Block]) -> ShapeGeometry:
    """Return the solid that blocks with sides along the axes make together; each is a convex part.

    The blocks may touch but not overlap. The surface is made of the sides of a grid through all of their faces, so it
    is closed without any boolean operation.

    Raises
    ------
    ValueError
        If blocks overlap, or touch along an edge only.
    """
    low, high = (np.array([part[end] for part in parts], dtype=np.float64) for end in (0, 1))
    axes = [np.unique(np.concatenate([low[:, i], high[:, i]])) for i in range(3)]
    # one cell more on each side, which stays empty
    filled = np.zeros([len(axis) + 1 for axis in axes], dtype=bool)
    for a, b in zip(low, high, strict=True):
        first, last = ([int(np.searchsorted(axes[i], end[i])) + 1 for i in range(3)] for end in (a, b))
        cell = tuple(slice(i, j) for i, j in zip(first, last, strict=True))
        if filled[cell].any():
            raise ValueError("blocks overlap")
        filled[cell] = True
    faces: list[IntArray] = []
    shape = [len(axis) for axis in axes]
    for index in np.argwhere(filled):
        corner = [
            np.ravel_multi_index(tuple(index - 1 + np.array([n >> 2 & 1, n >> 1 & 1, n & 1])), shape) for n in range(8)
        ]
        for side, outward in zip(_SIDES, _OUTWARD, strict=True):
            if not filled[tuple(index + np.array(outward))]:
                a, b, c, d = (corner[n] for n in side)
                faces.append(np.array([(a, b, c), (a, c, d)], dtype=np.int64))
    mesh = surface(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3), np.vstack(faces))
    mesh.remove_unreferenced_vertices()
    if not mesh.is_watertight:
        raise ValueError("blocks touch along an edge only")
    corners = [np.array(np.meshgrid(*np.array([a, b]).T)).reshape(3, 8).T for a, b in zip(low, high, strict=True)]
    return ShapeGeometry(mesh=mesh, convex_parts=tuple(hull(c) for c in corners))
