"""Contact by integration over the common refinement of two surfaces: the pressure is that of the gap at each point.

Forces are the consistent ones of the quadratic faces, so a uniform pressure passes between faces that do not match to
rounding (the contact patch test), and a point's gap is the distance to the curved face, not to its chords. Gaps, normal
forces and their tangent follow from one energy, the integral of the law over the undeformed first surface at fixed
points; :meth:`SegmentContact.following` cuts the faces anew, once a load step.

Unlike the barrier (:mod:`fea.contact`) it integrates over one surface only, so a ridge of the other may pass between
the points, surfaces overlap a little, and only what is within reach at the last cut is seen.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fea.arrays import F64, I64
from fea.blocks import upper_sum
from fea.contact_interface import ContactState
from fea.gap_law import GapLaw, Unilateral
from fea.lattice import SolidMesh
from fea.overlap import Points, overlap
from fea.projection import Projection, nearest, neighbours
from fea.tangential import TangentialPairs
from fea.triangle import bends, shapes, slopes


@dataclass(frozen=True, kw_only=True)
class SegmentOptions:
    """Settings of the contact.

    Attributes
    ----------
    law : GapLaw
    reach_m : float
        Gap at a cut beyond which faces are left out.
    friction : float
        Coulomb's coefficient, 0 to 2.
    friction_slip_m : float
        Slip over which friction builds up.
    """

    law: GapLaw
    reach_m: float
    friction: float = 0.0
    friction_slip_m: float = 1e-5

    def __post_init__(self) -> None:
        for name in ("reach_m", "friction_slip_m"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} = {getattr(self, name)} must be positive and finite")
        if not 0.0 <= self.friction <= 2.0:
            raise ValueError(f"friction = {self.friction} must be from 0 to 2")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Closed:
    """Points whose surfaces push or pull: rows among the points, nodes [n, k], and the gaps' derivatives."""

    row: I64
    face: I64
    nodes: I64
    share: F64
    gap_m: F64
    found: Projection


