"""The rows of a least-squares problem multiplied with each other."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def add_products(rows: Array, square: Array) -> None:
    """Add rows^T rows to square (P,P), of rows (N,P).

    Without the columns that are 0 in all of them, which change no sum: pixels beside each other are of few limbs, and half
    of the columns take a third of the time.
    """
    n, P = rows.shape
    used = np.zeros(P, np.bool_)
    for i in range(n):
        for p in range(P):
            used[p] |= rows[i, p] != 0.0
    columns = np.flatnonzero(used)
    m = columns.shape[0]
    if m == 0:
        return
    packed = np.empty((n, m))
    for i in range(n):
        for k in range(m):
            packed[i, k] = rows[i, columns[k]]
    product = np.dot(packed.T, packed)
    for k in range(m):
        for q in range(m):
            square[columns[k], columns[q]] += product[k, q]
