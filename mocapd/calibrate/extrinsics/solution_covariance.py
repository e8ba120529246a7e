"""Covariance of parameters of a least squares solution, robust against correlated errors.

The curvature at the solution gives it for independent errors. Where the model is wrong for a while - pictures with time
errors, a board that bends - the errors of many corners have a common cause. The sandwich estimate (White 1980, Liang and
Zeger 1986) takes the scatter of whole stretches of the recording instead.
"""

import numpy as np
import scipy  # its submodules load on first use: they take long to import

from mocapd.types import Floats, Ints


def asked_covariances(
    J: "scipy.sparse.csr_matrix", error: Floats, stretch: Ints, asked: Ints
) -> tuple[Floats, Floats]:
    """(A,A) of the parameters `asked` (A,): by the curvature, raised to the sandwich estimate where that is larger.

    J (N,P) and error (N,) in standard deviations; stretch (M,): the stretch of each of the first M rows; the rows after
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
