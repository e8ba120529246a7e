"""Compiled parts of the index over id maps."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Singles = NDArray[np.float32]
Ints = NDArray[np.int64]


@kernel(fastmath=True)
def squared_gap(a: Singles, b: Singles) -> np.float32:
    """Squared Euclidean distance of two vectors."""
    total = np.float32(0.0)
    for i in range(a.shape[0]):
        d = a[i] - b[i]
        total += d * d
    return total


@kernel
def scan_cells(
    query: Singles, vectors: Singles, start: Ints, cells: Ints, index: Ints, gap: Singles
) -> int:
    """Squared distances of `query` (D,) to the vectors of some cells; returns how many were written."""
    n = 0
    for c in cells:
        for i in range(start[c], start[c + 1]):
            index[n] = i
            gap[n] = squared_gap(query, vectors[i])
            n += 1
    return n
