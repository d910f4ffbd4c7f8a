"""From the linear step of Newton's method to a displacement that turns stiff parts instead of stretching them.

A linear step turns a body by adding w x r, which stretches it by |w|^2 / 2: a hundred times the elastic strain of the
thread's rings, and 10^4 times their stress. Here each integration point's increment of deformation, split into
rotation W and strain S, is applied as exp(W) exp(S) F, and the displacement whose gradients come nearest in the
stiffness-weighted least-squares sense is taken. It differs from the linear step in second order only, so that the
quadratic convergence of Newton's method stays. The split is that of rotation-strain coordinates (Huang et al. 2011,
Interactive shape interpolation through controllable dynamic deformation, IEEE TVCG 17(7)); its use as the update of an
implicit solve is ours.
"""

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64
from fea.assembly import SolidModel, deformation
from fea.linear_solver import KeptFactors
from fea.ranges import map_ranges

_CHUNK = 1024  # elements a task


class Retraction:
    """Corrects steps of one model; the least-squares systems, one a direction, are factored once."""

    def __init__(self, model: SolidModel) -> None:
        self._model = model
        mesh = model.mesh
        modulus = np.zeros(len(mesh.elements))
        for index, law in model.laws.items():
            modulus[mesh.material == index] = law.stress_and_tangent(np.eye(3)[None])[1][0, 0, 1, 0, 1]
        self._weighted = model.gradients * (model.weights * modulus[:, None])[..., None, None]
        local = (self._weighted @ np.swapaxes(model.gradients, -1, -2)).sum(axis=1)
        n_nodes, nodes = len(mesh.points_m), mesh.elements
        m = nodes.shape[1]
        places = (np.repeat(nodes, m, axis=1).ravel(), np.tile(nodes, (1, m)).ravel())
        matrix = sp.csr_array(sp.coo_array((local.ravel(), places), shape=(n_nodes, n_nodes)))
        free = np.zeros(3 * n_nodes, dtype=bool)
        free[model.free] = True
        self._free: list[I64] = [np.flatnonzero(column) for column in free.reshape(-1, 3).T]
        self._factors = [KeptFactors(sp.csr_array(matrix[rows][:, rows])) if len(rows) else None for rows in self._free]

    def __call__(self, u_m: F64, step_m: F64) -> F64:
        """Return the corrected step [n_nodes, 3] at displacements u [n_nodes, 3]; supports keep theirs."""
        nodes = self._model.mesh.elements

        def missing(start: int, stop: int) -> F64:
            chunk, gradients = nodes[start:stop], self._model.gradients[start:stop]
            F = deformation(u_m[chunk], gradients)
            increment = np.swapaxes(step_m[chunk], -1, -2)[:, None] @ gradients
            lack = turned_and_stretched(F, increment) - F - increment
            return np.asarray((self._weighted[start:stop] @ np.swapaxes(lack, -1, -2)).sum(axis=1))

        local = np.concatenate(map_ranges(missing, len(nodes), _CHUNK))
        corrected = step_m.copy()
        for axis, (rows, factors) in enumerate(zip(self._free, self._factors, strict=True)):
            right: F64 = np.zeros(len(u_m))
            right += np.bincount(nodes.ravel(), weights=local[..., axis].ravel(), minlength=len(u_m))
            if factors is not None:
                corrected[rows, axis] += factors.solve(right[rows])
        return corrected


def turned_and_stretched(F: F64, increment: F64) -> F64:
    """Return exp(W) exp(S) F [..., 3, 3] where W + S = increment F^-1, skew and symmetric.

    Rotations are exact (Rodrigues); exp(S) is its series to third order, since strains of a step are small.
    """
    D = increment @ np.linalg.inv(F)
    transposed = np.swapaxes(D, -1, -2)
    S, W = 0.5 * (D + transposed), 0.5 * (D - transposed)
    angle = np.sqrt(0.5 * (W * W).sum(axis=(-1, -2)))[..., None, None]
    half = np.sinc(0.5 * angle / np.pi)
    rotation = np.eye(3) + np.sinc(angle / np.pi) * W + 0.5 * half**2 * (W @ W)
    squared = S @ S
    stretch = np.eye(3) + S + 0.5 * squared + squared @ S / 6.0
    return np.asarray(rotation @ stretch @ F)
