"""Sparse Levenberg-Marquardt for many parameters, each residual depending on few.

scipy's own sparse solver iterates (LSMR) for each step, which took most of a calibration's time; here a direct solver
gives each step.
"""

from collections.abc import Callable

import numpy as np
import scipy  # its submodules load on first use: they take long to import

from mocapd.types import Floats

_DAMPING = 1e-6  # of the diagonal, at first,
_LEAST_DAMPING, _MOST_DAMPING = 1e-9, 1e6
_EASIER, _HARDER = 0.1, 10.0
_SETTLED = 1e-5  # relative decrease of the cost by the last step
_BEND = 0.6  # lower bound of the weight: distant errors would make steps too long
_NOTHING = 1e-12  # on the diagonal, for a parameter without residuals: it stays fixed


def least_squares_steps(
    error: Callable[[Floats], Floats],
    slope: Callable[[Floats], "scipy.sparse.csr_matrix"],
    columns: int,
    robust: int,
    most_steps: int,
) -> Floats:
    """x (columns,) at which the errors (N,) are least, from 0 on; error in standard deviations, slope (N,columns).

    The loss of the first `robust` errors is soft l1, 2 (sqrt(1 + e^2) - 1).
    """
    x = np.zeros(columns)
    e = error(x)
    cost = _cost(e, robust)
    damping = _DAMPING
    for _ in range(most_steps):
        weight = _weights(e, robust)
        # the loss has less curvature than its weights where errors are usual
        bend = np.maximum(weight**3, _BEND * weight)
        J = slope(x)
        down = -(J.T @ (weight * e))
        normal = (J.T.multiply(bend).tocsr() @ J).tocsc()
        while True:
            trial = x + _solve_damped(normal, down, damping)
            trial_e = error(trial)
            trial_cost = _cost(trial_e, robust)
            if trial_cost < cost or damping > _MOST_DAMPING:
                break
            damping *= _HARDER
        if not trial_cost < cost:
            break
        gain = (cost - trial_cost) / cost
        x, e, cost = trial, trial_e, trial_cost
        damping = max(_LEAST_DAMPING, _EASIER * damping)
        if gain < _SETTLED:
            break
    return x


def _cost(e: Floats, robust: int) -> float:
    square = e * e
    near = 2.0 * (np.sqrt(1.0 + square[:robust]) - 1.0)
    return float(near.sum() + square[robust:].sum())


def _weights(e: Floats, robust: int) -> Floats:
    out = np.ones(len(e))
    out[:robust] = 1.0 / np.sqrt(1.0 + np.square(e[:robust]))
    return out


def _solve_damped(normal: "scipy.sparse.csc_matrix", down: Floats, damping: float) -> Floats:
    diagonal = normal.diagonal()
    stiff = normal + scipy.sparse.diags_array(damping * diagonal + _NOTHING, format="csc")
    factors = scipy.sparse.linalg.splu(
        stiff.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    x: Floats = factors.solve(down)
    return x
