"""What the verification problems share: the three formulations and a row of the table."""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64, Bool
from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.lattice import SolidMesh
from fea.laws import Law
from fea.load import Load
from fea.meshes import linear_mesh
from fea.mixed import MixedModel
from fea.newton import NewtonOptions, solve_equilibrium
from fea.path import follow
from fea.workspace import workspace

FORMULATIONS = ("P1", "P2/P0", "P2/P1")


@dataclass(frozen=True, kw_only=True)
class Row:
    """One figure of a problem against what it must be."""

    problem: str
    formulation: str
    dofs: int
    quantity: str
    figure: float
    exact: float

    @property
    def error(self) -> float:
        """Relative error."""
        return abs(self.figure / self.exact - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """A mesh of ten-node tetrahedra with its supports, one law, and faces of a cavity if it has one."""

    mesh: SolidMesh
    law: Law
    fixed: Bool
    cavity_faces: np.ndarray | None = None

    def equilibrium(
        self, formulation: str, loads: list[Load], start_m: F64 | None = None, tolerance: float = 1e-7
    ) -> tuple[F64, int, SolidMesh]:
        """Return displacement [n_nodes, 3] under the last of the loads, unknowns and the mesh of the formulation.

        Raises
        ------
        ValueError
            For an unknown formulation.
        RuntimeError
            If equilibrium is not reached.
        """
        if formulation not in FORMULATIONS:
            raise ValueError(f"formulation = {formulation!r}; allowed: {list(FORMULATIONS)}")
        mesh = linear_mesh(self.mesh) if formulation == "P1" else self.mesh
        n = len(mesh.points_m)
        start = np.zeros((n, 3)) if start_m is None else start_m[:n]
        faces = self.cavity_faces
        if faces is not None and formulation == "P1":
            faces = faces[:, :3]
        cavity = None if faces is None else Cavity(faces, n)
        cap = 0.1 * float(np.ptp(mesh.points_m, axis=0).max())  # choice: the penalty form overshoots with more
        options = NewtonOptions(step_cap_m=cap, relative_tolerance=tolerance, max_iterations=30)
        laws = {0: self.law}
        if formulation == "P2/P1":
            mixed = MixedModel(mesh=mesh, laws=laws, fixed=self.fixed, cavity=cavity)
            end = mixed.increase(loads, start, options)
            if not end.converged:
                raise RuntimeError(f"P2/P1: no equilibrium, {end.status.value}")
            return end.u_m, mixed.size, mesh
        model = SolidModel(mesh=mesh, laws=laws, fixed=self.fixed[:n], cavity=cavity)
        if start_m is None:
            steps = [(k + 1.0) / len(loads) for k in range(len(loads))]
            outcome = follow(model, lambda s: _between(loads, s), steps, options, on_target=lambda *_: None)
        else:
            outcome = solve_equilibrium(workspace(model), start, loads[-1], options)
        if not outcome.converged:
            raise RuntimeError(f"{formulation}: no equilibrium, {outcome.status.value}")
        return outcome.u_m, len(model.free), mesh


def symmetry_planes(mesh: SolidMesh) -> Bool:
    """Hold u_i = 0 on each coordinate plane x_i = 0, array [n_nodes, 3]."""
    size = float(np.abs(mesh.points_m).max())
    return np.asarray(np.abs(mesh.points_m) < 1e-12 * size)


def pressures(last_pa: float, steps: int) -> list[Load]:
    """Return equal steps of gauge pressure."""
    return [Load(pressure_pa_gauge=last_pa * (k + 1) / steps) for k in range(steps)]


def _between(loads: list[Load], parameter: float) -> Load:
    """Return the last load scaled by the parameter in [0, 1]: loads here grow in proportion."""
    force = loads[-1].force_n
    return Load(
        pressure_pa_gauge=parameter * loads[-1].pressure_pa_gauge, force_n=None if force is None else parameter * force
    )
