"""Finding the shirt in a picture of colour ids: the most even window, by brute force and by kernel."""

import numpy as np
import pytest

from mocapd.shirt.segmentation.segmentation_kernels import (
    CAP,
    CELL,
    find_shirt,
    suppress_background,
)
from mocapd.types import Bytes, Ints

H, W = 96, 128
SIZES = np.array([4, 7, 12])


def confetti(seed: int, at: tuple[int, int], side: int, rest: float = 0.02) -> Bytes:
    """All ten colours within a square, some colour here and there elsewhere."""
    rng = np.random.default_rng(seed)
    ids = (rng.integers(1, 11, (H, W)) * (rng.random((H, W)) < rest)).astype(np.uint8)
    x, y = at
    ids[y : y + side, x : x + side] = rng.integers(1, 11, (side, side))
    return ids


def naive(ids: Bytes, sizes: Ints) -> tuple[int, int, int, int, float]:
    """Counts every window anew; the first of equals."""
    best = (0, 0, 0, 0, -1.0)
    for s in sizes:
        side = int(s) * CELL
        step = max(1, int(s) // 6) * CELL
        for y in range(0, H - side + 1, step):
            for x in range(0, W - side + 1, step):
                counts = np.bincount(ids[y : y + side, x : x + side].ravel(), minlength=11)[1:]
                even = np.minimum(counts / side**2, CAP).sum() / (10 * CAP)
                if even > best[4] + 1e-12:
                    best = (x, y, x + side, y + side, float(even))
    return best


@pytest.mark.parametrize("seed", range(3))
def test_the_window_is_that_of_the_naive_twin(seed: int) -> None:
    ids = confetti(seed, (40, 24), 28)
    got, wanted = find_shirt(ids, SIZES), naive(ids, SIZES)
    assert got[4] == pytest.approx(wanted[4])
    assert got[:4] == wanted[:4]


def test_it_lies_on_the_colours() -> None:
    x0, y0, x1, y1, evenness = find_shirt(confetti(0, (60, 40), 32), SIZES)
    assert 60 <= 0.5 * (x0 + x1) <= 92
    assert 40 <= 0.5 * (y0 + y1) <= 72
    assert evenness > 0.9


def test_one_colour_alone_is_no_shirt() -> None:
    """A large red sofa counts no more than a tenth."""
    ids = np.zeros((H, W), np.uint8)
    ids[20:80, 20:100] = 1
    assert find_shirt(ids, SIZES)[4] == pytest.approx(0.1)
    assert find_shirt(np.zeros((H, W), np.uint8), SIZES)[4] == 0.0


def test_windows_larger_than_the_picture_are_left_out() -> None:
    ids = confetti(1, (0, 0), 16)[:20, :20].copy()
    *window, evenness = find_shirt(ids, np.array([4, 40]))
    assert window == [0, 0, 16, 16]
    assert evenness > 0.8
    assert find_shirt(ids, np.array([40]))[4] < 0.0  # none fits: never found


def test_known_background_is_no_shirt() -> None:
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 256, (H, W, 3), dtype=np.uint8)
    mean = (picture + rng.uniform(-20, 20, picture.shape)).astype(np.float32)
    age = rng.integers(0, 12, (H, W)).astype(np.uint8)
    ids = rng.integers(0, 11, (H, W)).astype(np.uint8)
    before = ids.copy()
    suppress_background(picture, mean, age, 0.05, ids)
    alike = (np.abs(picture.astype(np.float32) - mean) < 0.05 * 255).all(axis=2) & (age >= 6)
    np.testing.assert_array_equal(ids, np.where(alike, 0, before))
    assert 0.05 < alike.mean() < 0.6
