"""Classification kernels, exact and by table, against the paper's formulas written plainly."""

import numpy as np
import pytest

from mocapd.published.wang2011.classify_kernels import classify
from mocapd.published.wang2011.segmenter import mean_colours
from mocapd.shirt.colour.colour_model import fold
from mocapd.shirt.colour.colour_tables import colour_table
from mocapd.shirt.colour.lut_kernels import classify_by_table
from mocapd.types import Bytes
from tests.published.wang2011 import naive
from tests.shirt.example_colours import MEANS, example_model, example_white_balance

MODEL = example_model()
TOLERANT = MODEL.tolerating()
W = example_white_balance()
NO_DISTANCE = np.zeros((10, 48, 64), dtype=np.float32)


def picture(seed: int = 0, h: int = 48, w: int = 64) -> Bytes:
    """Half of it shirt colours with noise, half of it anything; read-only like a captured frame."""
    rng = np.random.default_rng(seed)
    colours = MEANS[rng.integers(0, 10, (h, w))] @ np.linalg.inv(W).T
    colours += rng.normal(0.0, 0.05, colours.shape)
    anything = rng.random((h, w, 3))
    image = np.where(rng.random((h, w, 1)) < 0.5, colours, anything)
    pixels = (np.clip(image, 0.0, 1.0) * 255).round().astype(np.uint8)[..., ::-1].copy()
    pixels.flags.writeable = False
    return pixels


def half_mask(shape: tuple[int, int], seed: int = 1) -> Bytes:
    return (np.random.default_rng(seed).random(shape) < 0.7).astype(np.uint8) * 255


@pytest.mark.parametrize("model", [MODEL, TOLERANT])
@pytest.mark.parametrize("threshold", [1.5, 3.0])
def test_exact_classification_is_the_formula(model: object, threshold: float) -> None:
    pixels, mask = picture(), half_mask((48, 64))
    whitening = fold(model, W)  # type: ignore[arg-type]
    out = np.full((48, 64), 77, dtype=np.uint8)
    folded = whitening.upper, whitening.offset, NO_DISTANCE, 0.0
    counts = classify(pixels, mask, 0, *folded, threshold, 0, 0, 1, out)
    costs = naive.mahalanobis(pixels, W, model)  # type: ignore[arg-type]
    expected = naive.classify(costs, threshold, mask)
    near_a_tie = np.sort(costs, axis=2)[..., 1] - costs.min(axis=2) < 1e-4
    on_the_limit = np.abs(costs.min(axis=2) - threshold) < 1e-4
    decided = ~(near_a_tie | on_the_limit)
    assert (out[decided] == expected[decided]).all()
    assert counts == ((out > 0).sum(), (mask > 0).sum())


@pytest.mark.parametrize("stride", [1, 2])
def test_a_region_is_that_part_of_the_frame(stride: int) -> None:
    pixels, coarse = picture(), half_mask((24, 32))
    whitening = fold(MODEL, W)
    folded = whitening.upper, whitening.offset, NO_DISTANCE, 0.0
    whole = np.zeros((48, 64), dtype=np.uint8)
    classify(pixels, coarse, 1, *folded, 3.0, 0, 0, 1, whole)
    part = np.zeros((10, 12), dtype=np.uint8)
    classify(pixels, coarse, 1, *folded, 3.0, 7, 5, stride, part)
    assert (part == whole[5 : 5 + 10 * stride : stride, 7 : 7 + 12 * stride : stride]).all()
    table = colour_table(MODEL, W, 3.0)
    classify_by_table(pixels, coarse, 1, table, 0, 0, 1, whole)
    classify_by_table(pixels, coarse, 1, table, 7, 5, stride, part)
    assert (part == whole[5 : 5 + 10 * stride : stride, 7 : 7 + 12 * stride : stride]).all()


def cell_centres() -> Bytes:
    """The bytes nearest the middles of all cells, as a picture (128,256,3) BGR in table order."""
    cell = np.arange(32**3)
    middles = np.stack([cell & 31, (cell >> 5) & 31, cell >> 10], axis=1) * 8 + 3
    return middles.reshape(128, 256, 3).astype(np.uint8)


@pytest.mark.parametrize(("model", "threshold"), [(MODEL, 3.0), (TOLERANT, 1.7)])
def test_a_table_holds_the_nearest_colours_of_the_middles_of_the_cells(
    model: object, threshold: float
) -> None:
    table = colour_table(model, W, threshold)  # type: ignore[arg-type]
    centres = cell_centres().astype(np.float64) + 0.5
    costs = naive.mahalanobis(centres, W, model).reshape(-1, 10)  # type: ignore[arg-type]
    expected = naive.classify(costs[None], threshold, np.ones((1, 32**3), dtype=np.uint8))[0]
    clear = np.abs(costs.min(axis=1) - threshold) > 1e-3
    clear &= np.diff(np.sort(costs, axis=1)[:, :2], axis=1)[:, 0] > 1e-3
    assert (table == expected)[clear].all()


def test_table_classification_looks_the_cells_up() -> None:
    pixels, mask = picture(), half_mask((48, 64))
    table = colour_table(MODEL, W, 3.0)
    out = np.full((48, 64), 77, dtype=np.uint8)
    counts = classify_by_table(pixels, mask, 0, table, 0, 0, 1, out)
    b, g, r = np.moveaxis(pixels.astype(int) >> 3, 2, 0)
    expected = np.where(mask > 0, table[(r << 10) | (g << 5) | b], 0)
    assert (out == expected).all()
    assert counts == ((out > 0).sum(), (mask > 0).sum())


@pytest.mark.parametrize("threshold", [2.0, 5.0])
def test_the_prior_adds_its_cost(threshold: float) -> None:
    pixels, mask = picture(2), half_mask((48, 64))
    distance = np.random.default_rng(3).uniform(0.0, 80.0, (10, 48, 64)).astype(np.float32)
    per_px = 6.0 / 150.0
    whitening = fold(MODEL, W)
    out = np.zeros((48, 64), dtype=np.uint8)
    folded = whitening.upper, whitening.offset, distance, per_px
    counts = classify(pixels, mask, 0, *folded, threshold, 0, 0, 1, out)
    costs = naive.mahalanobis(pixels, W, MODEL) + per_px * np.moveaxis(distance, 0, 2)
    clear = np.abs(costs.min(axis=2) - threshold) > 1e-3
    clear &= np.diff(np.sort(costs, axis=2)[..., :2], axis=2)[..., 0] > 1e-3
    assert (out == naive.classify(costs, threshold, mask))[clear].all()
    assert counts == ((out > 0).sum(), (mask > 0).sum())


def test_mean_colours_are_those_of_each_id() -> None:
    pixels = picture()[4:24, 3:28]
    ids = np.random.default_rng(6).integers(0, 8, (20, 25)).astype(np.uint8)
    means, counts = mean_colours(pixels, ids)
    for k in range(1, 11):
        assert counts[k - 1] == (ids == k).sum()
        of_id = pixels[ids == k].reshape(-1, 3)[:, ::-1] / 255.0
        np.testing.assert_allclose(means[k - 1], of_id.mean(axis=0) if len(of_id) else 0.0)
