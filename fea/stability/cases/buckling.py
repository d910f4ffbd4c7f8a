"""A slender column under a tip load beyond Euler's: the straight state is unstable, the bent one is the answer.

Elastica of a cantilever under an axial tip load P (Timoshenko & Gere, Theory of Elastic Stability, 2.7): with
k = sin(alpha / 2) and alpha the tip's turn, P / P_cr = (2 K(k) / pi)^2 and the tip moves sideways by
2 k L / sqrt(P / EI) / L = 2 k / K(k) of the length.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

from fea.assembly import SolidModel
from fea.lattice import free_faces
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, surface_force, sweep
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.stability.case import SolidCase, SolidFinding, judged
from fea.workspace import workspace

YOUNG_PA, SIDE_M, LENGTH_M = 1e6, 2e-3, 40e-3
OVER = 1.1
"""Choice: a tenth over Euler's load bends the tip by 0.6 rad."""


def buckled() -> SolidFinding:
    """Run: a column of 1 : 20 under 1.1 times Euler's load, started with a trace of side load."""
    grid = np.linspace(-0.5 * SIDE_M, 0.5 * SIDE_M, 2)
    mesh = sweep(rectangle(grid, grid), np.linspace(0.0, LENGTH_M, 17))
    z = mesh.points_m[:, 2]
    fixed = np.zeros((len(z), 3), dtype=bool)
    # no lateral contraction: the clamp adds no stiffness of its own
    fixed[z == 0.0] = True
    law = StVenantKirchhoff(young_modulus_pa=YOUNG_PA, poisson_ratio=0.0)
    model = SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)
    tip = free_faces(mesh, lambda c: np.isclose(c[..., 2], LENGTH_M))
    inertia = SIDE_M**4 / 12.0
    critical = np.pi**2 * YOUNG_PA * inertia / (4.0 * LENGTH_M**2)
    down = surface_force(mesh, tip, np.array([0.0, 0.0, -1.0 / SIDE_M**2]))
    side = surface_force(mesh, tip, np.array([1.0 / SIDE_M**2, 0.0, 0.0]))
    work, u, at = workspace(model), np.zeros_like(mesh.points_m), Load()
    options = NewtonOptions(relative_tolerance=1e-7, max_iterations=60, step_cap_m=0.2 * LENGTH_M)
    for share, push in ((0.5, 0.02), (0.9, 0.02), (OVER, 0.02), (OVER, 0.0)):
        load = Load(force_n=critical * (share * down + push * side))
        outcome = solve_equilibrium(work, u, load, options, balanced=at)
        if not outcome.converged:
            return judged("tip against the elastica", 1.0, 0.0, typed=outcome.status.value)
        u, at = outcome.u_m, load
    assert outcome.status is Status.CONVERGED
    found = abs(float(u[np.isclose(z, LENGTH_M), 0].mean())) / LENGTH_M
    # the load at which the elastica has this tip: near Euler's load the tip itself is all but undetermined
    k = float(brentq(lambda k: 2.0 * k / float(ellipk(k * k)) - found, 1e-4, 0.8))
    load_there = (2.0 * float(ellipk(k * k)) / np.pi) ** 2
    return judged("load of the elastica with this tip, relative error, <= 0.02", abs(load_there / OVER - 1.0), 0.02)


KINDS = {
    "buckling under a tip load": SolidCase(
        name="buckling under a tip load",
        hard="the straight state is in balance too, and unstable",
        stability="converges, or says why not",
        correctness="load of the elastica with the same tip",
        run=buckled,
    )
}
