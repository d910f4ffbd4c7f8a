"""The gas balance of all elements as compiled loops over arrays.

The same formulas, in the same order, as `Element` and `network`, which stay the reference and run where numba is
missing. Imported only where it is installed.
"""
