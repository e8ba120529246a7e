"""White balance: exact where the colours determine it, the prior where they do not."""

import numpy as np
import pytest

from mocapd.shirt.colour.white_balance import (
    REFERENCE_CAPACITY,
    frobenius_distance,
    remember_illumination,
    shade_precision,
    solve_white_balance,
)
from tests.shirt.example_colours import MEANS, example_model, example_white_balance

TRUE_W = example_white_balance()
IMAGE = MEANS @ np.linalg.inv(TRUE_W).T
ONES = np.ones(10)


def test_ten_colours_give_the_papers_solution() -> None:
    noisy = IMAGE + np.random.default_rng(0).normal(0.0, 0.02, IMAGE.shape)
    W = solve_white_balance(noisy, MEANS, ONES, ridge=0.0)
    expected = np.linalg.lstsq(noisy, MEANS, rcond=None)[0].T
    np.testing.assert_allclose(W, expected, atol=1e-9)


@pytest.mark.parametrize("prior", [None, np.eye(3)])
def test_the_ridge_hardly_matters_with_ten_colours(prior: np.ndarray | None) -> None:
    W = solve_white_balance(IMAGE, MEANS, ONES, prior)
    assert np.abs(W - TRUE_W).max() < 0.05
    precise = solve_white_balance(
        IMAGE, MEANS, ONES, prior, precision=shade_precision(example_model())
    )
    assert np.abs(precise - TRUE_W).max() < 0.1


def test_weights_leave_colours_out() -> None:
    wrong = IMAGE.copy()
    wrong[4] = 0.9
    weights = ONES.copy()
    weights[4] = 0.0
    np.testing.assert_allclose(
        solve_white_balance(wrong, MEANS, weights, ridge=0.0), TRUE_W, atol=1e-9
    )
    np.testing.assert_allclose(
        solve_white_balance(IMAGE, MEANS, 1000.0 * ONES), solve_white_balance(IMAGE, MEANS, ONES)
    )


@pytest.mark.parametrize("visible", [0, 1, 2])
def test_few_colours_stay_at_the_prior_where_they_say_nothing(visible: int) -> None:
    weights = np.zeros(10)
    weights[:visible] = 100.0
    prior = TRUE_W + 0.1
    W = solve_white_balance(IMAGE, MEANS, weights, prior)
    unseen = np.linalg.svd(IMAGE[:visible])[2][visible:]  # directions no visible colour has
    np.testing.assert_allclose(W @ unseen.T, prior @ unseen.T, atol=1e-9)
    assert np.abs(W @ IMAGE[:visible].T - MEANS[:visible].T).max(initial=0.0) < 0.03


def test_nothing_in_view_and_no_prior_is_no_change() -> None:
    np.testing.assert_allclose(solve_white_balance(IMAGE, MEANS, np.zeros(10)), np.eye(3))


def test_a_shaded_patch_moves_a_shade_tolerant_solution_less() -> None:
    shaded = IMAGE.copy()
    shaded[2] *= 0.5
    precision = shade_precision(example_model())
    plain = solve_white_balance(shaded, MEANS, ONES, TRUE_W)
    tolerant = solve_white_balance(shaded, MEANS, ONES, TRUE_W, precision=precision)
    assert frobenius_distance(tolerant, TRUE_W) < 0.5 * frobenius_distance(plain, TRUE_W)


def test_an_illumination_is_remembered_once() -> None:
    known = remember_illumination((), np.eye(3))
    assert len(known) == 1
    assert remember_illumination(known, np.eye(3) * 1.2) is known  # 0.35 away
    assert len(remember_illumination(known, np.eye(3) * 1.5)) == 2


def test_memory_is_bounded_and_keeps_the_first() -> None:
    references: tuple[np.ndarray, ...] = ()
    for gain in range(1, 3 * REFERENCE_CAPACITY):
        references = remember_illumination(references, np.eye(3) * gain)
    assert len(references) == REFERENCE_CAPACITY
    assert references[0][0, 0] == 1
    assert references[-1][0, 0] == 3 * REFERENCE_CAPACITY - 1
