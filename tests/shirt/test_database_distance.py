"""The map distance, the crop and the descriptor's index against slow, obvious twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.shirt.pose_database.idmap_crop_kernels import MARGIN, SIZE, crop_id_map, pack, unpack
from mocapd.shirt.pose_database.idmap_distance_kernels import (
    MISSING,
    squared_distances,
)
from mocapd.shirt.pose_database.idmap_index import nearest_exact
from mocapd.types import Bytes, Floats


def blobs(seed: int, size: int = SIZE, colours: int = 6) -> Bytes:
    """A map of a few coloured rectangles."""
    rng = np.random.default_rng(seed)
    out = np.zeros((size, size), np.uint8)
    for c in rng.choice(np.arange(1, 11), colours, replace=False):
        x, y = rng.integers(0, size - 8, 2)
        w, h = rng.integers(2, 8, 2)
        out[y : y + h, x : x + w] = c
    return out


def naive_one_way(a: Bytes, b: Bytes) -> float:
    costs = []
    for y, x in zip(*np.nonzero(a), strict=True):
        rows, columns = np.nonzero(b == a[y, x])
        gaps = (rows - y) ** 2 + (columns - x) ** 2
        costs.append(min(float(gaps.min()), MISSING) if len(gaps) else MISSING)
    if not costs:
        return 0.0 if not b.any() else MISSING
    return float(np.mean(costs))


def naive_distance(a: Bytes, b: Bytes) -> float:
    return naive_one_way(a, b) + naive_one_way(b, a)


def packed(maps: list[Bytes]) -> Bytes:
    out = np.zeros((len(maps), SIZE * SIZE // 2), np.uint8)
    for i, ids in enumerate(maps):
        pack(ids, out[i])
    return out


def nearest(query: Bytes, maps: list[Bytes], k: int) -> tuple[list[int], Floats]:
    best, distance = np.empty(k, np.int64), np.empty(k)
    nearest_exact(query, packed(maps), np.arange(len(maps)), best, distance)
    return best.tolist(), distance


@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_distance_equals_naive_twin(seed_a: int, seed_b: int) -> None:
    a, b = blobs(seed_a), blobs(seed_b)
    _, distance = nearest(a, [b], 1)
    assert distance[0] == pytest.approx(naive_distance(a, b), rel=1e-4)


def test_distance_transform_equals_naive_twin() -> None:
    ids = blobs(3)
    out = np.empty((11, SIZE, SIZE), np.float32)
    squared_distances(ids, out)
    y, x = np.mgrid[:SIZE, :SIZE]
    for c in range(1, 11):
        rows, columns = np.nonzero(ids == c)
        if len(rows) == 0:
            expected = np.full((SIZE, SIZE), MISSING)
        else:
            gaps = (y[..., None] - rows) ** 2 + (x[..., None] - columns) ** 2
            expected = np.minimum(gaps.min(axis=-1), MISSING)
        np.testing.assert_allclose(out[c], expected)


def test_pruned_search_finds_what_sorting_all_distances_finds() -> None:
    maps = [blobs(seed) for seed in range(60)]
    query = blobs(1000)
    best, distance = nearest(query, maps, 10)
    every = np.array([naive_distance(query, other) for other in maps])
    np.testing.assert_allclose(distance, np.sort(every)[:10], rtol=1e-4)
    np.testing.assert_allclose(every[best], distance, rtol=1e-4)


def test_distance_is_symmetric_zero_to_itself_and_small_for_a_shift() -> None:
    a, b = blobs(1), blobs(2)
    shifted = np.roll(a, 1, axis=1)
    assert nearest(a, [a], 1)[1][0] == 0.0
    assert nearest(a, [b], 1)[1][0] == pytest.approx(nearest(b, [a], 1)[1][0], rel=1e-5)
    assert nearest(a, [shifted], 1)[1][0] < 0.1 * nearest(a, [b], 1)[1][0]


def test_empty_maps_have_a_finite_distance() -> None:
    nothing, something = np.zeros((SIZE, SIZE), np.uint8), blobs(1)
    assert nearest(nothing, [nothing], 1)[1][0] == 0.0
    assert nearest(nothing, [something], 1)[1][0] == 2 * MISSING
    assert nearest(something, [nothing], 1)[1][0] == 2 * MISSING


def test_fewer_candidates_than_asked_for() -> None:
    best, _ = nearest(blobs(1), [blobs(1), blobs(2)], 5)
    assert best[:2] == [0, 1]
    assert best[2:] == [-1, -1, -1]


def test_packing_is_undone() -> None:
    ids = blobs(5, colours=10)
    out = np.empty_like(ids)
    unpack(packed([ids])[0], out)
    np.testing.assert_array_equal(out, ids)


def drawn(height: int, width: int) -> Bytes:
    """A body in two colours, 60 wide and 80 high, at x 50 and y 30."""
    ids = np.zeros((height, width), np.uint8)
    ids[30:70, 50:110] = 3
    ids[70:110, 50:110] = 7
    return ids


def test_crop_says_where_its_cells_are() -> None:
    ids = drawn(160, 200)
    small, scale, (x, y) = crop_id_map(ids)
    assert (x, y) == pytest.approx((79.5, 69.5), abs=1.0)
    assert scale * SIZE == pytest.approx(MARGIN * 80, rel=0.05)
    v, u = np.nonzero(small == 7)
    assert x + (u.mean() - 19.5) * scale == pytest.approx(79.5, abs=scale)
    assert y + (v.mean() - 19.5) * scale == pytest.approx(89.5, abs=scale)


def test_crop_does_not_depend_on_the_size_of_the_picture() -> None:
    small, scale, _ = crop_id_map(drawn(160, 200))
    large, large_scale, _ = crop_id_map(np.kron(drawn(160, 200), np.ones((3, 3), np.uint8)))
    assert large_scale == pytest.approx(3 * scale, rel=0.03)
    assert (small != large).mean() < 0.05


def test_specks_far_away_do_not_move_the_crop() -> None:
    ids = drawn(160, 200)
    _, scale, centre = crop_id_map(ids)
    rng = np.random.default_rng(0)
    ids[rng.integers(0, 160, 60), rng.integers(0, 200, 60)] = 5
    _, noisy_scale, noisy_centre = crop_id_map(ids)
    assert noisy_scale == pytest.approx(scale, rel=0.05)
    assert noisy_centre == pytest.approx(centre, abs=2.0)


def test_crop_of_nothing() -> None:
    small, scale, _ = crop_id_map(np.zeros((30, 40), np.uint8))
    assert scale == 0.0
    assert not small.any()
