"""Sums of entries that belong to one place: from elements to nodes and to the matrix, gathered place by place.

Each sum runs in one fixed order, so results depend neither on chunks of elements nor on threads.
"""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64, I32, I64
from fea.ranges import all_ranges

_PLACES = 50_000  # places a task


@dataclass(frozen=True, kw_only=True, eq=False)
class Gather:
    """Which entries make up each place.

    Attributes
    ----------
    places : array [n]
        Increasing keys of the places.
    order : array [n_used]
        Entries, place after place.
    pointer : array [n + 1]
        Where each place starts in ``order``.
    """

    places: I64
    order: I32
    pointer: I64

    @classmethod
    def of(cls, keys: I64) -> "Gather":
        """Return the plan for entries with these keys [n_entries]; entries with negative keys belong nowhere."""
        order = np.argsort(keys, kind="stable")
        order = order[np.searchsorted(keys[order], 0) :]
        ordered = keys[order]
        starts = np.flatnonzero(np.diff(ordered, prepend=-1))
        return cls(places=ordered[starts], order=order.astype(np.int32), pointer=np.append(starts, len(order)))

    def sum(self, values: F64, *, compiled: bool) -> F64:
        """Return the sums [n] of entries [n_entries]."""
        if not compiled:
            return np.asarray(np.add.reduceat(values[self.order], self.pointer[:-1]))
        from fea.kernels import gather  # noqa: PLC0415 - optional dependency

        out = np.empty(len(self.places))

        def work(start: int, stop: int) -> bool:
            gather(values, self.order, self.pointer, start, stop, out)
            return True

        all_ranges(work, len(out), _PLACES)
        return out
