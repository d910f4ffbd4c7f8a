"""Cook's membrane, nearly incompressible neo-Hookean, plane strain.

Panel (0, 0), (48, 44), (48, 60), (0, 44), held at x = 0, shear traction 6.25 on x = 48; mu 80.1938, lambda 400889.8.
The corner (48, 60) rises by 6.92 with converged mixed elements (Simo & Armero, 1992; Reese & Wriggers, 2000).
Numbers are without units in the source; here metres and pascals.
"""

import numpy as np

from fea.arrays import F64
from fea.lattice import free_faces
from fea.load import Load
from fea.meshes import linear_mesh, rectangle, surface_force, sweep
from fea.rubber import neo_hookean
from fea.verification.common import Problem, Row

MU_PA, LAMBDA_PA, TRACTION_PA, REFERENCE_M = 80.1938, 400889.8, 6.25, 6.92


def cook(formulation: str, *, cells: int = 12, steps: int = 5) -> Row:
    """Return the rise of the upper right corner; one layer of elements with u_z = 0."""

    def position(x: F64) -> F64:
        s, t = x[:, 0], x[:, 1]
        low, high = 44.0 * s, 44.0 + 16.0 * s
        return np.column_stack([48.0 * s, low + t * (high - low), x[:, 2]])

    grid = np.linspace(0.0, 1.0, cells + 1)
    mesh = sweep(rectangle(grid, grid), np.array([0.0, 48.0 / cells]), position)
    fixed = np.zeros((len(mesh.points_m), 3), dtype=bool)
    fixed[:, 2] = True
    fixed[mesh.points_m[:, 0] == 0.0] = True
    faces = free_faces(mesh, lambda c: c[..., 0] == 1.0)
    law = neo_hookean(MU_PA, LAMBDA_PA + 2.0 * MU_PA / 3.0)
    used = mesh
    if formulation == "P1":
        used, faces = linear_mesh(mesh), faces[:, :3]
    force = surface_force(used, faces, np.array([0.0, TRACTION_PA, 0.0]))
    loads = [Load(force_n=force * (k + 1) / steps) for k in range(steps)]
    u, dofs, used = Problem(mesh=mesh, law=law, fixed=fixed).equilibrium(formulation, loads)
    corner = (used.cylindrical[:, 0] == 1.0) & (used.cylindrical[:, 1] == 1.0)
    return Row(
        problem="Cook's membrane",
        formulation=formulation,
        dofs=dofs,
        quantity="rise of the corner",
        figure=float(u[corner, 1].mean()),
        exact=REFERENCE_M,
    )
