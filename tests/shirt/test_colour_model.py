"""The colour model recovers the colours that were painted, sloppy strokes or not."""

import numpy as np
import pytest

from mocapd.errors import ConfigError, InputError
from mocapd.shirt.colour.colour_model import MIN_STANDARD_DEVIATION, fit_colour_model
from mocapd.shirt.colour.strokes import stroke_colours, stroke_means
from mocapd.types import Bytes
from tests.shirt.example_colours import MEANS, NAMES, example_model

PATCH = 24


def painted_shirt(seed: int = 0, sloppiness: int = 0) -> tuple[Bytes, Bytes]:
    """Ten noisy patches side by side, a stroke on each that runs `sloppiness` px into the next."""
    rng = np.random.default_rng(seed)
    image = np.zeros((PATCH, 10 * PATCH, 3))
    strokes = np.zeros((PATCH, 10 * PATCH), dtype=np.uint8)
    for k in range(10):
        image[:, k * PATCH : (k + 1) * PATCH] = MEANS[k, ::-1]
        first = k * PATCH + 2 + sloppiness
        strokes[4 : PATCH - 4, first : first + PATCH - 4] = k + 1
    image += rng.normal(0.0, 0.03, image.shape)
    return (np.clip(image, 0.0, 1.0) * 255).round().astype(np.uint8), strokes


def test_the_means_and_spreads_are_those_painted() -> None:
    (image, strokes), (other_image, other_strokes) = painted_shirt(0), painted_shirt(1)
    model = fit_colour_model([image, other_image], [strokes, other_strokes], NAMES)
    assert np.abs(model.mean - MEANS).max() < 0.01
    spreads = np.sqrt(np.linalg.eigvalsh(model.covariance))
    assert spreads.min() > MIN_STANDARD_DEVIATION * 0.999
    assert spreads.max() < 0.04


def test_strokes_across_a_border_hardly_move_the_colours() -> None:
    image, strokes = painted_shirt(sloppiness=6)  # 4 of 20 columns lie on the neighbour
    model = fit_colour_model([image], [strokes], NAMES)
    assert np.abs(model.mean - MEANS).max() < 0.02
    assert np.sqrt(np.linalg.eigvalsh(model.covariance)).max() < 0.05


def test_a_missing_colour_is_named() -> None:
    image, strokes = painted_shirt()
    strokes[strokes == 8] = 0
    with pytest.raises(ConfigError, match=r"violet \(id 8: 0 pixels\)"):
        fit_colour_model([image], [strokes], NAMES)


def test_flat_colours_keep_a_usable_covariance() -> None:
    image, strokes = painted_shirt()
    for k in range(1, 11):
        image[strokes == k] = 10 * k
    model = fit_colour_model([image], [strokes], NAMES)
    assert np.sqrt(np.linalg.eigvalsh(model.covariance)).min() > MIN_STANDARD_DEVIATION * 0.999


def test_stroke_means_count_only_what_is_drawn() -> None:
    image, strokes = painted_shirt()
    strokes[strokes == 3] = 0
    means, counts = stroke_means(image, strokes)
    assert counts[2] == 0
    assert (counts[[0, 1, 3]] > 200).all()
    assert np.abs(means[0] - MEANS[0]).max() < 0.02


def test_strokes_of_another_size_are_refused() -> None:
    image, strokes = painted_shirt()
    with pytest.raises(InputError):
        stroke_colours(image, strokes[1:])


def test_tolerance_brings_shaded_cloth_nearer() -> None:
    model = example_model()
    shaded = model.mean * 0.6
    plain, tolerant = (
        np.einsum(
            "ki,kij,kj->k",
            shaded - model.mean,
            np.linalg.inv(variant.tolerant_covariance),
            shaded - model.mean,
        )
        for variant in (model, model.tolerating())
    )
    assert (tolerant < plain).all()
    assert np.sqrt(tolerant).max() < 0.4 / 0.25 + 1e-9
    paper = model.tolerating().tolerating(0.0, 0.0)
    assert (paper.tolerant_covariance == model.covariance).all()
