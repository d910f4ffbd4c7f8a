"""The same problems in felupe (GPL, optional extra ``crosscheck``): other elements, law, pressure load and solver.

Both bodies are neo-Hookean, W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2, with kappa = 5 mu, where felupe's 27-node
hexahedra do not lock. Ours are P2/P1 tetrahedra: nothing but the problem is shared.
"""

import importlib
from typing import Any

import numpy as np

from fea.arrays import F64, Bool
from fea.lattice import free_faces
from fea.linear_solver import SymmetricSolver
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.mixed import MixedModel
from fea.newton import NewtonOptions
from fea.rubber import neo_hookean
from fea.verification.common import Problem, Row, pressures, symmetry_planes
from fea.verification.inflation import INNER_M, OUTER_M, cylinder_mesh

MU_PA, KAPPA_PA = 1e5, 5e5


def _twist(X: F64) -> F64:
    """Return a displacement [n, 3] that twists, bends and stretches the unit cube; smooth, so nothing is singular."""
    x, y, z = X[:, 0] - 0.5, X[:, 1] - 0.5, X[:, 2]
    return np.column_stack([-0.5 * y * z + 0.15 * z**2, 0.5 * x * z, 0.15 * z + 0.2 * x * z])


def twisted_block(*, cells: int = 6, felupe_cells: int = 4) -> Row:
    """Move the whole surface of a unit cube by a smooth field: virtual work of its forces in the field itself."""
    fem: Any = importlib.import_module("felupe")
    mesh = fem.Cube(n=felupe_cells + 1).add_midpoints_edges().add_midpoints_faces().add_midpoints_volumes()
    field = fem.FieldContainer([fem.Field(fem.RegionTriQuadraticHexahedron(mesh), dim=3)])
    solid = fem.SolidBody(fem.NeoHooke(mu=MU_PA, bulk=KAPPA_PA), field)
    surface = _on_cube(mesh.points)
    dofs = np.arange(3 * len(mesh.points)).reshape(-1, 3)
    prescribed, free = dofs[surface].ravel(), dofs[~surface].ravel()
    for fraction in (0.5, 1.0):
        values = fraction * _twist(mesh.points)[surface].ravel()
        fem.newtonraphson(items=[solid], dof0=prescribed, dof1=free, ext0=values, verbose=0)
    force = np.asarray(solid.assemble.vector(field).toarray()).reshape(-1, 3)
    exact = float((force * _twist(mesh.points))[surface].sum())

    grid = np.linspace(0.0, 1.0, cells + 1)
    ours = sweep(rectangle(grid, grid), grid)
    on_surface = _on_cube(ours.points_m)
    fixed = np.repeat(on_surface[:, None], 3, axis=1)
    model = MixedModel(mesh=ours, laws={0: neo_hookean(MU_PA, KAPPA_PA)}, fixed=fixed)
    move = _twist(ours.points_m)
    # a start off the surface's field, so that the inside has to be found
    start = np.where(fixed, move, 0.98 * move)
    options, solver = NewtonOptions(step_cap_m=0.3, relative_tolerance=1e-8), SymmetricSolver()
    outcome = model.solve(start, np.zeros(model.n_vertices), Load(), options, solver)
    solver.close()
    if not outcome.converged:
        raise RuntimeError(f"twisted block: {outcome.status.value}")
    return Row(
        problem="twisted block against felupe",
        formulation="P2/P1",
        dofs=model.size,
        quantity="virtual work [J] of the surface",
        figure=float((outcome.reaction_n * move)[on_surface].sum()),
        exact=exact,
    )


def inflated_cylinder(*, cells: int = 6, pressure_pa: float = 0.4e5) -> Row:
    """Thick cylinder in plane strain under inner pressure: displacement of the inner surface."""
    fem: Any = importlib.import_module("felupe")
    height = OUTER_M / cells
    mesh = fem.Cube(a=(INNER_M, 0.0, 0.0), b=(OUTER_M, 0.5 * np.pi, height), n=(cells + 1, cells + 1, 2))
    mesh = mesh.add_midpoints_edges().add_midpoints_faces().add_midpoints_volumes()
    r, theta, z = mesh.points.T.copy()
    inner = np.isclose(r, INNER_M)
    mesh.points[:] = np.column_stack([r * np.cos(theta), r * np.sin(theta), z])
    field = fem.FieldContainer([fem.Field(fem.RegionTriQuadraticHexahedron(mesh), dim=3)])
    wall = fem.RegionTriQuadraticHexahedronBoundary(mesh, only_surface=True, mask=inner)
    surface = fem.FieldContainer([fem.Field(wall, dim=3)])
    bounds = {
        "x": fem.Boundary(field[0], mask=np.isclose(theta, 0.5 * np.pi), skip=(0, 1, 1)),
        "y": fem.Boundary(field[0], mask=theta == 0.0, skip=(1, 0, 1)),
        "z": fem.Boundary(field[0], mask=np.ones(len(z), dtype=bool), skip=(1, 1, 0)),
    }
    solid = fem.SolidBody(fem.NeoHooke(mu=MU_PA, bulk=KAPPA_PA), field)
    load = fem.SolidBodyPressure(surface)
    for fraction in (0.25, 0.5, 0.75, 1.0):
        load.update(fraction * pressure_pa)
        _newton(fem, field, [solid, load], bounds)
    theirs = np.asarray(field[0].values)[inner]
    exact = np.linalg.norm(mesh.points[inner, :2] + theirs[:, :2], axis=1).mean() - INNER_M

    ours = cylinder_mesh(cells)
    fixed = symmetry_planes(ours)
    fixed[:, 2] = True
    faces = free_faces(ours, lambda c: np.isclose(c[..., 0], INNER_M))
    problem = Problem(mesh=ours, law=neo_hookean(MU_PA, KAPPA_PA), fixed=fixed, cavity_faces=faces)
    u, dofs, _ = problem.equilibrium("P2/P1", pressures(pressure_pa, 4))
    on_wall = np.isclose(ours.cylindrical[:, 0], INNER_M)
    growth = np.linalg.norm((ours.points_m + u)[on_wall, :2], axis=1).mean() - INNER_M
    return Row(
        problem="inflated cylinder against felupe",
        formulation="P2/P1",
        dofs=dofs,
        quantity="growth of the inner radius [m]",
        figure=float(growth),
        exact=float(exact),
    )


def _on_cube(X: F64) -> Bool:
    return np.asarray(np.any((X < 1e-9) | (X > 1.0 - 1e-9), axis=1))


def _newton(fem: Any, field: Any, items: list[Any], bounds: dict[str, Any]) -> None:
    prescribed, free = fem.dof.partition(field, bounds)
    values = fem.dof.apply(field, bounds, prescribed)
    fem.newtonraphson(items=items, dof0=prescribed, dof1=free, ext0=values, verbose=0)