class _Last:
    """What was found at the displacement asked for last: Newton's method asks for forces, energy and friction there."""

    def __init__(self) -> None:
        self._u_m: F64 | None = None
        self._closed: _Closed | None = None

    def at(self, u_m: F64, find: Callable[[F64], _Closed]) -> _Closed:
        if self._closed is None or self._u_m is None or not np.array_equal(u_m, self._u_m):
            self._u_m, self._closed = u_m.copy(), find(u_m)
        return self._closed


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentContact:
    """Contact of two surfaces between two cuts.

    Attributes
    ----------
    points_m : array [n_nodes, 3]
        Undeformed nodes of the mesh.
    first, second : arrays [n, k] and [m, k]
        Faces of three or six nodes (:func:`fea.lattice.free_faces`).
    options : SegmentOptions
    points : Points
        Integration points of the last cut.
    face, eta : arrays [n] and [n, 2]
        Face of the second surface and place in it that they faced then: where searches begin.
    around : array [m, p]
        Neighbours of the faces of the second surface (:func:`fea.projection.neighbours`).
    """

    points_m: F64
    first: I64
    second: I64
    options: SegmentOptions
    points: Points
    face: I64
    eta: F64
    around: I64
    _last: _Last = field(default_factory=_Last)

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and Hessian; positive semi-definite, without the gaps' curvature, where ``project``."""
        closed = self._closed(u_m)
        area, law = self._area_m2[closed.row], self.options.law
        stiffness = area * law.stiffness_pa_per_m(closed.gap_m, closed.face)
        gradient = self._gradient(closed)
        blocks = (stiffness[:, None] * gradient)[:, :, None] * gradient[:, None, :]
        if not project:
            blocks -= self._curvature(closed, u_m, self._pressure_pa(closed) * area)
        return ContactState(force_n=self.force_n(u_m), hessian=upper_sum(closed.nodes, blocks, len(u_m)))

    def force_n(self, u_m: F64) -> F64:
        """Return the forces alone [n_nodes, 3]."""
        closed = self._closed(u_m)
        push = self._pressure_pa(closed) * self._area_m2[closed.row]
        pushes = (push[:, None] * self._gradient(closed)).reshape(-1, 3)
        nodes, size = closed.nodes.ravel(), len(u_m)
        return np.stack([np.bincount(nodes, pushes[:, i], minlength=size) for i in range(3)], axis=1)

    def energy(self, u_m: F64) -> float:
        """Return the energy [J]."""
        closed = self._closed(u_m)
        density = self.options.law.energy_j_per_m2(closed.gap_m, closed.face)
        return float((self._area_m2[closed.row] * density).sum())

    def held(self, _u_m: F64, /) -> "SegmentContact":
        """Return itself: its forces have an energy."""
        return self

    def step_bound(self, u_m: F64, trial_m: F64) -> float:  # noqa: ARG002 - surfaces may overlap
        """Return 1: any step may be tried."""
        return 1.0

    def following(self, u_m: F64) -> "SegmentContact":
        """Return the contact with faces cut anew at displacements u."""
        return _cut(self.points_m, u_m, self.first, self.second, self.options, self.around)

    def friction_pairs(self, u_m: F64, coefficient: float | None = None) -> TangentialPairs:
        """Return the points with their normal forces and tangent planes at displacements u (options' coefficient)."""
        closed = self._closed(u_m)
        mu = self.options.friction if coefficient is None else coefficient
        normal, tangent = closed.found.normal, closed.found.tangents[:, 0]
        tangent = tangent - np.einsum("ni,ni->n", normal, tangent)[:, None] * normal  # off an edge they differ
        along = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
        half = self.first.shape[1]
        return TangentialPairs(
            nodes=closed.nodes,
            weight=closed.share,
            side=np.broadcast_to(np.where(np.arange(closed.nodes.shape[1]) < half, 1.0, -1.0), closed.nodes.shape),
            plane=np.stack([along, np.cross(normal, along)], axis=2),
            limit_n=mu * np.maximum(0.0, self._pressure_pa(closed)) * self._area_m2[closed.row],
            length_m=self.options.friction_slip_m,
        )

    @property
    def first_nodes(self) -> I64:
        """Nodes of the first surface, increasing."""
        return np.unique(self.first)

    def contact_pressure_pa(self, u_m: F64) -> F64:
        """Return the normal pressure on ``first_nodes`` [n_first], over undeformed areas: the mean of their faces'."""
        closed = self._closed(u_m)
        n = len(self.first)
        area = np.bincount(self.points.first, self._area_m2, minlength=n)
        push = self._pressure_pa(closed) * self._area_m2[closed.row]
        force = np.bincount(self.points.first[closed.row], push, minlength=n)
        node, k = self.first.ravel(), self.first.shape[1]
        near = np.bincount(node, np.repeat(area, k), minlength=len(self.points_m))
        mean = np.bincount(node, np.repeat(force, k), minlength=len(self.points_m)) / np.maximum(near, 1e-300)
        return np.asarray(mean[self.first_nodes])

    def minimum_gap_m(self, u_m: F64, within_m: float) -> float | None:
        """Return the smallest gap [m], negative where the surfaces overlap, or None if it exceeds ``within_m``."""
        gap = float(self.gaps_m(u_m).min(initial=np.inf))
        return gap if gap <= within_m else None

    def gaps_m(self, u_m: F64) -> F64:
        """Return the gap of each integration point [n]."""
        return self._found(u_m)[1].gap_m

    @cached_property
    def _first_shape(self) -> F64:
        return shapes(self.points.xi, self.first.shape[1])

    @cached_property
    def _area_m2(self) -> F64:
        """Undeformed area of each point [n]."""
        corners = self.points_m[self.first[self.points.first]]
        tangents = np.einsum("nka,nki->nai", slopes(self.points.xi, self.first.shape[1]), corners)
        return np.asarray(self.points.weight * np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1))

    def _found(self, u_m: F64) -> tuple[I64, Projection]:
        x = self.points_m + u_m
        at = (self._first_shape[:, None] @ x[self.first[self.points.first]])[:, 0]
        return nearest(at, x[self.second], self.face, self.eta, self.around)

    def _closed(self, u_m: F64) -> _Closed:
        return self._last.at(u_m, self._find_closed)

    def _find_closed(self, u_m: F64) -> _Closed:
        face, found = self._found(u_m)
        row = np.flatnonzero(self.options.law.pressure_pa(found.gap_m, face) != 0.0)
        found = found.only(row)
        nodes = np.concatenate([self.first[self.points.first[row]], self.second[face[row]]], axis=1)
        share = np.concatenate([self._first_shape[row], -found.shape], axis=1)
        return _Closed(row=row, face=face[row], nodes=nodes, share=share, gap_m=found.gap_m, found=found)

    def _pressure_pa(self, closed: _Closed) -> F64:
        return self.options.law.pressure_pa(closed.gap_m, closed.face)

    def _gradient(self, closed: _Closed) -> F64:
        """Return the derivatives of the gaps by the nodes [n, 3 k]."""
        lever = closed.share[:, :, None] * closed.found.normal[:, None]
        return np.asarray(lever.reshape(len(lever), 3 * closed.nodes.shape[1]))

    def _curvature(self, closed: _Closed, u_m: F64, weight: F64) -> F64:
        """Return the second derivatives of the gaps by the nodes [n, 3 k, 3 k], times weights [n].

        With J the derivative of the distance vector, t its face's tangents, a their metric, b the face's curvature
        (second derivatives along the normal n) and C = a - g b, T = J' t and D = J,eta' n:
        - T a^-1 b C^-1 T' + D C^-1 T' + T C^-1 D' - g D C^-1 D', from g^2 = min over eta of |y - x(eta)|^2.
        None on an edge: there it would only weaken the tangent, by what a sharp ridge lets slip off.
        """
        found, half = closed.found, self.first.shape[1]
        x = (self.points_m + u_m)[self.second[closed.face]]
        metric = found.tangents @ np.swapaxes(found.tangents, 1, 2)
        bent = np.tensordot(np.einsum("nki,ni->nk", x, found.normal), bends(x.shape[1]), axes=1)
        gap = closed.gap_m[:, None, None]
        inverse = np.linalg.inv(metric - gap * bent)
        slope = np.zeros((len(x), closed.nodes.shape[1], 2))
        slope[:, half:] = -found.slope
        size = 3 * closed.nodes.shape[1]
        T = closed.share[:, :, None, None] * np.swapaxes(found.tangents, 1, 2)[:, None]
        D = slope[:, :, None, :] * found.normal[:, None, :, None]
        both = np.concatenate([T, D], axis=3).reshape(len(x), size, 4)
        middle = np.empty((len(x), 4, 4))
        middle[:, :2, :2] = -np.linalg.solve(metric, bent) @ inverse
        middle[:, :2, 2:] = middle[:, 2:, :2] = inverse
        middle[:, 2:, 2:] = -gap * inverse
        weight = np.where(found.on_edge, 0.0, weight)
        return np.asarray((both @ (weight[:, None, None] * middle)) @ np.swapaxes(both, 1, 2))


