"""Thick cylinder at small strain in plane strain, any Poisson ratio (Lame; Timoshenko & Goodier, Theory of Elasticity).

    u(A) = p A / (2 mu (B^2 - A^2)) [ (1 - 2 nu) A^2 + B^2 ].
The pressure is 1e-5 of the shear modulus, so the finite-strain code is in its linear range.
"""

import numpy as np

from fea.lattice import free_faces
from fea.rubber import neo_hookean
from fea.verification.common import Problem, Row, pressures, symmetry_planes
from fea.verification.inflation import INNER_M, OUTER_M, cylinder_mesh

SHEAR_MODULUS_PA = 1e5


def lame_cylinder(formulation: str, *, poisson_ratio: float = 0.4995, cells: int = 6) -> Row:
    """Return the displacement of the inner surface."""
    nu, p = poisson_ratio, 1e-5 * SHEAR_MODULUS_PA
    mesh = cylinder_mesh(cells)
    fixed = symmetry_planes(mesh)
    fixed[:, 2] = True
    faces = free_faces(mesh, lambda c: np.isclose(c[..., 0], INNER_M))
    law = neo_hookean(SHEAR_MODULUS_PA, SHEAR_MODULUS_PA * 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)))
    u, dofs, used = Problem(mesh=mesh, law=law, fixed=fixed, cavity_faces=faces).equilibrium(
        formulation, pressures(p, 1)
    )
    inner = np.isclose(used.cylindrical[:, 0], INNER_M)
    radial = np.linalg.norm(used.points_m[inner, :2] + u[inner, :2], axis=1) - np.linalg.norm(
        used.points_m[inner, :2], axis=1
    )
    a2, b2 = INNER_M**2, OUTER_M**2
    return Row(
        problem=f"Lame cylinder, nu {nu:g}",
        formulation=formulation,
        dofs=dofs,
        quantity="u(A) [m]",
        figure=float(radial.mean()),
        exact=p * INNER_M / (2.0 * SHEAR_MODULUS_PA * (b2 - a2)) * ((1.0 - 2.0 * nu) * a2 + b2),
    )
