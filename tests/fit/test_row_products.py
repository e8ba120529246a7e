"""Products of rows, against all of them multiplied."""

import numpy as np
import pytest

from mocapd.fit.terms.triangle_rows_kernels import add_products


@pytest.mark.parametrize("used", [0, 1, 7, 20])
def test_columns_without_a_value_change_nothing(used: int) -> None:
    rng = np.random.default_rng(used)
    rows = rng.normal(size=(30, 20))
    rows[:, rng.permutation(20)[used:]] = 0.0
    before = np.cov(rng.normal(size=(20, 30)))
    got = before.copy()
    add_products(rows, got)
    np.testing.assert_allclose(got, before + rows.T @ rows, atol=1e-12)
    empty = ~rows.any(axis=0)
    np.testing.assert_array_equal(got[empty], before[empty])
