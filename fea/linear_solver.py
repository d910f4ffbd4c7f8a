"""One direct solver for symmetric systems: MKL's PARDISO where it is installed, SuperLU elsewhere."""

import importlib.util
import os
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.sparse.linalg import MatrixRankWarning, splu

from fea.arrays import F64

_ANALYSE, _FACTOR_AND_SOLVE = 11, 23
# PARDISO's iparm, counted from 1: own values on, nested dissection, no scaling or matching (displacement problems)
_IPARM = {1: 1, 2: 2, 8: 2, 10: 8}


def solver_name() -> str:
    """Return which solver is used here, for provenance."""
    if importlib.util.find_spec("pypardiso") is not None:
        return "pypardiso LDL^T (mtype -2)"
    return "SuperLU (scipy)"


class SymmetricSolver:
    """Solves K x = b for symmetric K given by its upper triangle; a pattern is analysed once and reused."""

    def __init__(self, *, use_pardiso: bool | None = None) -> None:
        self._use_pardiso = solver_name().startswith("pypardiso") if use_pardiso is None else use_pardiso
        self._pardiso: Any = None
        self._pattern: tuple[npt.NDArray[np.integer[Any]], npt.NDArray[np.integer[Any]]] | None = None

    def solve(self, upper: sp.csr_array, right_side: F64) -> F64 | None:
        """Return x, shaped like the right side, or None if K is singular to working precision.

        Parameters
        ----------
        upper : csr_array [n, n]
            Upper triangle of K with its diagonal; a pattern other than the last one's costs a new analysis.
        right_side : array [n] or [n, k]
        """
        x = self._mkl(upper, right_side) if self._use_pardiso else _superlu(upper, right_side)
        return x if x is not None and bool(np.isfinite(x).all()) else None

    def close(self) -> None:
        """Release the factors."""
        if self._pardiso is not None:
            self._pardiso.free_memory(everything=True)
            self._pardiso = None

    def _mkl(self, upper: sp.csr_array, right_side: F64) -> F64 | None:
        from pypardiso.pardiso_wrapper import PyPardisoError  # noqa: PLC0415 - optional dependency

        pattern = (upper.indptr, upper.indices)
        known = self._pattern is not None and all(map(np.array_equal, self._pattern, pattern))
        self._pattern = pattern
        try:
            if self._pardiso is None:
                self._pardiso = _pardiso()
                for index, value in _IPARM.items():
                    self._pardiso.set_iparm(index, value)
                known = False
            elif not known:
                self._pardiso.free_memory(everything=True)
            if not known:
                self._run(_ANALYSE, upper, right_side)
            return self._run(_FACTOR_AND_SOLVE, upper, right_side)
        except PyPardisoError:
            return None

    def _run(self, phase: int, upper: sp.csr_array, right_side: F64) -> F64:
        # the public solve() analyses the pattern anew each time, which costs as much as the factorisation
        self._pardiso.set_phase(phase)
        return np.asarray(self._pardiso._call_pardiso(upper, np.asfortranarray(right_side)), dtype=np.float64)


class KeptFactors:
    """Factors of a symmetric positive definite matrix that many right-hand sides are solved with (SuperLU)."""

    def __init__(self, matrix: sp.csr_array) -> None:
        self._factors = _factored(sp.csc_array(matrix))

    def solve(self, right_side: F64) -> F64:
        """Return x of K x = b."""
        return np.asarray(self._factors.solve(right_side), dtype=np.float64)


def _pardiso() -> Any:
    """Return a new solver of MKL.

    PyPardiso searches the whole environment for the library each time, half a second; where it found it once is kept
    in the variable that it looks at first.
    """
    from pypardiso import PyPardisoSolver  # noqa: PLC0415 - optional dependency

    solver = PyPardisoSolver(mtype=-2, size_limit_storage=0)
    os.environ.setdefault("PYPARDISO_MKL_RT", solver.libmkl._name)
    return solver


def _superlu(upper: sp.csr_array, right_side: F64) -> F64 | None:
    full = sp.csc_array(upper + sp.triu(upper, k=1).T)
    with warnings.catch_warnings():
        warnings.simplefilter("error", MatrixRankWarning)
        try:
            factors = _factored(full)
        except (MatrixRankWarning, RuntimeError):
            return None
    return np.asarray(factors.solve(right_side), dtype=np.float64)


def _factored(full: sp.csc_array) -> Any:
    return splu(full, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
