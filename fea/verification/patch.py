"""Patch test: a distorted mesh whose surface follows u = G X must do so inside, with any formulation.

A uniform deformation gradient F = I + G is in equilibrium without body force, so every element family that reproduces
linear displacements and integrates a uniform stress exactly gives it to rounding (Irons & Razzaque, 1972).
"""

import numpy as np

from fea.arrays import F64
from fea.lattice import SolidMesh
from fea.load import Load
from fea.meshes import rectangle, straight_sided, sweep
from fea.rubber import neo_hookean
from fea.verification.common import Problem

GRADIENT = np.array([[0.10, 0.05, 0.0], [-0.03, -0.06, 0.02], [0.04, 0.0, 0.03]])


def distorted_cube(cells: int, rng: np.random.Generator, amount: float = 0.2) -> SolidMesh:
    """Return a unit cube whose inner vertices are moved at random by up to ``amount`` of a cell."""
    grid = np.linspace(0.0, 1.0, cells + 1)
    mesh = sweep(rectangle(grid, grid), grid)
    vertices = mesh.points_m[: (cells + 1) ** 3].copy()
    inside = ((vertices > 1e-9) & (vertices < 1.0 - 1e-9)).all(axis=1)
    vertices[inside] += amount / cells * rng.uniform(-1.0, 1.0, (int(inside.sum()), 3))
    return straight_sided(mesh, vertices)


def patch(formulation: str, rng: np.random.Generator, *, cells: int = 3) -> tuple[float, int]:
    """Return the largest error of u over the largest |G X|, and the number of unknowns."""
    mesh = distorted_cube(cells, rng)
    X: F64 = mesh.points_m
    surface = np.any((X < 1e-9) | (X > 1.0 - 1e-9), axis=1)
    exact = X @ GRADIENT.T
    start = np.where(surface[:, None], exact, exact + 3e-4 * rng.standard_normal(exact.shape))
    fixed = np.repeat(surface[:, None], 3, axis=1)
    problem = Problem(mesh=mesh, law=neo_hookean(1e5, 1e7), fixed=fixed)
    u, dofs, used = problem.equilibrium(formulation, [Load()], start, tolerance=1e-11)
    scale = float(np.abs(exact).max())
    return float(np.abs(u - exact[: len(used.points_m)]).max()) / scale, dofs
