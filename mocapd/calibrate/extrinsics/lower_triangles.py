"""Lower triangles of normal matrices (Cholesky), and systems that they solve."""

import numpy as np
import scipy  # its parts when they are used: they take long to import

from mocapd.types import Floats

# of the diagonal, tried in turn: the matrix only shapes the steps, the solution is the same
_RIDGES = (1e-9, 1e-6, 1e-3)


def solved_lower(L: Floats, b: Floats, transposed: int) -> Floats:
    """inv(L) b, or inv(L^T) b, for a lower triangle without zeros on its diagonal.

    LSMR asks for thousands of these, small ones: scipy's function of LAPACK's with checks around it takes five
    times as long.
    """
    x: Floats = scipy.linalg.lapack.dtrtrs(L, b, lower=1, trans=transposed)[0]
    return x


def lower_triangle(normal: Floats) -> Floats:
    """L (n,n) of the normal matrix, or of one a little stiffer where that is singular to rounding.

    A position that lost all its corners as outliers has no rows: it stays where it is.
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
    scales: Floats = np.diag(np.sqrt(diagonal))
    return scales
