"""Hertz: a rigid sphere pressed on an elastic half-space, through the contact of the finger analysis.

    a^3 = 3 F R / (4 E*),   F = 4/3 E* sqrt(R) d^(3/2),   p0 = 3 F / (2 pi a^2),   E* = E / (1 - nu^2)
with contact radius a, depth d, largest pressure p0 (Johnson, Contact Mechanics, ch. 4). A quarter of a block of side
8 a stands for the half-space: far faces get the displacement of a point force F (Boussinesq; Johnson, ch. 3), which
the sphere's field approaches like (a / r)^2. d is how far the surface's centre sinks, so that the barrier's gap, which
is no part of Hertz's problem, does not count; the gap changes by little over the contact because the activation
distance is 2 % of d. Strains are of the order a / R = 1/50, which linear elasticity needs.
"""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.lattice import SolidMesh, free_faces
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, sweep, union
from fea.newton import NewtonOptions, solve_equilibrium
from fea.surface_contact import surface_contact
from fea.verification.common import Row
from fea.verification.contact_blocks import settings
from fea.workspace import workspace

# metres of size, so that the contact's noise of 0.1 um is nothing beside the depth
YOUNG_PA, POISSON, SPHERE_M, RADIUS_M = 1e6, 0.3, 50.0, 1.0
E_STAR_PA = YOUNG_PA / (1.0 - POISSON**2)
DEPTH_M = RADIUS_M**2 / SPHERE_M
FORCE_N = 4.0 / 3.0 * E_STAR_PA * np.sqrt(SPHERE_M) * DEPTH_M**1.5
_FAR, _STEPS = 8.0, 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Indentation:
    """Depth and force at the last step; nodal force, contact pressure and distance from the axis [n] of the surface."""

    depth_m: float
    force_n: float
    nodal_force_n: F64
    distance_m: F64
    pressure_pa: F64
    dofs: int

    @property
    def radius_m(self) -> float:
        """Contact radius of the Hertz distribution with the same second moment: mean r^2 = 2 a^2 / 5."""
        return float(np.sqrt(2.5 * (self.nodal_force_n * self.distance_m**2).sum() / self.nodal_force_n.sum()))


def boussinesq(x_m: F64, force_n: float) -> F64:
    """Displacement [n, 3] of the half-space z <= 0 under a point force along -z at the origin."""
    x, y, depth = x_m[:, 0], x_m[:, 1], -x_m[:, 2]
    r = np.sqrt(x**2 + y**2 + depth**2)
    shear = YOUNG_PA / (2.0 * (1.0 + POISSON))
    common = force_n / (4.0 * np.pi * shear)
    radial = depth / r**3 - (1.0 - 2.0 * POISSON) / (r * (r + depth))
    sinking = depth**2 / r**3 + 2.0 * (1.0 - POISSON) / r
    return np.asarray(common * np.stack([x * radial, y * radial, -sinking], axis=1))


