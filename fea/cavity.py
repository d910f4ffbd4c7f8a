"""Pressurised cavity: enclosed volume and its derivatives from curved six-node or flat three-node faces."""

import numpy as np

from fea.arrays import F64, I64

# seven-point rule of degree 5 on the triangle (Radon; Strang & Fix, An Analysis of the Finite Element Method)
_A, _B = (6.0 - np.sqrt(15.0)) / 21.0, (6.0 + np.sqrt(15.0)) / 21.0
_POINTS = np.array(
    [[1 / 3, 1 / 3], [_A, _A], [1 - 2 * _A, _A], [_A, 1 - 2 * _A], [_B, _B], [1 - 2 * _B, _B], [_B, 1 - 2 * _B]]
)
_WEIGHTS = 0.5 * np.array([0.225] + [(155.0 - np.sqrt(15.0)) / 1200.0] * 3 + [(155.0 + np.sqrt(15.0)) / 1200.0] * 3)
_HALF = np.array([0.5, 0.5, 0.0])
_EPSILON = np.zeros((3, 3, 3))
_EPSILON[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
_EPSILON[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0


class Cavity:
    """Closed cavity bounded by faces, the symmetry plane y = 0 and planes z = const.

    V is the surface integral of (x n_x + y n_y) / 2, to which planes z = const and the plane y = 0 add nothing, so only
    curved walls and moving caps are needed. The gradient is the follower load of a unit pressure, and the Hessian is
    symmetric since pressure is conservative here.

    Parameters
    ----------
    faces : array [n_faces, 6] or [n_faces, 3]
        Vertices and mid-edge nodes ((0,1), (1,2), (0,2)) or vertices alone (P1), normals out of the cavity.
    n_nodes : int
        Number of nodes of the mesh.
    """

    def __init__(self, faces: I64, n_nodes: int) -> None:
        if len(faces) == 0:
            raise ValueError("faces: a cavity needs at least one face")
        self.faces = faces
        self.n_nodes = n_nodes
        x, y = _POINTS.T
        z = 1.0 - x - y
        one = np.ones_like(x)
        if faces.shape[1] == 3:
            self._shape = np.stack([z, x, y], 1)
            self._dx = np.stack([-one, one, 0 * one], 1)
            self._dy = np.stack([-one, 0 * one, one], 1)
        else:
            corners = [z * (2 * z - 1), x * (2 * x - 1), y * (2 * y - 1)]
            self._shape = np.stack([*corners, 4 * z * x, 4 * x * y, 4 * z * y], 1)
            self._dx = np.stack([1 - 4 * z, 4 * x - 1, 0 * one, 4 * (z - x), 4 * y, -4 * y], 1)
            self._dy = np.stack([1 - 4 * z, 0 * one, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)], 1)
        # a face's volume is cubic in its nodes' coordinates, hence its Hessian linear: row k belongs to coordinate k
        size = 3 * faces.shape[1]
        self._map = self._hessian(np.eye(size).reshape(size, -1, 3)).reshape(size, size * size)

    def volume_m3(self, points_m: F64) -> float:
        """Return the enclosed volume of the half model at deformed nodes [n_nodes, 3]."""
        nodes = points_m[self.faces]
        x, a, b = (np.einsum("qm,fmi->fqi", N, nodes) for N in (self._shape, self._dx, self._dy))
        return float(np.einsum("q,fqi,fqi->", _WEIGHTS, x * _HALF, np.cross(a, b)))

    def derivatives(self, points_m: F64) -> tuple[F64, F64]:
        """Return dV/dx [n_nodes, 3] and the faces' Hessians [n_faces, 18, 18] (9 for three-node faces).

        The integrand is Dx . (a x b) with D = diag(1/2, 1/2, 0) and the tangents a, b of the face.
        """
        size = 3 * self.faces.shape[1]
        nodes = points_m[self.faces]
        nodes[..., 2] -= nodes[:, :1, 2]  # a shift along z changes nothing (D), and small numbers lose fewer digits
        nodes = nodes.reshape(-1, size)
        hessian = (nodes @ self._map).reshape(-1, size, size)
        local = 0.5 * (hessian @ nodes[:, :, None])  # Euler's theorem for a homogeneous cubic
        places = (3 * self.faces[:, :, None] + np.arange(3)).ravel()
        gradient = np.bincount(places, weights=local.ravel(), minlength=3 * self.n_nodes)
        return np.asarray(gradient, dtype=np.float64).reshape(-1, 3), hessian

    def gradient(self, points_m: F64) -> F64:
        """Return dV/dx [n_nodes, 3]: the nodal forces of a unit pressure."""
        return self.derivatives(points_m)[0]

    def _hessian(self, nodes: F64) -> F64:
        """Return Hessians [n, 18, 18] of faces with nodes [n, 6, 3], from those of the integrand's three factors."""
        x, a, b = (np.einsum("qm,fmi->fqi", N, nodes) for N in (self._shape, self._dx, self._dy))
        hessian = self._pair(self._dx, self._dy, x * _HALF, np.ones(3))
        hessian += self._pair(self._shape, self._dx, b, _HALF)
        hessian -= self._pair(self._shape, self._dy, a, _HALF)
        return hessian

    @staticmethod
    def _pair(first: F64, second: F64, vector: F64, scale: F64) -> F64:
        """Return eps_ijk v_k (D_i first_m second_n - D_j first_n second_m), shape [n_faces, 6, 3, 6, 3]."""
        product = np.einsum("q,qm,qn,fqk->fmnk", _WEIGHTS, first, second, vector, optimize=True)
        one_way = np.einsum("fmnk,ijk,i->fminj", product, _EPSILON, scale, optimize=True)
        return np.asarray(one_way + one_way.transpose(0, 3, 4, 1, 2))
