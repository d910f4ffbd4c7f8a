"""Element quality: how far a tetrahedron is from the regular one, and how evenly it is curved."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from skfem import Basis, ElementTetP2

from fea.arrays import F64
from fea.lattice import Lattice, SolidMesh


@dataclass(frozen=True, kw_only=True)
class Quality:
    """Minimum and mean over the elements; both measures are 1 for a straight regular tetrahedron.

    Attributes
    ----------
    mean_ratio_min, mean_ratio_mean : float
        12 (3 V)^(2/3) / sum of the six squared edges, of the straight tetrahedron through the vertices
        (Liu & Joe, On the shape of tetrahedra from bisection, 1994).
    scaled_jacobian_min, scaled_jacobian_mean : float
        Smallest over largest Jacobian determinant among vertices and mid-edge nodes of the curved element.
    """

    mean_ratio_min: float
    mean_ratio_mean: float
    scaled_jacobian_min: float
    scaled_jacobian_mean: float


def mesh_quality(mesh: SolidMesh) -> Quality:
    """Return the quality of a mesh's elements."""
    ratio, jacobian = mean_ratio(mesh.points_m[mesh.elements[:, :4]]), _scaled_jacobian(mesh)
    return Quality(
        mean_ratio_min=float(ratio.min()),
        mean_ratio_mean=float(ratio.mean()),
        scaled_jacobian_min=float(jacobian.min()),
        scaled_jacobian_mean=float(jacobian.mean()),
    )


def mean_ratio(vertices_m: F64) -> F64:
    """Return the mean ratio [n] of tetrahedra [n, 4, 3]."""
    edges = vertices_m[:, 1:] - vertices_m[:, :1]
    volume = np.abs(np.linalg.det(edges)) / 6.0
    squares = sum(((vertices_m[:, b] - vertices_m[:, a]) ** 2).sum(axis=-1) for a, b in combinations(range(4), 2))
    return np.asarray(12.0 * (3.0 * volume) ** (2.0 / 3.0) / squares)


def element_size_m(lattice: Lattice, material: int) -> float:
    """Return the mean over the cells of one material of each cell's longest edge."""
    radius, angle, height = lattice.r_m, np.diff(lattice.theta_rad), np.diff(lattice.z_m)
    along_r = np.diff(radius)[:, None, None]
    along_theta = 0.5 * (radius[1:] + radius[:-1])[:, None, None] * angle[:, None]
    longest = np.maximum(np.maximum(along_r, along_theta), height)
    return float(longest[lattice.material == material].mean())


def _scaled_jacobian(mesh: SolidMesh) -> F64:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    middles = np.array([(corners[a] + corners[b]) / 2.0 for a, b in combinations(range(4), 2)])
    points = np.vstack([corners, middles]).T
    basis = Basis(mesh.skfem_mesh, ElementTetP2(), quadrature=(points, np.full(10, 0.1)))
    determinant = np.linalg.det(np.asarray(basis.mapping.DF(basis.X)).transpose(2, 3, 0, 1))
    determinant = determinant * np.sign(determinant.mean(axis=1, keepdims=True))
    return np.asarray(determinant.min(axis=1) / determinant.max(axis=1))
