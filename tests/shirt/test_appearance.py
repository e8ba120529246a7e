"""What is learned of the shirt's looks, and how a new light is followed."""

import numpy as np
import pytest

from mocapd.shirt.segmentation import shirt_appearance as looks
from mocapd.shirt.segmentation.shirt_appearance import ShirtAppearance
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats

MODEL_MEAN = standard_shirt().srgb / 255.0
MODEL_COVARIANCE = np.tile(0.04**2 * np.eye(3), (10, 1, 1))
COLD_LAMP = np.array([[0.75, 0.04, 0.0], [0.03, 0.9, 0.05], [0.0, 0.06, 1.25]])  # on RGB


def statistics(light: Floats, counts: Floats) -> Floats:
    """What `colour_statistics` would add up in a light (3,3 on RGB)."""
    bgr = (MODEL_MEAN @ light.T)[:, ::-1]
    return np.concatenate([counts[:, None], counts[:, None] * bgr], axis=1)


def mean_of(appearance: ShirtAppearance) -> Floats:
    return looks.gaussians(appearance, MODEL_MEAN, MODEL_COVARIANCE, 0.04, 0.015, 0.25)[0]


def test_whitened_length_is_the_mahalanobis_distance() -> None:
    rng = np.random.default_rng(0)
    spread = rng.normal(0.0, 0.1, (10, 3, 3))
    covariance = spread @ spread.transpose(0, 2, 1) + 0.02**2 * np.eye(3)
    A = looks.whitening(MODEL_MEAN, covariance)
    for bgr in rng.integers(0, 256, (20, 3)):
        got = np.linalg.norm(A @ np.append(bgr, 1.0), axis=1)
        off = bgr / 255.0 - MODEL_MEAN
        wanted = np.sqrt(np.einsum("ki,kij,kj->k", off, np.linalg.inv(covariance), off))
        np.testing.assert_allclose(got, wanted, rtol=1e-5)  # single precision


def test_a_fresh_appearance_is_the_model_in_the_strokes_light() -> None:
    start = looks.fresh(np.linalg.inv(COLD_LAMP))
    np.testing.assert_allclose(mean_of(start), (MODEL_MEAN @ COLD_LAMP.T)[:, ::-1], atol=1e-12)


def test_learning_converges_to_what_is_seen_and_remembers_what_is_not() -> None:
    counts = np.full(10, 300.0)
    counts[[2, 5]] = 3.0  # too few to count
    start = looks.fresh(np.eye(3))
    learned = start
    for _ in range(200):
        learned = looks.learn(learned, statistics(COLD_LAMP, counts), 1 / 30, 0.7)
    # 300 pixels against a prior of 60: five sixths of the way
    towards = (mean_of(learned) - mean_of(start)) * 360.0 / 300.0 + mean_of(start)
    wanted = (MODEL_MEAN @ COLD_LAMP.T)[:, ::-1]
    seen = counts > 100
    np.testing.assert_allclose(towards[seen], wanted[seen], atol=2e-3)
    np.testing.assert_array_equal(mean_of(learned)[~seen], mean_of(start)[~seen])


def test_white_balance_is_found_again_from_learned_colours() -> None:
    learned = ShirtAppearance(np.eye(3), statistics(COLD_LAMP, np.full(10, 300.0)))
    W_found = looks.white_balance(learned, MODEL_MEAN, ridge=1e-6)
    np.testing.assert_allclose(W_found @ COLD_LAMP, np.eye(3), atol=1e-3)
    few = statistics(COLD_LAMP, np.where(np.arange(10) < 2, 300.0, 0.0))
    np.testing.assert_array_equal(
        looks.white_balance(ShirtAppearance(np.eye(3), few), MODEL_MEAN), np.eye(3)
    )


@pytest.mark.parametrize("gain", [0.4, 1.7])
def test_transported_follows_a_change_of_brightness(gain: float) -> None:
    """A plain change of brightness is what it is drawn towards, so nothing is left over."""
    before = ShirtAppearance(np.eye(3), statistics(np.eye(3), np.full(10, 300.0)))
    after = looks.adapt_to_light(
        before, statistics(gain * np.eye(3), np.full(10, 150.0)), MODEL_MEAN
    )
    np.testing.assert_allclose(mean_of(after), gain * MODEL_MEAN[:, ::-1], atol=1e-9)


@pytest.mark.parametrize("seen", [range(10), range(5)])
def test_transported_follows_a_change_of_colour(seen: range) -> None:
    """Drawn to plain brightness by a ridge, it comes most of the way; colours not seen come along."""
    counts = np.where(np.isin(np.arange(10), list(seen)), 200.0, 0.0)
    before = ShirtAppearance(np.eye(3), statistics(np.eye(3), np.full(10, 300.0)))
    after = looks.adapt_to_light(before, statistics(COLD_LAMP, counts), MODEL_MEAN)
    wanted = (MODEL_MEAN @ COLD_LAMP.T)[:, ::-1]
    off_before = np.abs(mean_of(before) - wanted).max(axis=1)
    off_after = np.abs(mean_of(after) - wanted).max(axis=1)
    assert off_before.max() > 0.15
    assert (off_after < 0.5 * off_before).all()
    assert off_after[list(seen)].max() < 0.03


def test_transported_believes_no_lamp_that_cannot_be() -> None:
    """Colours that changed places: the pose is wrong, not the light."""
    before = ShirtAppearance(np.eye(3), statistics(np.eye(3), np.full(10, 300.0)))
    wrong = statistics(np.eye(3)[[1, 0, 2]], np.full(10, 200.0))
    assert looks.adapt_to_light(before, wrong, MODEL_MEAN) is before
    nothing = np.zeros((10, 4))
    assert looks.adapt_to_light(before, nothing, MODEL_MEAN) is before
