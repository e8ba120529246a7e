"""Kernels: a linear system and the inverse of a positive definite matrix. A pose has 48 parameters: for that few, numpy takes
half as long again or longer, and scipy's LAPACK takes a fifth of a second to import."""

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.types import Floats


@kernel
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


@kernel
def solve_positive(matrix: Floats, right: Floats) -> None:
    """Solves matrix (N,N) x = right (N,), symmetric and positive definite, in place: right becomes x. Reads the lower
    triangle, whose values are lost. An unknown whose pivot is not positive, by rounding or for want of rows, is 0.

    By Cholesky's factors without roots, row after row.
    """
    n = len(right)
    column = np.empty(n)
    for k in range(n):
        pivot = matrix[k, k]
        inverse = 1.0 / pivot if pivot > 0.0 else 0.0
        for i in range(k + 1, n):
            column[i] = matrix[i, k]
        for i in range(k + 1, n):
            factor = column[i] * inverse
            # in slices, as with offsets in the index the compiler finds no vector instructions
            row, mine = matrix[i, k + 1 : i + 1], column[k + 1 : i + 1]
            for j in range(row.shape[0]):
                row[j] -= factor * mine[j]
            right[i] -= factor * right[k]
            matrix[i, k] = factor
        matrix[k, k] = inverse
    for k in range(n - 1, -1, -1):
        x = right[k] * matrix[k, k]
        for i in range(k + 1, n):
            x -= matrix[i, k] * right[i]
        right[k] = x
