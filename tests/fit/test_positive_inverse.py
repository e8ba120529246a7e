"""The inverse of a symmetric positive definite matrix, symmetric to the last bit, and its linear systems: as numpy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.fit.positive_inverse import positive_inverse
from mocapd.fit.positive_inverse_kernels import solve_positive


@given(st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_it_is_the_inverse_and_the_matrix_stays_as_it_is(size: int, seed: int) -> None:
    factors = np.random.default_rng(seed).normal(0.0, 1.0, (size + 5, size))
    matrix = factors.T @ factors + 0.1 * np.eye(size)
    before = matrix.copy()
    inverse = positive_inverse(matrix)
    np.testing.assert_array_equal(matrix, before)
    np.testing.assert_array_equal(inverse, inverse.T)
    np.testing.assert_allclose(inverse @ matrix, np.eye(size), atol=1e-9)


def test_what_is_just_not_positive_is_inverted_all_the_same() -> None:
    matrix = np.diag([1.0, 2.0, -1e-18])
    np.testing.assert_allclose(np.diag(positive_inverse(matrix)), [1.0, 0.5, -1e18])


def test_a_singular_matrix_is_an_error() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        positive_inverse(np.zeros((3, 3)))


@given(st.integers(1, 60), st.integers(0, 2**32 - 1))
def test_a_system_is_solved(size: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    factors, wanted = rng.normal(0.0, 1.0, (size + 5, size)), rng.normal(0.0, 1.0, size)
    matrix = factors.T @ factors + 0.1 * np.eye(size)
    solved = matrix @ wanted
    solve_positive(np.tril(matrix), solved)
    np.testing.assert_allclose(solved, wanted, atol=1e-9)


def test_an_unknown_that_nothing_says_anything_of_stays_where_it_is() -> None:
    solved = np.array([2.0, 0.0, 6.0])
    solve_positive(np.diag([1.0, 0.0, 2.0]), solved)
    np.testing.assert_array_equal(solved, [2.0, 0.0, 3.0])
