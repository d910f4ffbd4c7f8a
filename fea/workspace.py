"""What the solves of one model share, made once."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.linear_solver import SymmetricSolver
from fea.pattern import GrowingPattern
from fea.retraction import Retraction

_FOUNDATION_LENGTH_M = 5e-3
"""Choice: size of the finger's section, the scale of the foundation that makes an indefinite tangent definite."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Workspace:
    """A model with its linear solver, sparsity pattern and update.

    Attributes
    ----------
    model, solver, pattern, retraction
        One of each: patterns are analysed and least-squares systems factored once.
    foundation_n_per_m : array [n_free]
        Springs to ground that make an indefinite tangent definite.
    """

    model: SolidModel
    solver: SymmetricSolver
    pattern: GrowingPattern
    retraction: Retraction
    foundation_n_per_m: F64

    def with_contact(self, tangent: sp.csr_array, hessian: sp.csr_array) -> sp.csr_array:
        """Return a tangent [n_free, n_free] plus a contact's Hessian [3 n_nodes, 3 n_nodes], upper triangles."""
        free = self.model.free
        return self.pattern.add(tangent, sp.csr_array(hessian[free][:, free]))

    def close(self) -> None:
        """Release the factors."""
        self.solver.close()


def workspace(model: SolidModel) -> Workspace:
    """Return a new workspace of a model."""
    return Workspace(
        model=model,
        solver=SymmetricSolver(),
        pattern=GrowingPattern(),
        retraction=Retraction(model),
        foundation_n_per_m=_foundation(model),
    )


def _foundation(model: SolidModel) -> F64:
    """Return springs to ground at the free freedoms [N/m]: modulus x volume of a node / length squared."""
    volume = model.weights.sum(axis=1)
    softest = min(law.stress_and_tangent(np.eye(3)[None])[1][0, 0, 1, 0, 1] for law in model.laws.values())
    m = model.mesh.elements.shape[1]
    nodal = np.bincount(model.mesh.elements.ravel(), np.repeat(volume / m, m), minlength=len(model.mesh.points_m))
    return np.asarray(np.repeat(softest * nodal / _FOUNDATION_LENGTH_M**2, 3)[model.free])
