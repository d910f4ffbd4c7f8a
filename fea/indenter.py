"""A rigid sphere that is pressed into a surface: frictionless, with a stiff pressure of the depth at each point."""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64, I64
from fea.blocks import upper_sum
from fea.contact_interface import ContactState
from fea.triangle import RULE, shapes, slopes

STIFFNESS_PA_PER_M = 1e10
"""Choice: 100 kPa press a point 10 um into the sphere, a hundredth of the depths that are asked for."""
_ORDER = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class SphereIndenter:
    """Sphere of ``radius_m`` about ``centre_m`` (3,) that pushes faces [n, 6] of a mesh out of itself.

    The energy is the integral over the undeformed faces of half the stiffness times the square of the depth.

    Attributes
    ----------
    points_m : array [n_nodes, 3]
        Undeformed nodes of the mesh.
    faces : array [n, 6]
        Faces as of :func:`fea.lattice.free_faces`.
    """

    points_m: F64
    faces: I64
    centre_m: F64
    radius_m: float
    stiffness_pa_per_m: float = STIFFNESS_PA_PER_M

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and Hessian at displacements [n_nodes, 3]."""
        rows, shape, depth, normal, weight = self._touching(u_m)
        nodes = self.faces[rows]
        outer = normal[:, :, None] * normal[:, None, :]
        block = self.stiffness_pa_per_m * weight[:, None, None] * outer
        if not project:
            distance = self.radius_m - depth
            bend = self.stiffness_pa_per_m * (weight * depth / distance)[:, None, None]
            block = block - bend * (np.eye(3) - outer)
        full = np.einsum("pa,pij,pb->paibj", shape, block, shape).reshape(len(rows), 3 * shape.shape[1], -1)
        hessian = upper_sum(nodes, full, len(u_m))
        return ContactState(force_n=self._assembled(u_m, nodes, shape, depth, normal, weight), hessian=hessian)

    def force_n(self, u_m: F64) -> F64:
        """Return the forces alone [n_nodes, 3]."""
        rows, shape, depth, normal, weight = self._touching(u_m)
        return self._assembled(u_m, self.faces[rows], shape, depth, normal, weight)

    def energy(self, u_m: F64) -> float:
        """Return the energy [J]."""
        _, _, depth, _, weight = self._touching(u_m)
        return 0.5 * self.stiffness_pa_per_m * float(weight @ depth**2)

    def held(self, _u_m: F64, /) -> "SphereIndenter":
        """Return itself: its forces have an energy."""
        return self

    def following(self, _u_m: F64, /) -> "SphereIndenter":
        """Return itself."""
        return self

    def step_bound(self, u_m: F64, trial_m: F64) -> float:  # noqa: ARG002 - the surface may pass into the sphere
        """Return 1: any step may be tried."""
        return 1.0

    def _assembled(self, u_m: F64, nodes: I64, shape: F64, depth: F64, normal: F64, weight: F64) -> F64:
        force = np.zeros_like(u_m)
        push = (self.stiffness_pa_per_m * weight * depth)[:, None] * normal
        np.add.at(force, nodes, shape[:, :, None] * push[:, None, :])
        return force

    def _touching(self, u_m: F64) -> tuple[I64, F64, F64, F64, F64]:
        """Return face, shape functions, depth, normal out of the sphere and reference area of the points inside it."""
        xi, share = _points()
        shape, slope = shapes(xi, 6), slopes(xi, 6)
        corner = self.points_m[self.faces]
        tangents = np.einsum("pad,fai->fpdi", slope, corner)
        area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1) * share
        away = np.einsum("pa,fai->fpi", shape, corner + u_m[self.faces]) - self.centre_m
        distance = np.linalg.norm(away, axis=-1)
        face, point = np.nonzero(distance < self.radius_m)
        far = distance[face, point]
        return face, shape[point], self.radius_m - far, away[face, point] / far[:, None], area[face, point]


def _points() -> tuple[F64, F64]:
    """Return points and weights on the unit triangle: the rule of degree 2 on ``_ORDER`` squared equal parts."""
    at, share = RULE
    step = 1.0 / _ORDER
    parts = []
    for i in range(_ORDER):
        for j in range(_ORDER - i):
            parts.append(step * (np.array([i, j]) + at))
            if i + j < _ORDER - 1:
                parts.append(step * (np.array([i + 1, j + 1]) - at))
    xi = np.concatenate(parts)
    return xi, np.tile(share, len(parts)) * step**2