def indent(*, kind: str = "segments", cells: int = 4) -> Indentation:
    """Lower the sphere until Hertz's depth, with ``cells`` elements over the contact radius."""
    activation = 0.02 * DEPTH_M
    block, cap = _half_space(cells), _sphere(cells, activation)
    mesh = union(block, cap)
    x, z = mesh.points_m, mesh.points_m[:, 2]
    on_sphere = z > 0.5 * activation
    far = ~on_sphere & (np.abs(x) > (1.0 - 1e-9) * _FAR * RADIUS_M).any(axis=1)
    fixed = np.abs(x) < 1e-9
    fixed[:, 2] = False
    fixed[far | on_sphere] = True
    law = StVenantKirchhoff(young_modulus_pa=YOUNG_PA, poisson_ratio=POISSON)
    model = SolidModel(mesh=mesh, laws={0: law, 1: law}, fixed=fixed)
    top = free_faces(mesh, lambda c: (np.abs(c[..., 2]) < 1e-9) & (np.hypot(c[..., 0], c[..., 1]) < 2.2 * RADIUS_M))
    ball = free_faces(mesh, lambda c: np.abs(c[..., 2] - _height(c[..., 0], c[..., 1], activation)) < 1e-6)
    options = settings(kind, distance_m=activation, stiffness_pa=2e5, reach_m=3.0 * DEPTH_M)
    contact = surface_contact(mesh, top, ball, options)
    newton = NewtonOptions(relative_tolerance=1e-6, step_cap_m=1.0, max_iterations=60)
    u, work = np.zeros_like(x), workspace(model)
    centre = int(np.argmin(np.abs(x).sum(axis=1)))
    for share in np.arange(1, _STEPS + 1) / _STEPS:
        u[on_sphere, 2] = -share * DEPTH_M - 0.6 * activation
        u[far] = boussinesq(x[far], share**1.5 * FORCE_N)
        # bring the surface out of the sphere's way: a start that touches nothing
        near = ~on_sphere & ~far
        u[near, 2] = np.minimum(u[near, 2], -(share * DEPTH_M + 0.2 * activation) * np.exp(z[near] / RADIUS_M))
        outcome = solve_equilibrium(work, u, Load(), newton, contact=contact)
        if not outcome.converged:
            raise RuntimeError(f"Hertz: no equilibrium, {outcome.status.value}")
        u, contact = outcome.u_m, contact.following(outcome.u_m)
    work.close()
    nodes = contact.first_nodes
    force = -contact.force_n(u)[nodes, 2]
    return Indentation(
        depth_m=-float(u[centre, 2]),
        force_n=4.0 * float(force.sum()),
        nodal_force_n=force,
        distance_m=np.linalg.norm(x[nodes, :2], axis=1),
        pressure_pa=contact.contact_pressure_pa(u),
        dofs=len(model.free),
    )


def hertz(*, contact: str = "segments", cells: int = 4) -> list[Row]:
    """Return force, contact radius and pressure at the centre of a rigid sphere on a half-space."""
    found = indent(kind=contact, cells=cells)
    radius = (3.0 * found.force_n * SPHERE_M / (4.0 * E_STAR_PA)) ** (1.0 / 3.0)
    centre = float(found.pressure_pa[np.argmin(found.distance_m)])
    values = (
        ("force [N] at the depth", found.force_n, 4.0 / 3.0 * E_STAR_PA * np.sqrt(SPHERE_M) * found.depth_m**1.5),
        ("contact radius [m] at the force", found.radius_m, radius),
        ("pressure [Pa] at the centre", centre, 1.5 * found.force_n / (np.pi * radius**2)),
    )
    return [
        Row(
            problem=f"Hertz, sphere on half-space, {contact}",
            formulation="P2/P0",
            dofs=found.dofs,
            quantity=quantity,
            figure=figure,
            exact=float(exact),
        )
        for quantity, figure, exact in values
    ]


def _graded(cells: int, fine: float, growth: float) -> F64:
    """Edges from 0: equal cells up to ``fine`` radii, then growing by a factor to the far faces."""
    edges = list(np.linspace(0.0, fine, round(fine * cells) + 1))
    equal, step = len(edges), 1.0 / cells
    while edges[-1] < _FAR:
        step *= growth
        edges.append(edges[-1] + step)
    coarse = np.array(edges[equal:]) - fine
    return np.concatenate([edges[:equal], fine + coarse * (_FAR - fine) / coarse[-1]]) * RADIUS_M


def _half_space(cells: int) -> SolidMesh:
    edges = _graded(cells, 1.25, 2.0)
    return sweep(rectangle(edges, edges), -_graded(cells, 0.5, 1.7)[::-1])


def _height(x: F64, y: F64, activation: float) -> F64:
    return np.asarray(1.01 * activation + SPHERE_M - np.sqrt(SPHERE_M**2 - x**2 - y**2))


def _sphere(cells: int, activation: float) -> SolidMesh:
    """Make the sphere's lowest part as one rigid layer; its grid does not match the block's."""
    edges = np.linspace(0.0, 1.5 * RADIUS_M, round(1.5 * 1.4 * cells) + 1)

    def position(r: F64) -> F64:
        x, y, w = r.T
        return np.stack([x, y, _height(x, y, activation) + 0.3 * RADIUS_M * w], axis=1)

    return sweep(rectangle(edges, edges), np.array([0.0, 1.0]), position)
