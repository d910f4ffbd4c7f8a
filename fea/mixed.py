"""Mixed displacement-pressure tetrahedra (P2/P1, Taylor & Hood): the referee for near-incompressible bodies.

Saddle point of L(u, p) = integral [ W(F) + p (det F - 1) - p^2 / (2 kappa) ] - p_c V_cavity(u) - f . u with quadratic
u and continuous linear p. Eliminating p pointwise gives back kappa/2 (J - 1)^2. The matrix is symmetric and
indefinite; the block -1/kappa makes it quasi-definite, so LDL^T needs no pivoting. See Boffi, Brezzi, Fortin, Mixed
Finite Element Methods and Applications, ch. 8.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem.quadrature import get_quadrature

from fea.arrays import F64, I64, Bool
from fea.assembly import deformation, element_gradients
from fea.cavity import Cavity
from fea.lattice import SolidMesh
from fea.laws import Law, cofactor_derivative
from fea.linear_solver import SymmetricSolver
from fea.load import Load
from fea.newton import NewtonOptions, Status

_CHUNK = 1024


@dataclass(frozen=True, kw_only=True, eq=False)
class MixedOutcome:
    """End of a solve.

    Attributes
    ----------
    status : Status
    u_m : array [n_nodes, 3]
    pressure_pa : array [n_vertices]
        p of the potential, negative in compression.
    iterations : int
    reaction_n : array [n_nodes, 3]
        Internal force minus load: the supports' reactions where displacements are prescribed.
    """

    status: Status
    u_m: F64
    pressure_pa: F64
    iterations: int
    reaction_n: F64

    @property
    def converged(self) -> bool:
        """Whether equilibrium was reached."""
        return self.status is Status.CONVERGED


class MixedModel:
    """A mesh of ten-node tetrahedra with one law, supports and one cavity, as ``SolidModel`` takes them.

    Raises
    ------
    ValueError
        If a law has no bulk modulus (its volumetric part is then its own, and nothing is left to p).
    """

    def __init__(
        self,
        *,
        mesh: SolidMesh,
        laws: dict[int, Law],
        fixed: Bool,
        cavity: Cavity | None = None,
        quadrature_order: int = 2,
    ) -> None:
        for index, law in laws.items():
            if not law.bulk_modulus_pa > 0.0:
                raise ValueError(f"laws: bulk modulus of material {index} = {law.bulk_modulus_pa} must be positive")
        self.mesh, self.laws, self.cavity = mesh, laws, cavity
        self.gradients, self.weights = element_gradients(mesh, quadrature_order)
        X = get_quadrature(mesh.skfem_mesh.elem(), quadrature_order)[0]
        self._linear = np.stack([1.0 - X.sum(axis=0), *X], axis=1)  # [n_points, 4]
        self.free: I64 = np.flatnonzero(~fixed.ravel())
        self.n_vertices = int(mesh.elements[:, :4].max()) + 1
        number = np.full(fixed.size + self.n_vertices, -1, dtype=np.int64)
        number[self.free] = np.arange(len(self.free))
        number[fixed.size :] = len(self.free) + np.arange(self.n_vertices)
        self._kept = np.concatenate([self.free, fixed.size + np.arange(self.n_vertices)])
        displacement = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(-1, 30)
        self._places: I64 = np.concatenate([displacement, fixed.size + mesh.elements[:, :4]], axis=1)
        self._dofs = number[self._places]
        if cavity is not None:
            self._face_dofs = number[(3 * cavity.faces[:, :, None] + np.arange(3)).reshape(-1, 18)]
        # pressure is solved for in units of the softest modulus so that both blocks are of one size
        self._unit = min(law.stress_and_tangent(np.eye(3)[None])[1][0, 0, 1, 0, 1] for law in laws.values())

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.free) + self.n_vertices

    def evaluate(self, u_m: F64, pressure_pa: F64, load: Load) -> tuple[F64, float, sp.csr_array, F64] | None:
        """Return out-of-balance forces [size], their scale, the matrix' upper triangle and reactions [n_nodes, 3].

        The scale is the larger norm of internal forces (reactions included) and load. None where det F <= 0.
        """
        internal = np.zeros(u_m.size + self.n_vertices)
        rows, columns, values = [], [], []
        r, c = np.triu_indices(34)
        for index, law in self.laws.items():
            members = np.flatnonzero(self.mesh.material == index)
            for start in range(0, len(members), _CHUNK):
                chunk = members[start : start + _CHUNK]
                nodes, dofs = self.mesh.elements[chunk], self._dofs[chunk]
                result = self._element(law, u_m[nodes], pressure_pa[nodes[:, :4]], chunk)
                if result is None:
                    return None
                np.add.at(internal, self._places[chunk], result[0])
                rows.append(dofs[:, r].ravel())
                columns.append(dofs[:, c].ravel())
                values.append(result[1][:, r, c].ravel())
        external = np.zeros(self.size)
        force = np.zeros_like(u_m) if load.force_n is None else load.force_n.copy()
        if self.cavity is not None:
            gradient, hessian = self.cavity.derivatives(self.mesh.points_m + u_m)
            force += load.pressure_pa_gauge * gradient
            r, c = np.triu_indices(18)
            rows.append(self._face_dofs[:, r].ravel())
            columns.append(self._face_dofs[:, c].ravel())
            values.append(-load.pressure_pa_gauge * hessian[:, r, c].ravel())
        external[: len(self.free)] = force.ravel()[self.free]
        row, column, value = np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
        keep = (row >= 0) & (column >= 0)
        low, high = np.minimum(row, column)[keep], np.maximum(row, column)[keep]
        matrix = sp.csr_array(sp.coo_array((value[keep], (low, high)), shape=(self.size, self.size)))
        scale = max(1e-12, float(np.linalg.norm(internal[: u_m.size])), float(np.linalg.norm(external)))
        reaction = internal[: u_m.size].reshape(-1, 3) - force
        return external - internal[self._kept], scale, matrix, reaction

    def _element(self, law: Law, u_m: F64, pressure: F64, chunk: I64) -> tuple[F64, F64] | None:
        """Return element forces [n, 34] and matrices [n, 34, 34], displacements first."""
        G, w, N = self.gradients[chunk], self.weights[chunk], self._linear
        n, points = w.shape
        F = deformation(u_m, G)
        J = np.linalg.det(F)
        if not (J > 0.0).all():
            return None
        P, A = law.stress_and_tangent(F)
        p = pressure @ N.T
        cofactor = J[..., None, None] * np.swapaxes(np.linalg.inv(F), -1, -2)
        P = P + p[..., None, None] * cofactor
        A = A + p[..., None, None, None, None] * cofactor_derivative(F)
        # B_(a i)(iJ): rows of the displacement's gradient
        rows = np.zeros((n, points, 10, 3, 3, 3))
        for i in range(3):
            rows[:, :, :, i, i, :] = G
        B = rows.reshape(n, points, 30, 9)
        weighted = w[..., None, None] * B
        K = np.zeros((n, 34, 34))
        K[:, :30, :30] = (weighted @ A.reshape(n, points, 9, 9) @ np.swapaxes(B, -1, -2)).sum(axis=1)
        flux = (weighted @ cofactor.reshape(n, points, 9, 1))[..., 0]  # [n, q, 30]
        K[:, :30, 30:] = self._unit * np.einsum("nqa,qm->nam", flux, N)
        kappa = law.bulk_modulus_pa
        K[:, 30:, 30:] = -(self._unit**2) / kappa * np.einsum("nq,qk,qm->nkm", w, N, N)
        force = np.zeros((n, 34))
        force[:, :30] = (weighted @ P.reshape(n, points, 9, 1))[..., 0].sum(axis=1)
        force[:, 30:] = self._unit * ((w * (J - 1.0 - p / kappa)) @ N)
        return force, K

    def solve(
        self, u_m: F64, pressure_pa: F64, load: Load, options: NewtonOptions, solver: SymmetricSolver
    ) -> MixedOutcome:
        """Iterate from a state that satisfies the supports to equilibrium under ``load`` (capped Newton steps)."""
        u, p = u_m.copy(), pressure_pa.copy()
        reaction = np.zeros_like(u)
        for iteration in range(options.max_iterations + 1):
            state = self.evaluate(u, p, load)
            if state is None:
                return MixedOutcome(
                    status=Status.INVERTED, u_m=u, pressure_pa=p, iterations=iteration, reaction_n=reaction
                )
            imbalance, scale, matrix, reaction = state
            step = solver.solve(matrix, imbalance)
            if step is None:
                return MixedOutcome(
                    status=Status.SINGULAR, u_m=u, pressure_pa=p, iterations=iteration, reaction_n=reaction
                )
            largest = float(np.abs(step[: len(self.free)]).max(initial=1e-30))
            if float(np.linalg.norm(imbalance)) <= options.relative_tolerance * scale:
                return MixedOutcome(
                    status=Status.CONVERGED, u_m=u, pressure_pa=p, iterations=iteration, reaction_n=reaction
                )
            step *= min(1.0, options.step_cap_m / largest)
            u.reshape(-1)[self.free] += step[: len(self.free)]
            p += self._unit * step[len(self.free) :]
        return MixedOutcome(
            status=Status.STALLED, u_m=u, pressure_pa=p, iterations=options.max_iterations, reaction_n=reaction
        )

    def increase(
        self, load_at_steps: list[Load], start_u_m: F64 | None = None, options: NewtonOptions | None = None
    ) -> MixedOutcome:
        """Solve for each load in turn from ``start_u_m`` (zero by default); ends at the first that fails."""
        u = np.zeros_like(self.mesh.points_m) if start_u_m is None else start_u_m
        p = np.zeros(self.n_vertices)
        solver = SymmetricSolver()
        total = 0
        for load in load_at_steps:
            outcome = self.solve(u, p, load, options or NewtonOptions(), solver)
            u, p, total = outcome.u_m, outcome.pressure_pa, total + outcome.iterations
            if not outcome.converged:
                break
        solver.close()
        return MixedOutcome(
            status=outcome.status, u_m=u, pressure_pa=p, iterations=total, reaction_n=outcome.reaction_n
        )
