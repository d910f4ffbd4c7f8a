"""A sparsity pattern that only grows: contact comes and goes, and each new pattern costs the solver an analysis."""

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64


class GrowingPattern:
    """Adds a matrix whose pattern varies (contact) to one whose pattern never does (the solid).

    Entries that were once needed stay, as explicit zeros, so that the pattern settles after a few iterations. All
    matrices are upper triangles, csr_array [n, n], with sorted indices.
    """

    def __init__(self) -> None:
        self._keys: I64 = np.empty(0, dtype=np.int64)
        self._solid_places: I64 = np.empty(0, dtype=np.int64)
        self._structure: tuple[I64, I64] | None = None

    def add(self, solid: sp.csr_array, contact: sp.csr_array) -> sp.csr_array:
        """Return the sum on the smallest pattern that holds everything seen so far."""
        extra, values = _keys(contact), contact.data
        if self._structure is None:
            self._grow(_keys(solid), extra, solid.shape[0])
        elif not self._holds(extra):
            self._grow(self._keys[self._solid_places], np.concatenate([self._keys, extra]), solid.shape[0])
        data: F64 = np.zeros(len(self._keys))
        data[self._solid_places] = solid.data
        data[np.searchsorted(self._keys, extra)] += values
        assert self._structure is not None
        return sp.csr_array((data, *self._structure), shape=solid.shape)

    def _holds(self, keys: I64) -> bool:
        place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return bool((self._keys[place] == keys).all())

    def _grow(self, solid: I64, extra: I64, size: int) -> None:
        self._keys = np.union1d(solid, extra)
        self._solid_places = np.searchsorted(self._keys, solid)
        pointer = np.searchsorted(self._keys, np.arange(size + 1) * np.int64(size))
        self._structure = ((self._keys % size).astype(np.int32), pointer.astype(np.int32))


def _keys(matrix: sp.csr_array) -> I64:
    """Return row * n + column of the stored entries."""
    size = matrix.shape[0]
    row = np.repeat(np.arange(size, dtype=np.int64), np.diff(matrix.indptr))
    return np.asarray(row * size + matrix.indices)
