"""Thick cylinder (plane strain) and thick sphere under inner pressure.

An incompressible wall from A to B moves so that b^n - a^n = B^n - A^n with n = 2 (cylinder) or 3 (sphere). With the
hoop stretch l = r/R and w(l) = W(l, 1/l, 1) or W(l, l, l^-2), equilibrium gives (Ogden, Non-linear Elastic
Deformations, 5.3)
    p = integral from l_b to l_a of w'(l) / (l^n - 1) dl.
For W = sum c (l1^a + l2^a + l3^a - 3): w' = sum c a (l^(a-1) - l^(-a-1)), or sum 2 c a (l^(a-1) - l^(-2a-1)).
"""

import numpy as np
from scipy.integrate import quad

from fea.arrays import F64
from fea.lattice import SolidMesh, free_faces
from fea.laws import IsochoricOgden
from fea.meshes import rectangle, sweep, triangle
from fea.rubber import mooney_rivlin, neo_hookean, ogden
from fea.verification.common import Problem, Row, pressures, symmetry_planes

INNER_M, OUTER_M = 1.0e-2, 2.0e-2
_BULK = 5e8  # five thousand times the shear modulus of 1e5 Pa: closed forms are for incompressible walls
LAWS = {
    "neo-Hookean": neo_hookean(1e5, _BULK),
    "Mooney-Rivlin": mooney_rivlin(3e4, 2e4, _BULK),
    # choice: the ratios of Treloar's rubber (see treloar.py) scaled to mu = 1e5 Pa
    "Ogden": ogden((1.492e5, 284.0, -2.37e3), (1.3, 5.0, -2.0), convention="mu_over_alpha", bulk_modulus_pa=_BULK),
}


def closed_form_pressure(law: IsochoricOgden, inner_stretch: float, ratio: float, n: int) -> float:
    """Return p [Pa] at the hoop stretch of the inner surface; ``ratio`` is B/A, n = 2 cylinder, 3 sphere."""
    outer = ((inner_stretch**n - 1.0) / ratio**n + 1.0) ** (1.0 / n)

    def slope(stretch: float) -> float:
        terms = zip(law.coefficients_pa, law.exponents, strict=True)
        total = sum(c * a * (stretch ** (a - 1) - stretch ** (-(n - 1) * a - 1)) for c, a in terms)
        return float((n - 1) * total / (stretch**n - 1.0))

    return float(quad(slope, outer, inner_stretch, epsabs=0.0, epsrel=1e-11)[0])


def cylinder_mesh(cells: int, around: int | None = None) -> SolidMesh:
    """Quarter of a cylinder, one layer along its axis; (s, t, w) = (r, theta, z)."""
    r, theta = np.linspace(INNER_M, OUTER_M, cells + 1), np.linspace(0.0, 0.5 * np.pi, (around or cells) + 1)

    def position(x: F64) -> F64:
        flat = x[:, 0] * np.stack([np.cos(x[:, 1]), np.sin(x[:, 1])])
        return np.column_stack([*np.where(np.abs(flat) < 1e-14, 0.0, flat), x[:, 2]])

    return sweep(rectangle(r, theta), np.array([0.0, OUTER_M / cells]), position)


def sphere_mesh(cells: int, layers: int, outer_m: float = OUTER_M) -> SolidMesh:
    """Octant of a sphere: a triangle of ``cells`` an edge projected from the centre; w = r."""

    def position(x: F64) -> F64:
        flat = np.column_stack([x[:, 0], x[:, 1], 1.0 - x[:, 0] - x[:, 1]])
        flat[np.abs(flat) < 1e-12] = 0.0
        return np.asarray(x[:, 2:] * flat / np.linalg.norm(flat, axis=1, keepdims=True))

    return sweep(triangle(cells), np.linspace(INNER_M, outer_m, layers + 1), position)


def cylinder(formulation: str, law_name: str, *, cells: int = 6, pressure_pa: float = 0.5e5) -> Row:
    """Inflate the cylinder and compare its pressure with that of the closed form at the same inner radius."""
    mesh = cylinder_mesh(cells)
    fixed = symmetry_planes(mesh)
    fixed[:, 2] = True
    faces = free_faces(mesh, lambda c: np.isclose(c[..., 0], INNER_M))
    problem = Problem(mesh=mesh, law=LAWS[law_name], fixed=fixed, cavity_faces=faces)
    u, dofs, used = problem.equilibrium(formulation, pressures(pressure_pa, 4))
    return _row(("thick cylinder", law_name, formulation), dofs, pressure_pa, used, u, 2)


def sphere(formulation: str, law_name: str, *, cells: int = 4, layers: int = 4, pressure_pa: float = 0.6e5) -> Row:
    """Inflate the sphere and compare its pressure with that of the closed form at the same inner radius."""
    mesh = sphere_mesh(cells, layers)
    faces = free_faces(mesh, lambda c: np.isclose(c[..., 2], INNER_M))
    problem = Problem(mesh=mesh, law=LAWS[law_name], fixed=symmetry_planes(mesh), cavity_faces=faces)
    u, dofs, used = problem.equilibrium(formulation, pressures(pressure_pa, 4))
    return _row(("thick sphere", law_name, formulation), dofs, pressure_pa, used, u, 3)


def _row(names: tuple[str, str, str], dofs: int, pressure: float, mesh: SolidMesh, u: F64, n: int) -> Row:
    body, law_name, formulation = names
    inner = np.isclose(mesh.cylindrical[:, 0 if n == 2 else 2], INNER_M)
    stretch = float(np.linalg.norm((mesh.points_m + u)[inner, :n], axis=1).mean()) / INNER_M
    exact = closed_form_pressure(LAWS[law_name], stretch, OUTER_M / INNER_M, n)
    return Row(
        problem=f"{body}, {law_name}",
        formulation=formulation,
        dofs=dofs,
        quantity=f"pressure [Pa] at inner stretch {stretch:.3f}",
        figure=pressure,
        exact=exact,
    )
