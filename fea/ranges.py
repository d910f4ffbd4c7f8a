"""Work on many elements, cut into ranges for a few threads in a way that does not touch the sums.

Results are the same to the last bit for any number of threads. The threads live as long as one call, so that nothing is
alive when a process forks; compiled kernels and NumPy's loops release Python's lock.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

_Result = TypeVar("_Result")


def thread_count() -> int:
    """Return how many threads to use: the environment's NUMBA_NUM_THREADS, or the processors at hand."""
    here = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return int(os.environ.get("NUMBA_NUM_THREADS", "0")) or here


def map_ranges(work: Callable[[int, int], _Result], count: int, size: int) -> list[_Result]:
    """Return ``work(start, stop)`` of ranges that cover ``range(count)``, in their order."""
    starts = range(0, count, size)
    stops = [min(start + size, count) for start in starts]
    threads = min(thread_count(), len(starts))
    if threads <= 1:
        return list(map(work, starts, stops))
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, starts, stops))


def all_ranges(work: Callable[[int, int], bool], count: int, size: int) -> bool:
    """Return whether ``work(start, stop)`` returned True on all ranges."""
    return all(map_ranges(work, count, size))
