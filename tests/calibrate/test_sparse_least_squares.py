"""The least squares of the joint solution, against scipy's."""

import numpy as np
import pytest
import scipy

from mocapd.calibrate.extrinsics.sparse_least_squares import least_squares_steps
from mocapd.types import Floats

_T = np.linspace(0.0, 3.0, 60)
_SEEN = 2.0 * np.exp(-0.7 * _T) + 0.3 + 0.02 * np.sin(40.0 * _T)


def error(x: Floats) -> Floats:
    """A curve through points, in standard deviations; the last parameter acts on nothing."""
    out: Floats = (x[0] * np.exp(-x[1] * _T) + x[2] - _SEEN) / 0.02
    return out


def slope(x: Floats) -> "scipy.sparse.csr_matrix":
    falling = np.exp(-x[1] * _T)
    columns = [falling, -x[0] * _T * falling, np.ones_like(_T), np.zeros_like(_T)]
    return scipy.sparse.csr_matrix(np.column_stack(columns) / 0.02)


@pytest.mark.parametrize("robust", [0, len(_T)])
def test_it_ends_where_scipy_does(robust: int) -> None:
    loss = "soft_l1" if robust else "linear"
    wanted = scipy.optimize.least_squares(error, np.zeros(3) + 0.1, loss=loss)
    found = least_squares_steps(error, slope, 4, robust, 60)
    np.testing.assert_allclose(found[:3], wanted.x, atol=2e-3)
    assert found[3] == 0.0


def test_rows_that_are_not_robust_hold_against_outliers() -> None:
    """Ten corners that are far off against one prior: where the sum of the losses is least."""

    def off(x: Floats) -> Floats:
        return np.append(x[0] - np.full(10, 50.0), x[0] / 0.1)

    J = scipy.sparse.csr_matrix(np.append(np.ones(10), 10.0)[:, None])
    found = least_squares_steps(off, lambda x: J, 1, 10, 30)
    # each corner pulls by 1 at most, the prior back by 100 x
    assert found[0] == pytest.approx(0.1, abs=1e-3)