def segment_contact(mesh: SolidMesh, first: I64, second: I64, options: SegmentOptions) -> SegmentContact:
    """Return the contact between two surfaces of a mesh, cut in the undeformed state.

    Raises
    ------
    ValueError
        If the surfaces share a node, or a unilateral law pushes at rest.
    """
    if np.intersect1d(first, second).size:
        raise ValueError("first, second: surfaces in contact must not share nodes")
    rest = np.zeros_like(mesh.points_m)
    contact = _cut(mesh.points_m, rest, first, second, options, neighbours(second))
    law, smallest = options.law, float(contact.gaps_m(rest).min(initial=np.inf))
    if isinstance(law, Unilateral) and law.distance_m >= smallest:
        raise ValueError(f"distance_m = {law.distance_m:g} must be below the smallest gap at rest, {smallest:g}")
    return contact


def _cut(points_m: F64, u_m: F64, first: I64, second: I64, options: SegmentOptions, around: I64) -> SegmentContact:
    """Cut the faces at displacements u and find what each point faces."""
    x = points_m + u_m
    points = overlap(x[first[:, :3]], x[second[:, :3]], options.reach_m)
    at = (shapes(points.xi, first.shape[1])[:, None] @ x[first[points.first]])[:, 0]
    middle = np.full((len(at), 2), 1.0 / 3.0)
    face, found = nearest(at, x[second], points.second, middle, around)
    return SegmentContact(
        points_m=points_m,
        first=first,
        second=second,
        options=options,
        points=points,
        face=face,
        eta=found.eta,
        around=around,
    )
