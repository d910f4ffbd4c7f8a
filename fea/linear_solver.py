"""One direct solver for symmetric indefinite systems: MKL's PARDISO where it is installed, SuperLU elsewhere."""

import importlib.util
import warnings

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import MatrixRankWarning, spsolve

from fea.arrays import F64


def solver_name() -> str:
    """Return which solver is used here, for provenance."""
    if importlib.util.find_spec("pypardiso") is not None:
        return "pypardiso LDL^T (mtype -2)"
    return "SuperLU (scipy)"


def solve_symmetric(upper: sp.csr_array, right_side: F64) -> F64 | None:
    """Solve K x = b for a symmetric K given by its upper triangle.

    Parameters
    ----------
    upper : csr_array [n, n]
        Upper triangle of K with its diagonal.
    right_side : array [n] or [n, k]

    Returns
    -------
    array like ``right_side``, or None
        None if K is singular to working precision.
    """
    x = _pardiso(upper, right_side) if solver_name().startswith("pypardiso") else _superlu(upper, right_side)
    return x if x is not None and bool(np.isfinite(x).all()) else None


def _pardiso(upper: sp.csr_array, right_side: F64) -> F64 | None:
    from pypardiso import PyPardisoSolver  # noqa: PLC0415 - optional dependency
    from pypardiso.pardiso_wrapper import PyPardisoError  # noqa: PLC0415

    solver = PyPardisoSolver(mtype=-2, size_limit_storage=0)
    try:
        return np.asarray(solver.solve(upper, right_side), dtype=np.float64)
    except PyPardisoError:
        return None
    finally:
        solver.free_memory(everything=True)


def _superlu(upper: sp.csr_array, right_side: F64) -> F64 | None:
    full = sp.csc_array(upper + sp.triu(upper, k=1).T)
    with warnings.catch_warnings():
        warnings.simplefilter("error", MatrixRankWarning)
        try:
            return np.asarray(spsolve(full, right_side, permc_spec="MMD_AT_PLUS_A"), dtype=np.float64)
        except (MatrixRankWarning, RuntimeError):
            return None
