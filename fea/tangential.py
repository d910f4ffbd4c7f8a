"""Pairs of facets that rub: Coulomb's law with a smooth beginning, for all pairs at once.

The normal forces and tangent planes come from the contact of two surfaces; they are constants here. ipctk has the same
forces for its own pairs, which the tests compare; here the tangent of each pair can also be its secant, and the mean
slip of a node is at hand.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64
from fea.blocks import upper_sum

_TINY_M = 1e-300


@dataclass(frozen=True, kw_only=True, eq=False)
class TangentialPairs:
    """Pairs of facets with their normal forces.

    The slip of a pair is s = T' sum_k c_k w_k, w the slips of its nodes, and the magnitude of its friction is
    L f(|s| / length) with f(y) = 2 y - y^2 below y = 1 and 1 above (Li et al. 2020, Incremental Potential Contact,
    section 5), L the coefficient times the normal force.

    Attributes
    ----------
    nodes : array [n, k]
        Nodes of each pair; those that it does not need have weight zero.
    weight : array [n, k]
        c: adding up to one on one surface and to minus one on the other.
    side : array [n, k]
        1 on the one surface, -1 on the other.
    plane : array [n, 3, 2]
        T: two orthogonal unit vectors of the tangent plane.
    limit_n : array [n]
        L; negative on pairs that take away what others count twice.
    length_m : float
        Slip at which friction reaches its limit.
    """

    nodes: I64
    weight: F64
    side: F64
    plane: F64
    limit_n: F64
    length_m: float

    def slip_m(self, slip_m: F64) -> F64:
        """Return the slip of each pair in its plane [n, 2] from that of the nodes [n_nodes, 3]."""
        return np.asarray(np.einsum("pk,pki,pia->pa", self.weight, slip_m[self.nodes], self.plane))

    def force_n(self, slip_m: F64) -> F64:
        """Return the forces on the nodes [n_nodes, 3] at their slips."""
        s = self.slip_m(slip_m)
        secant = _secant(np.linalg.norm(s, axis=1) / self.length_m) / self.length_m
        return -self._spread(np.einsum("p,pia,pa->pi", self.limit_n * secant, self.plane, s), len(slip_m))

    def energy_j(self, slip_m: F64) -> float:
        """Return the potential of the forces, zero without slip."""
        y = np.linalg.norm(self.slip_m(slip_m), axis=1) / self.length_m
        return float(self.length_m * (self.limit_n * np.where(y < 1.0, y**2 - y**3 / 3.0, y - 1.0 / 3.0)).sum())

    def hessian(self, slip_m: F64, *, secant: bool = False) -> sp.csr_array:
        """Return the potential's Hessian [3 n_nodes, 3 n_nodes, N/m], upper triangle.

        With ``secant`` a pair's stiffness along its slip is L f / |s| and not the slope, which is nothing where it
        slides: the quadratic that touches the potential and lies above it, where L is positive.
        """
        s = self.slip_m(slip_m)
        size = np.linalg.norm(s, axis=1)
        y, along = size / self.length_m, s / np.maximum(size, _TINY_M)[:, None]
        across = _secant(y)
        drop = np.zeros_like(y) if secant else across - np.maximum(2.0 - 2.0 * y, 0.0)
        planar = across[:, None, None] * np.eye(2) - drop[:, None, None] * along[:, :, None] * along[:, None, :]
        planar *= (self.limit_n / self.length_m)[:, None, None]
        lever = self.weight[:, :, None, None] * self.plane[:, None]
        lever = lever.reshape(len(s), 3 * self.nodes.shape[1], 2)
        return upper_sum(self.nodes, (lever @ planar) @ np.swapaxes(lever, 1, 2), len(slip_m))

    def mean_slip_m(self, slip_m: F64) -> F64:
        """Return each node's slip [n_nodes, 3], the average over its pairs; zero where nothing touches.

        Least squares over the node's pairs, weighted by their limit and the node's share in them: M s = g with
        M = sum of |c| L T T' and g = sum of c L T s. The two sides of a pair slip in opposite directions.
        """
        share = np.abs(self.weight) * self.limit_n[:, None]
        planes = np.einsum("pia,pja->pij", self.plane, self.plane)
        slips = np.einsum("pia,pa->pi", self.plane, self.slip_m(slip_m))
        matrix, moment = np.zeros((len(slip_m), 3, 3)), np.zeros_like(slip_m)
        np.add.at(matrix, self.nodes, share[:, :, None, None] * planes[:, None])
        np.add.at(moment, self.nodes, (self.side * share)[:, :, None] * slips[:, None])
        weight = np.trace(matrix, axis1=1, axis2=2)
        touching = weight > 1e-9 * max(float(weight.max()), _TINY_M)
        slip = np.zeros_like(slip_m)
        # the normal direction has no stiffness, or little where planes differ: it takes no part
        inverse = np.linalg.pinv(matrix[touching], rcond=0.1, hermitian=True)
        slip[touching] = (inverse @ moment[touching, :, None])[..., 0]
        return slip

    def _spread(self, force_n: F64, n_nodes: int) -> F64:
        """Return the sums on the nodes of forces [n, 3] on the first side of the pairs."""
        total = np.zeros((n_nodes, 3))
        np.add.at(total, self.nodes, self.weight[:, :, None] * force_n[:, None])
        return total


def from_ipctk(found: Any, edges: I64, faces: I64, nodes: I64, length_m: float) -> TangentialPairs:
    """Return an ``ipctk.TangentialCollisions`` as pairs.

    ``edges`` and ``faces`` are those of its collision mesh, ``nodes`` the numbers of its vertices in the whole mesh.
    """
    ids, weights, planes, limits = [], [], [], []

    def add(pair: Any, vertices: list[int], weight: list[float]) -> None:
        spare = 4 - len(vertices)
        ids.append(vertices + spare * vertices[:1])
        weights.append(weight + spare * [0.0])
        planes.append(pair.tangent_basis.copy())
        limits.append(pair.mu_s * pair.weight * pair.normal_force_magnitude)

    for pair in found.vv_collisions:
        add(pair, [pair.vertex0_id, pair.vertex1_id], [1.0, -1.0])
    for pair in found.ev_collisions:
        (a,) = pair.closest_point
        add(pair, [pair.vertex_id, *edges[pair.edge_id]], [1.0, a - 1.0, -a])
    for pair in found.ee_collisions:
        a, b = pair.closest_point
        add(pair, [*edges[pair.edge0_id], *edges[pair.edge1_id]], [1.0 - a, a, b - 1.0, -b])
    for pair in found.fv_collisions:
        a, b = pair.closest_point
        add(pair, [pair.vertex_id, *faces[pair.face_id]], [1.0, a + b - 1.0, -a, -b])
    weight = np.array(weights, dtype=np.float64).reshape(-1, 4)
    return TangentialPairs(
        nodes=nodes[np.array(ids, dtype=np.int64).reshape(-1, 4)],
        weight=weight,
        side=np.sign(weight),
        plane=np.array(planes, dtype=np.float64).reshape(-1, 3, 2),
        limit_n=np.array(limits, dtype=np.float64),
        length_m=length_m,
    )


def _secant(y: F64) -> F64:
    """Return f(y) / y."""
    return np.where(y < 1.0, 2.0 - y, 1.0 / np.maximum(y, 1.0))
