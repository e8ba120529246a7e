"""Kernel: the inverse of a positive definite matrix; scipy's LAPACK takes a fifth of a second to import."""

import numpy as np
from numba import njit

from mocapd.types import Floats


@njit(cache=True, nogil=True)
def invert_positive(matrix: Floats) -> bool:
    """Inverts a symmetric positive definite matrix (N,N) in place; reads its lower triangle. False: it is not positive
    definite, and its values are lost.

    Sweeps out one row and column after the other, as Gauss and Jordan; the pivots are those of Cholesky's factors.
    """
    n = len(matrix)
    row = np.empty(n)
    for k in range(n):
        pivot = matrix[k, k]
        if not pivot > 0.0:
            return False
        for j in range(n):
            row[j] = matrix[k, j] if j < k else matrix[j, k]
        row[k] = 0.0
        for i in range(n):
            factor = row[i] / pivot
            if i != k:
                for j in range(i + 1):
                    matrix[i, j] -= factor * row[j]
        for j in range(n):
            if j < k:
                matrix[k, j] = row[j] / pivot
            else:
                matrix[j, k] = row[j] / pivot
        matrix[k, k] = -1.0 / pivot
    for i in range(n):
        for j in range(i + 1):
            matrix[i, j] = -matrix[i, j]
            matrix[j, i] = matrix[i, j]
    return True
