"""Contact of facets that never touch: Incremental Potential Contact (Li et al. 2020, ACM Trans. Graph. 39(4)).

A barrier on the distance of the surfaces' linear facets keeps every state free of penetration: its energy grows
without bound as a gap closes and is zero beyond the activation distance. Six-node faces are split into four facets
through their mid-edge nodes, so that contact acts on the nodes of the mesh itself; a three-node face is one. ipctk is
an optional dependency. Friction is in :mod:`fea.tangential` and :mod:`fea.friction`. The finger is analysed with
:mod:`fea.segment_contact`; this is the second opinion, and the choice where nothing may overlap.
"""

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64
from fea.contact_interface import ContactState
from fea.lattice import SolidMesh
from fea.tangential import TangentialPairs, from_ipctk

_MM = 1e3  # ipctk works in mm, MPa and N: its tolerances are absolute
_FACETS = {6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)), 3: ((0, 1, 2),)}  # by the nodes of a face
_JITTER_MM = 1e-4
"""Choice: noise on the surfaces' positions; exactly parallel edges of aligned lattices are degenerate pairs."""


@dataclass(frozen=True, kw_only=True)
class ContactOptions:
    """Settings of the barrier.

    Attributes
    ----------
    activation_distance_m : float
        Gap below which the barrier pushes. Choice: half the clearance, which the rest state must exceed.
    stiffness_pa : float
        Barrier stiffness. Choice: with 2 kPa the gap closes to 5 % of the activation distance at 80 kPa, with 20 kPa to
        60 %; the tip angle at 59 kPa differs by 0.1 degrees, and steps of 8 kPa converge up to 67 instead of 56 kPa.
    friction : float
        Coulomb's coefficient, 0 to 2.
    friction_slip_m : float
        Slip over which friction builds up from nothing to Coulomb's limit. Choice: a tenth of the activation distance,
        small against the millimetres that the finger's surfaces slide; it is a length because nothing here has a rate.
    count_once : bool
        Take away the pairs that neighbouring facets count several times (improved max approximator of Li et al. 2023,
        Convergent Incremental Potential Contact). Without it matching facets shifted by 0.03 mm push sideways with up
        to 38 % of the normal force, with it 2 % (measured; docs/verification.md). Choice: off, as the analyses so far.
    """

    activation_distance_m: float = 0.1e-3
    stiffness_pa: float = 20e3
    friction: float = 0.0
    friction_slip_m: float = 1e-5
    count_once: bool = False

    def __post_init__(self) -> None:
        for name in ("activation_distance_m", "stiffness_pa", "friction_slip_m"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} = {getattr(self, name)} must be positive and finite")
        if not 0.0 <= self.friction <= 2.0:
            raise ValueError(f"friction = {self.friction} must be from 0 to 2")


