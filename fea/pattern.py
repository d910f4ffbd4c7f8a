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
        self._keys: I64 | None = None
        self._is_solid = np.empty(0, dtype=bool)

    def add(self, solid: sp.csr_array, contact: sp.csr_array) -> sp.csr_array:
        """Return the sum on the smallest pattern that holds everything seen so far."""
        if self._keys is None:
            self._keys = _keys(solid)
            self._is_solid = np.ones(len(self._keys), dtype=bool)
            self._number(solid.shape[0])
        extra = _keys(contact)
        place = np.searchsorted(self._keys, extra)
        known = self._keys[np.minimum(place, len(self._keys) - 1)] == extra
        if not known.all():
            self._keys = np.insert(self._keys, place[~known], extra[~known])
            self._is_solid = np.insert(self._is_solid, place[~known], False)
            self._number(solid.shape[0])
            place = np.searchsorted(self._keys, extra)
        data: F64 = np.zeros(len(self._keys))
        data[self._is_solid] = solid.data
        data[place] += contact.data
        return sp.csr_array((data, *self._structure), shape=solid.shape)

    def _number(self, size: int) -> None:
        assert self._keys is not None
        row, column = np.divmod(self._keys, size)
        pointer = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=size))])
        self._structure = (column.astype(np.int32), pointer.astype(np.int32))


def _keys(matrix: sp.csr_array) -> I64:
    """Return row * n + column of the stored entries, increasing."""
    size = matrix.shape[0]
    matrix.sum_duplicates()
    row = np.repeat(np.arange(size, dtype=np.int64), np.diff(matrix.indptr))
    return np.asarray(row * size + matrix.indices)
