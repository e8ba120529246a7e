"""Compiled parts of the index over id maps: clustering, thinning, scanning."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Singles = NDArray[np.float32]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True, fastmath=True)
def squared_gap(a: Singles, b: Singles) -> np.float32:
    """Squared Euclidean distance of two vectors."""
    total = np.float32(0.0)
    for i in range(a.shape[0]):
        d = a[i] - b[i]
        total += d * d
    return total


@njit(cache=True, nogil=True)
def farthest_point_radii(vectors: Singles, start: Ints, out: Singles) -> None:
    """How far each vector is from those chosen before it, in a greedy farthest-point order of its cell.

    vectors (N,D) sorted by cell, those of cell c at start[c] : start[c + 1]. The first of a cell, the
    one nearest to its mean, gets infinity. Keeping the largest radii of all cells keeps the cells'
    sparse regions and thins their dense ones.
    """
    D = vectors.shape[1]
    mean = np.empty(D, np.float32)
    for c in range(start.shape[0] - 1):
        a, n = start[c], start[c + 1] - start[c]
        if n == 0:
            continue
        mean[:] = 0.0
        for i in range(n):
            for k in range(D):
                mean[k] += vectors[a + i, k]
        mean /= n
        chosen, least = 0, np.float32(np.inf)
        for i in range(n):
            d = squared_gap(vectors[a + i], mean)
            if d < least:
                chosen, least = i, d
        gap = np.full(n, np.inf, np.float32)
        for _ in range(n):
            out[a + chosen] = np.sqrt(gap[chosen])
            gap[chosen] = -1.0
            following, most = 0, np.float32(-1.0)
            for i in range(n):
                if gap[i] < 0.0:
                    continue
                d = squared_gap(vectors[a + i], vectors[a + chosen])
                if d < gap[i]:
                    gap[i] = d
                if gap[i] > most:
                    following, most = i, gap[i]
            chosen = following


@njit(cache=True, nogil=True)
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