class SurfaceContact:
    """Contact between two surfaces of a mesh, none within a surface.

    Parameters
    ----------
    mesh : SolidMesh
    first, second : arrays [n_faces, 6] or [n_faces, 3]
        Faces of the surfaces (:func:`fea.lattice.free_faces`).
    options : ContactOptions

    Raises
    ------
    ModuleNotFoundError
        If ipctk is not installed.
    ValueError
        If the surfaces share a node or start within the activation distance.
    """

    def __init__(self, mesh: SolidMesh, first: I64, second: I64, options: ContactOptions) -> None:
        self._ipc: Any = importlib.import_module("ipctk")
        self.options = options
        ours, theirs = np.unique(first), np.unique(second)
        if np.intersect1d(ours, theirs).size:
            raise ValueError("first, second: surfaces in contact must not share nodes")
        self.nodes: I64 = np.concatenate([ours, theirs])
        self.first_nodes: I64 = ours
        on_first = np.arange(len(self.nodes)) < len(ours)
        local = np.zeros(len(mesh.points_m), dtype=np.int64)
        local[self.nodes] = np.arange(len(self.nodes))
        facets = _FACETS[first.shape[1]]
        faces = np.concatenate([local[f[:, list(k)]] for f in (first, second) for k in facets]).astype(np.int32)
        jitter = np.random.default_rng(0).uniform(-_JITTER_MM, _JITTER_MM, (len(self.nodes), 3))
        self._rest = mesh.points_m[self.nodes] * _MM + jitter
        self._n_nodes = len(mesh.points_m)
        self._first: I64 = local[first]
        self._facet_area_m2 = _facet_areas(mesh.points_m[first])
        rest = np.asfortranarray(self._rest)
        self._mesh = self._ipc.CollisionMesh(rest, self._ipc.edges(np.asfortranarray(faces)), np.asfortranarray(faces))
        self._mesh.can_collide = self._ipc.make_vertex_patches_filter(on_first.astype(np.int32))
        self._distance = options.activation_distance_m * _MM
        self._potential = self._ipc.BarrierPotential(self._distance, options.stiffness_pa * 1e-6, True)
        if self.minimum_gap_m(np.zeros_like(mesh.points_m), within_m=1.01 * options.activation_distance_m) is not None:
            raise ValueError(
                f"activation_distance_m = {options.activation_distance_m} must be below the smallest gap at rest"
            )

    def energy(self, u_m: F64) -> float:
        """Return the barrier's energy [J] at displacements [n_nodes, 3]."""
        x = self._positions(u_m)
        return 1e-3 * float(self._potential(self._collisions(x), self._mesh, x))

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and the Hessian, projected to positive semi-definite pair by pair unless told otherwise."""
        x = self._positions(u_m)
        collisions = self._collisions(x)
        method = self._ipc.PSDProjectionMethod.CLAMP if project else self._ipc.PSDProjectionMethod.NONE
        local = self._potential.hessian(collisions, self._mesh, x, method)
        force = self._nodal(-self._potential.gradient(collisions, self._mesh, x))
        return ContactState(force_n=force, hessian=self._upper(local))

    def force_n(self, u_m: F64) -> F64:
        """Return the forces alone [n_nodes, 3]."""
        x = self._positions(u_m)
        return self._nodal(-self._potential.gradient(self._collisions(x), self._mesh, x))

    def friction_pairs(self, u_m: F64, coefficient: float | None = None) -> TangentialPairs:
        """Return the pairs with the normal forces and tangent planes at displacements u (options' coefficient)."""
        x = self._positions(u_m)
        pairs = self._ipc.TangentialCollisions()
        mu = self.options.friction if coefficient is None else coefficient
        pairs.build(self._mesh, x, self._collisions(x), self._potential, mu)
        edges, faces = np.asarray(self._mesh.edges), np.asarray(self._mesh.faces)
        return from_ipctk(pairs, edges, faces, self.nodes, self.options.friction_slip_m)

    def contact_pressure_pa(self, u_m: F64) -> F64:
        """Return the normal contact pressure on ``first_nodes`` [n_first], over undeformed areas.

        First each face gets its share of its nodes' forces over its area, then each node the mean of its faces: on
        quadratic elements a uniform pressure gives no force at vertices, so single nodes would tell nothing.
        """
        force = np.linalg.norm(self.force_n(u_m)[self.first_nodes], axis=1)
        share, n = self._facet_area_m2, len(force)  # [n_faces, 6 or 3]
        area = np.bincount(self._first.ravel(), share.ravel(), minlength=n)
        face = (force[self._first] * share / area[self._first]).sum(axis=1) / share.sum(axis=1)
        return np.asarray(np.bincount(self._first.ravel(), (share * face[:, None]).ravel(), minlength=n) / area)

    def held(self, _u_m: F64, /) -> "SurfaceContact":
        """Return itself: its forces have an energy."""
        return self

    def following(self, _u_m: F64, /) -> "SurfaceContact":
        """Return itself: it finds its pairs anew in every state."""
        return self

    def step_bound(self, u_m: F64, trial_m: F64) -> float:
        """Return the collision-free fraction of the straight way from u to the trial (additive CCD, Li et al. 2021)."""
        start, end = self._positions(u_m), self._positions(trial_m)
        return float(
            self._ipc.compute_collision_free_stepsize(
                self._mesh, start, end, 0.0, self._ipc.LBVH(), self._ipc.AdditiveCCD()
            )
        )

    def minimum_gap_m(self, u_m: F64, within_m: float) -> float | None:
        """Return the smallest distance of the two surfaces [m], or None if it exceeds ``within_m``."""
        x = self._positions(u_m)
        collisions = self._collisions(x, within_m * _MM)
        if len(collisions) == 0:
            return None
        return float(np.sqrt(collisions.compute_minimum_distance(self._mesh, x))) / _MM

    def _positions(self, u_m: F64) -> F64:
        return np.asfortranarray(self._rest + u_m[self.nodes] * _MM)

    def _collisions(self, x: F64, distance: float | None = None) -> Any:
        collisions = self._ipc.NormalCollisions()
        collisions.use_area_weighting = True
        if not self.options.count_once:
            collisions.build(self._mesh, x, distance or self._distance, 0.0, self._ipc.LBVH())
            return collisions
        collisions.collision_set_type = collisions.IMPROVED_MAX_APPROX
        # several threads lose a pair now and then (1.6.1: 49 of 300 builds of one state differed, forces by 1e-4)
        threads = self._ipc.get_num_threads()
        self._ipc.set_num_threads(1)
        try:
            collisions.build(self._mesh, x, distance or self._distance, 0.0, self._ipc.LBVH())
        finally:
            self._ipc.set_num_threads(threads)
        return collisions

    def _nodal(self, local: F64) -> F64:
        force = np.zeros((self._n_nodes, 3))
        force[self.nodes] = local.reshape(-1, 3)
        return force

    def _upper(self, local: Any) -> sp.csr_array:
        """Return the upper triangle over all nodes [N/m] of a Hessian over the surfaces' nodes [N/mm]."""
        entries = sp.coo_array(local)
        dofs = (3 * self.nodes[:, None] + np.arange(3)).ravel()
        row, column = dofs[entries.coords[0]], dofs[entries.coords[1]]
        upper = row <= column
        size = 3 * self._n_nodes
        return sp.csr_array((entries.data[upper] * _MM, (row[upper], column[upper])), shape=(size, size))


def _facet_areas(points_m: F64) -> F64:
    """Return the area that belongs to each node of faces [n, 6 or 3, 3]: a third of its facets'."""
    area = np.zeros(points_m.shape[:2])
    for facet in _FACETS[points_m.shape[1]]:
        a, b, c = np.moveaxis(points_m[:, list(facet)], 1, 0)
        area[:, list(facet)] += np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None] / 6.0
    return area
