"""Treloar's rubber: Ogden's three terms in uniaxial and equibiaxial tension (Ogden, 1972, Proc. R. Soc. A 326).

mu = (0.63, 0.0012, -0.01) MPa, alpha = (1.3, 5, -2). Nominal stress of the incompressible body at stretch l:
    uniaxial     f = sum mu (l^(a-1) - l^(-a/2-1)),      equibiaxial  f = sum mu (l^(a-1) - l^(-2a-1)).
"""

import numpy as np

from fea.assembly import SolidModel
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.newton import NewtonOptions, solve_equilibrium
from fea.rubber import ogden
from fea.verification.common import Row, symmetry_planes
from fea.workspace import workspace

MU_PA, ALPHA = (0.63e6, 0.0012e6, -0.01e6), (1.3, 5.0, -2.0)


def treloar(mode: str, stretch: float) -> Row:
    """Stretch a unit cube of P2/P0 elements by its faces x = 1 (and y = 1) and return the force on x = 1."""
    law = ogden(MU_PA, ALPHA, convention="mu_over_alpha", bulk_modulus_pa=2e4 * 0.42e6)
    across = {"uniaxial": -0.5, "equibiaxial": -2.0}[mode]
    grid = np.array([0.0, 1.0])
    mesh = sweep(rectangle(grid, grid), grid)
    X = mesh.points_m
    fixed = symmetry_planes(mesh)
    pulled = [0] if mode == "uniaxial" else [0, 1]
    for axis in pulled:
        fixed[X[:, axis] == 1.0, axis] = True
    model = SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)
    options, work = NewtonOptions(relative_tolerance=1e-8, step_cap_m=0.3, max_iterations=40), workspace(model)
    stretches = np.full(3, stretch**across)
    stretches[pulled] = stretch
    # the incompressible shape is known; what the solve adds is its small change of volume, and the forces
    outcome = solve_equilibrium(work, X * (stretches - 1.0), Load(), options)
    if not outcome.converged:
        raise RuntimeError(f"Treloar {mode}: {outcome.status.value} at {stretch:g}")
    u = outcome.u_m
    state = model.evaluate(u, Load(), tangent=False)
    assert state is not None
    work.close()
    exact = sum(m * (stretch ** (a - 1.0) - stretch ** (across * a - 1.0)) for m, a in zip(MU_PA, ALPHA, strict=True))
    return Row(
        problem=f"Treloar's rubber, {mode}",
        formulation="P2/P0",
        dofs=len(model.free),
        quantity=f"nominal stress [Pa] at stretch {stretch:g}",
        figure=float(state.reaction_n[X[:, 0] == 1.0, 0].sum()),
        exact=float(exact),
    )
