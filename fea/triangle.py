"""Shape functions of faces: triangles of three or six nodes, in the order of :func:`fea.lattice.free_faces`."""

import numpy as np

from fea.arrays import F64

EDGE_NODES = ((0, 1), (1, 2), (0, 2))
"""Ends of the edges that nodes 3, 4 and 5 are in the middle of."""
RULE = (np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6.0, np.full(3, 1.0 / 6.0))
"""Points [3, 2] and weights [3] of the rule of degree 2 on the unit triangle (Strang & Fix 1973, table 4.1)."""


def shapes(xi: F64, n_nodes: int) -> F64:
    """Return the shape functions [n, n_nodes] at points [n, 2] of the unit triangle."""
    corner = np.stack([1.0 - xi[:, 0] - xi[:, 1], xi[:, 0], xi[:, 1]], axis=1)
    if n_nodes == 3:
        return corner
    middle = np.stack([4.0 * corner[:, i] * corner[:, j] for i, j in EDGE_NODES], axis=1)
    return np.concatenate([corner * (2.0 * corner - 1.0), middle], axis=1)


def slopes(xi: F64, n_nodes: int) -> F64:
    """Return their derivatives [n, n_nodes, 2]."""
    of_corner = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    if n_nodes == 3:
        return np.broadcast_to(of_corner, (len(xi), 3, 2))
    corner = shapes(xi, 3)[:, :, None]
    middle = [4.0 * (corner[:, i] * of_corner[j] + corner[:, j] * of_corner[i]) for i, j in EDGE_NODES]
    return np.concatenate([(4.0 * corner - 1.0) * of_corner, np.stack(middle, axis=1)], axis=1)


def bends(n_nodes: int) -> F64:
    """Return their second derivatives [n_nodes, 2, 2], the same everywhere."""
    if n_nodes == 3:
        return np.zeros((3, 2, 2))
    d = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    corner = [4.0 * np.outer(d[i], d[i]) for i in range(3)]
    middle = [4.0 * (np.outer(d[i], d[j]) + np.outer(d[j], d[i])) for i, j in EDGE_NODES]
    return np.array(corner + middle)
