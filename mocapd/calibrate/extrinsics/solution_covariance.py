"""How well parameters of a least squares solution are known, also where errors go together.

The curvature at the solution says it for errors that are independent. Where a model is wrong for a while - pictures out
of time, a board that bends - the errors of many corners have one cause. The sandwich estimate (White 1980, Liang and
Zeger 1986) takes the scatter of whole stretches of the recording instead.
"""

from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts when they are used: they take long to import

from mocapd.types import Floats, Ints

if TYPE_CHECKING:
    import scipy.sparse


def asked_covariances(
    J: "scipy.sparse.csr_matrix", error: Floats, stretch: Ints, asked: Ints
) -> tuple[Floats, Floats]:
    """(A,A) of the parameters `asked` (A,): by the curvature, and grown to the sandwich where that is larger.

    J (N,P) and error (N,) in standard deviations; stretch (M,): of the first M rows, what goes together; rows after
    these are priors.
    """
    columns = J.shape[1]
    wanted = np.zeros((columns, len(asked)))
    wanted[asked, np.arange(len(asked))] = 1.0
    normal = (J.T @ J + 1e-12 * scipy.sparse.identity(columns)).tocsc()
    inverse = np.asarray(scipy.sparse.linalg.spsolve(normal, wanted)).reshape(wanted.shape)
    covariance: Floats = inverse[asked]
    names, group = np.unique(stretch, return_inverse=True)
    if len(names) < 2:
        return covariance, covariance
    pull = J[: len(stretch)] @ inverse * error[: len(stretch), None]  # (M,A)
    together = np.zeros((len(names), len(asked)))
    np.add.at(together, group.ravel(), pull)
    scatter = together.T @ together * (len(names) / (len(names) - 1.0))
    grown = np.sqrt(np.maximum(np.diag(scatter) / np.maximum(np.diag(covariance), 1e-300), 1.0))
    return covariance, covariance * np.outer(grown, grown)
