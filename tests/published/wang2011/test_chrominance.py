"""Histogram search: bins, uniformity and the weighted mean of §4."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.published.wang2011.chrominance import (
    HistogramParams,
    chrominance_bins,
    histogram_search,
    weighted_mean,
)
from mocapd.published.wang2011.histogram_kernels import (
    BINS,
    NO_BIN,
    integral_histogram,
    uniformity,
)
from mocapd.types import Bytes
from tests.published.wang2011 import naive
from tests.shirt.example_colours import MEANS

EVERYWHERE = np.ones((1, 1), dtype=np.uint8)


def bins_of(pixels: Bytes) -> Bytes:
    bins: Bytes = chrominance_bins(pixels[None], EVERYWHERE, 31, 1, 3)[0]
    return bins


def test_the_bins_are_the_hundred_triangles() -> None:
    rng = np.random.default_rng(0)
    pixels = rng.integers(1, 256, (20_000, 3)).astype(np.uint8)
    pixels[:3000, 0] = 0
    pixels[2000:5000, 1] = 0
    pixels[4000:7000, 2] //= 16
    pixels = pixels[pixels.sum(axis=1) >= 3]
    bins = bins_of(pixels)
    triangles = [naive.chrominance_triangle(pixel) for pixel in pixels]
    inside = [i for i, cell in enumerate(triangles) if sum(cell) in (8, 9)]  # not on a border
    pairs = {(triangles[i], int(bins[i])) for i in inside}
    assert len(pairs) == len({cell for cell, _ in pairs}) == len({k for _, k in pairs})
    assert len(pairs) > 90
    assert bins.max() < BINS


@given(st.lists(st.integers(1, 12), min_size=3, max_size=3), st.integers(2, 20))
def test_brightness_does_not_change_a_bin(bgr: list[int], gain: int) -> None:
    dim = np.array([bgr], dtype=np.uint8)
    assert bins_of(dim) == bins_of(dim * np.uint8(gain))


def test_dark_pixels_are_grey_and_background_is_nothing() -> None:
    pixels = np.array([[[0, 0, 9], [0, 0, 0], [120, 120, 120], [0, 0, 200]]], dtype=np.uint8)
    mask = np.array([[255, 255, 255, 0]], dtype=np.uint8)
    out = chrominance_bins(pixels, mask, 0, 1, 48)
    assert out[0, 0] == out[0, 1] == out[0, 2]
    assert out[0, 3] == NO_BIN


@pytest.mark.parametrize("cap", [0.1, 0.03])
def test_uniformity_is_the_capped_sum_of_the_window(cap: float) -> None:
    rng = np.random.default_rng(1)
    bins = rng.choice(
        np.array([0, 1, 2, 3, 5, 8, 50, 98, 99, NO_BIN], dtype=np.uint8),
        size=(14, 18),
        p=[0.3, 0.2, 0.1, 0.1, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05],
    )
    integral = np.empty((15, 19, BINS), dtype=np.uint16)
    integral_histogram(bins, integral)
    radii = np.array([1, 3, 6])
    u = np.empty((3, 14, 18), dtype=np.float32)
    uniformity(integral, radii, cap, u)
    for s, radius in enumerate(radii):
        np.testing.assert_allclose(u[s], naive.uniformity(bins, int(radius), cap), atol=1e-5)


def test_the_mean_is_weighted_as_in_the_paper() -> None:
    u = np.random.default_rng(2).random((2, 5, 7)).astype(np.float32)
    radii = np.array([1, 4])
    found = weighted_mean(u, radii, 6, 0.1)
    weights = np.exp(-((u - u.max()) ** 2) / (0.1 * u.max()) ** 2)
    s, y, x = np.meshgrid(
        (2 * radii + 1) * 6, np.arange(5) * 6 + 3, np.arange(7) * 6 + 3, indexing="ij"
    )
    assert found.u_max == pytest.approx(u.max())
    for value, grid in ((found.x_px, x), (found.y_px, y), (found.s_px, s)):
        assert value == pytest.approx((weights * grid).sum() / weights.sum(), rel=1e-5)


def room_with_shirt(x: int, y: int) -> Bytes:
    """A beige room, and a motley shirt of 120 px centred at x, y."""
    rng = np.random.default_rng(3)
    image = np.full((480, 640, 3), (150, 180, 200), dtype=np.float64)
    patches = rng.permutation(np.tile(MEANS, (2, 1)))[:16].reshape(4, 4, 3)
    image[y - 60 : y + 60, x - 60 : x + 60] = (
        255 * np.kron(patches, np.ones((30, 30, 1)))[..., ::-1]
    )
    image += rng.normal(0.0, 4.0, image.shape)
    pixels: Bytes = np.clip(image, 0, 255).astype(np.uint8)
    return pixels


@pytest.mark.parametrize(("x", "y"), [(150, 150), (480, 300), (80, 400)])
def test_the_shirt_is_found(x: int, y: int) -> None:
    found = histogram_search(
        room_with_shirt(x, y), np.ones((1, 1), np.uint8), 31, HistogramParams()
    )
    assert np.hypot(found.x_px - x, found.y_px - y) < 20
    assert 54 <= found.s_px <= 200
    assert found.u_max > 0.6


def test_a_mask_rules_out_a_colourful_background() -> None:
    image = room_with_shirt(150, 150)
    image[200:440, 400:620] = np.random.default_rng(4).integers(0, 256, (240, 220, 3))
    mask = np.zeros((120, 160), dtype=np.uint8)
    mask[20:55, 20:55] = 255
    found = histogram_search(image, mask, 2, HistogramParams())
    assert np.hypot(found.x_px - 150, found.y_px - 150) < 20


def test_nothing_in_the_foreground_is_no_colour() -> None:
    found = histogram_search(
        np.full((240, 320, 3), 90, dtype=np.uint8),
        np.zeros((60, 80), np.uint8),
        2,
        HistogramParams(radii=(2, 4)),
    )
    assert found.u_max == 0.0
    assert abs(found.x_px - 160) < 6
    assert abs(found.y_px - 120) < 6
