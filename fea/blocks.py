"""Sums of small dense matrices over the nodes that they belong to."""

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64


def upper_sum(nodes: I64, blocks: F64, n_nodes: int) -> sp.csr_array:
    """Return the upper triangle [3 n_nodes, 3 n_nodes] of the sum of symmetric blocks.

    Parameters
    ----------
    nodes : array [n, k]
    blocks : array [n, 3 k, 3 k]
        Rows and columns in the order of the nodes, three directions each. Neighbours in the list with the same nodes
        are added before anything is sorted, which is most of the work.
    """
    size = 3 * n_nodes
    if not len(blocks):
        return sp.csr_array((size, size))
    starts = np.flatnonzero(np.append(True, (nodes[1:] != nodes[:-1]).any(axis=1)))
    summed = np.add.reduceat(blocks, starts, axis=0)
    dofs = (3 * nodes[starts][:, :, None] + np.arange(3)).reshape(len(starts), -1)
    row, column = np.broadcast_to(dofs[:, :, None], summed.shape), np.broadcast_to(dofs[:, None, :], summed.shape)
    kept = (row <= column) & (summed != 0.0)
    return sp.csr_array((summed[kept], (row[kept], column[kept])), shape=(size, size))
