"""Distance maps are exact, truncated where asked, and name the nearest sample."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.published.wang2011.distance_maps import distance_maps
from mocapd.types import Bytes
from tests.published.wang2011 import naive


def blobs(h: int, w: int, seed: int) -> Bytes:
    """Rectangles of some of the colours on nothing."""
    rng = np.random.default_rng(seed)
    ids = np.zeros((h, w), dtype=np.uint8)
    for _ in range(12):
        y, x = rng.integers(0, h), rng.integers(0, w)
        ids[y : y + rng.integers(1, 8), x : x + rng.integers(1, 8)] = rng.integers(0, 9)
    return ids


@settings(max_examples=30)
@given(
    st.integers(1, 24), st.integers(1, 24), st.integers(0, 10_000), st.sampled_from([3.5, 9.0, 1e4])
)
def test_distances_are_those_of_the_nearest_sample(
    h: int, w: int, seed: int, limit_px: float
) -> None:
    ids = blobs(h, w, seed)
    distance_px, _ = distance_maps(ids, limit_px)
    np.testing.assert_allclose(distance_px, naive.distance_maps(ids, limit_px), atol=1e-4)


@pytest.mark.parametrize("limit_px", [6.0, 1e4])
def test_the_nearest_sample_is_where_it_says(limit_px: float) -> None:
    ids = blobs(30, 40, 7)
    distance, nearest_yx = distance_maps(ids, limit_px)
    k, y, x = np.nonzero(distance < limit_px)
    ny, nx = nearest_yx[k, y, x].T
    assert (ids[ny, nx] == k + 1).all()
    np.testing.assert_allclose(np.hypot(y - ny, x - nx), distance[k, y, x], atol=1e-4)
    assert (nearest_yx[distance >= limit_px] == -1).all()


def test_of_an_absent_colour_all_is_far() -> None:
    distance_px, nearest_yx = distance_maps(np.zeros((30, 40), dtype=np.uint8), 12.0)
    assert (distance_px == 12.0).all()
    assert (nearest_yx == -1).all()
