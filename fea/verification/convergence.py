"""Observed order of convergence: the L2 error of the displacement falls as h^3 for quadratic tetrahedra.

Manufactured solution: u = e (sin(pi x) sin(pi y) sin(pi z)) d in the unit cube, zero on its surface. The body force
that makes it exact is b_i = -dP_iJ/dX_J = -A_iJkL(F) d2u_k / dX_L dX_J, with the law's own tangent A. For
near-incompressible P2/P1 and P2/P0 the incompressible thick cylinder takes its place. P2/P0 is of
second order there: its pressure is of order one, which is what the mixed referee is for (Boffi, Brezzi, Fortin, ch. 8).
"""

import numpy as np
from skfem import Basis, ElementTetP2

from fea.arrays import F64
from fea.lattice import SolidMesh, free_faces
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.rubber import neo_hookean
from fea.verification.common import Problem, pressures, symmetry_planes
from fea.verification.inflation import INNER_M, OUTER_M, closed_form_pressure, cylinder_mesh

_DIRECTION, _AMPLITUDE = np.array([1.0, -0.5, 0.7]), 0.05


def manufactured_error(cells: int) -> float:
    """Return the relative L2 error of P2 (St. Venant-Kirchhoff, pointwise energy) with ``cells`` an edge."""
    law = StVenantKirchhoff(young_modulus_pa=1.0, poisson_ratio=0.3)
    grid = np.linspace(0.0, 1.0, cells + 1)
    mesh = sweep(rectangle(grid, grid), grid)
    basis = Basis(mesh.skfem_mesh, ElementTetP2(), intorder=6)
    x = np.moveaxis(np.asarray(basis.global_coordinates()), 0, -1)  # [n_elements, n_points, 3]
    sine, cosine = np.sin(np.pi * x), np.cos(np.pi * x)
    # first and second derivatives of the product of sines
    first = np.pi * np.stack([cosine[..., j] * sine[..., j - 1] * sine[..., j - 2] for j in range(3)], axis=-1)
    second = np.zeros((*x.shape[:-1], 3, 3))
    for j in range(3):
        for k in range(3):
            other = 3 - j - k
            product = cosine[..., j] * cosine[..., k] * sine[..., other % 3] if j != k else -sine.prod(axis=-1)
            second[..., j, k] = np.pi**2 * product
    F = np.eye(3) + _AMPLITUDE * _DIRECTION[:, None] * first[..., None, :]
    A = law.stress_and_tangent(F)[1]
    body = -_AMPLITUDE * np.einsum("eqiJkL,k,eqLJ->eqi", A, _DIRECTION, second)
    force = np.zeros_like(mesh.points_m)
    for a, field in enumerate(basis.basis):
        shape = np.broadcast_to(np.asarray(field[0]), basis.dx.shape)
        np.add.at(force, mesh.elements[:, a], np.einsum("eq,eq,eqi->ei", basis.dx, shape, body))
    surface = np.any((mesh.points_m < 1e-9) | (mesh.points_m > 1.0 - 1e-9), axis=1)
    problem = Problem(mesh=mesh, law=law, fixed=np.repeat(surface[:, None], 3, axis=1))
    u, _, _ = problem.equilibrium("P2/P0", [Load(force_n=force)], tolerance=1e-9)
    return _l2_error(mesh, u, _AMPLITUDE * sine.prod(axis=-1)[..., None] * _DIRECTION)


def cylinder_error(formulation: str, cells: int) -> float:
    """Return the relative L2 error of the displacement of the neo-Hookean cylinder inflated to inner stretch 1.2."""
    mu, stretch = 1e5, 1.2
    # the mixed form bears any bulk modulus: the closed form's incompressibility must not be what is measured
    law = neo_hookean(mu, mu * (1e7 if formulation == "P2/P1" else 1e4))
    mesh = cylinder_mesh(cells)
    fixed = symmetry_planes(mesh)
    fixed[:, 2] = True
    faces = free_faces(mesh, lambda c: np.isclose(c[..., 0], INNER_M))
    p = closed_form_pressure(law, stretch, OUTER_M / INNER_M, 2)
    problem = Problem(mesh=mesh, law=law, fixed=fixed, cavity_faces=faces)
    u, _, _ = problem.equilibrium(formulation, pressures(p, 2), tolerance=1e-6)
    x = np.moveaxis(np.asarray(Basis(mesh.skfem_mesh, ElementTetP2(), intorder=6).global_coordinates()), 0, -1)
    radius = np.hypot(x[..., 0], x[..., 1])
    growth = np.sqrt(radius**2 + INNER_M**2 * (stretch**2 - 1.0)) / radius - 1.0
    return _l2_error(mesh, u, np.stack([growth * x[..., 0], growth * x[..., 1], 0.0 * radius], axis=-1))


def _l2_error(mesh: SolidMesh, u_m: F64, exact: F64) -> float:
    basis = Basis(mesh.skfem_mesh, ElementTetP2(), intorder=6)
    found = sum(
        u_m[mesh.elements[:, a]][:, None, :] * np.broadcast_to(np.asarray(f[0]), basis.dx.shape)[..., None]
        for a, f in enumerate(basis.basis)
    )
    norm = np.einsum("eq,eqi->", basis.dx, exact**2)
    return float(np.sqrt(np.einsum("eq,eqi->", basis.dx, (found - exact) ** 2) / norm))
