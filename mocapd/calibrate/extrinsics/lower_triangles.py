"""Lower triangles of normal matrices (Cholesky), and systems that they solve."""

import numpy as np
import scipy  # its submodules load on first use: they take long to import

from mocapd.types import Floats

# of the diagonal, in order: the matrix only shapes the steps, the solution is the same
_RIDGES = (1e-9, 1e-6, 1e-3)


def solved_lower(L: Floats, b: Floats, transposed: int) -> Floats:
    """inv(L) b, or inv(L^T) b, for a lower triangle without zeros on its diagonal.

    LSMR needs thousands of small ones: scipy's checked wrapper around LAPACK takes five times as long.
    """
    x: Floats = scipy.linalg.lapack.dtrtrs(L, b, lower=1, trans=transposed)[0]
    return x


def lower_triangle(normal: Floats) -> Floats:
    """L (n,n) of the normal matrix, or of a slightly damped one where that is singular to rounding.

    A position whose corners are all outliers has no rows: it stays fixed.
    """
    diagonal = np.where(np.diag(normal) > 0.0, np.diag(normal), 1.0)
    for ridge in _RIDGES:
        stiff = normal.copy()
        stiff[np.diag_indices(len(normal))] = (1.0 + ridge) * diagonal
        # info: 0, or the minor that is not positive
        L, info = scipy.linalg.lapack.dpotrf(stiff, lower=True, clean=True)
        if info == 0:
            lower: Floats = L
            return lower
    return np.diag(np.sqrt(diagonal))
