"""The rasteriser against one that asks every triangle at every pixel."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mocapd.types import Floats, Ints
from mocapd.vision.raster_kernels import NOTHING, bounds, label_triangles, rasterise

H, W = 30, 40


def rasterised(xy: Floats, depth: Floats, triangles: NDArray[np.int32]) -> NDArray[np.int32]:
    out = np.full((H, W), 99, np.int32)
    rasterise(xy, depth, triangles, np.empty((H, W), np.float32), out)
    return out


def cross(u: Floats, v: Floats) -> float:
    return float(u[0] * v[1] - u[1] * v[0])


def naive(
    xy: Floats, depth: Floats, triangles: NDArray[np.int32]
) -> tuple[Ints, NDArray[np.bool_]]:
    """Triangle seen at each pixel, and where that is too close to call: on an edge, or a tie in depth."""
    seen, close = np.full((H, W), NOTHING), np.zeros((H, W), bool)
    facing = []
    for t, corners in enumerate(triangles):
        a, b, c = xy[corners].tolist()
        area = cross(np.subtract(b, a), np.subtract(c, a))
        # a front is clockwise, as y points down
        if area < 0.0 and (depth[corners] > 0.05).all():
            facing.append((t, a, b, c, area, depth[corners].tolist()))
    for y in range(H):
        for x in range(W):
            hits = []
            for t, (ax, ay), (bx, by), (cx, cy), area, z in facing:
                shares = (
                    ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area,
                    ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area,
                    ((ax - x) * (by - y) - (ay - y) * (bx - x)) / area,
                )
                if min(map(abs, shares)) < 1e-6:
                    close[y, x] = True
                if min(shares) >= 0.0:
                    hits.append((sum(share * d for share, d in zip(shares, z, strict=True)), t))
            hits.sort()
            if hits:
                seen[y, x] = hits[0][1]
            if len(hits) > 1 and hits[1][0] - hits[0][0] < 1e-5:
                close[y, x] = True
    return seen, close


def front(corners: Floats) -> Floats:
    """The corners (3,2) in the order that faces the camera."""
    a, b, c = corners
    return corners if cross(b - a, c - a) < 0 else corners[::-1]


@pytest.mark.parametrize("seed", range(3))
def test_a_heap_of_triangles_equals_the_naive_twin(seed: int) -> None:
    """Some turned away, some behind the camera, many over the border or quite outside."""
    rng = np.random.default_rng(seed)
    middle = rng.uniform([-8.0, -8.0], [W + 8.0, H + 8.0], (40, 1, 2))
    xy = (middle + rng.normal(0.0, 8.0, (40, 3, 2))).reshape(-1, 2)
    depth = rng.uniform(-0.3, 4.0, len(xy))
    triangles = np.arange(len(xy), dtype=np.int32).reshape(-1, 3)
    got = rasterised(xy, depth, triangles)
    wanted, close = naive(xy, depth, triangles)
    assert close.mean() < 0.01
    np.testing.assert_array_equal(got[~close], wanted[~close])
    assert (got != NOTHING).mean() > 0.1


def test_the_nearer_triangle_hides_the_farther_whatever_their_order() -> None:
    one = front(np.array([[5.0, 5.0], [30.0, 6.0], [12.0, 25.0]]))
    xy = np.concatenate([one, one])
    for near, depth in ((0, [1.0] * 3 + [2.0] * 3), (1, [2.0] * 3 + [1.0] * 3)):
        seen = rasterised(xy, np.array(depth), np.array([[0, 1, 2], [3, 4, 5]], np.int32))
        assert set(np.unique(seen)) == {NOTHING, near}


def test_triangles_that_pierce_each_other_meet_in_a_line() -> None:
    square = np.array([[0.0, 0.0], [39.0, 0.0], [0.0, 58.0]])
    xy = np.concatenate([front(square), front(square)])
    depth = np.where(xy[:, 0] > 1.0, 3.0, 1.0)
    depth[3:] = 2.0
    seen = rasterised(xy, depth, np.array([[0, 1, 2], [3, 4, 5]], np.int32))
    # the slanted one is 1 + 2 x / 39 deep, the flat one 2: they meet half way
    covered = seen != NOTHING
    columns = np.broadcast_to(np.arange(W), (H, W))
    np.testing.assert_array_equal(seen[covered], (columns[covered] > 19.5).astype(int))


def test_back_faces_are_not_drawn() -> None:
    corners = front(np.array([[5.0, 5.0], [30.0, 6.0], [12.0, 25.0]]))
    triangle = np.array([[0, 1, 2]], np.int32)
    assert (rasterised(corners, np.ones(3), triangle) == 0).any()
    assert (rasterised(corners, np.ones(3), triangle[:, ::-1].copy()) == NOTHING).all()


def test_a_triangle_of_no_area_is_not_drawn() -> None:
    line = np.array([[5.0, 5.0], [15.0, 15.0], [25.0, 25.0]])
    assert (rasterised(line, np.ones(3), np.array([[0, 1, 2]], np.int32)) == NOTHING).all()


def test_a_mesh_leaves_no_gap_and_only_one_owner() -> None:
    """Corners on pixel centres: the edges run through pixels, which must still be covered."""
    x, y = np.meshgrid(np.arange(0.0, 37.0, 6.0), np.arange(0.0, 28.0, 9.0))
    xy = np.stack([x.ravel(), y.ravel()], axis=1)
    columns = x.shape[1]
    triangles = []
    for r in range(x.shape[0] - 1):
        for c in range(columns - 1):
            a = r * columns + c
            triangles += [[a, a + columns, a + 1], [a + 1, a + columns, a + columns + 1]]
    seen = rasterised(xy, np.ones(len(xy)), np.array(triangles, np.int32))
    assert (seen[:28, :37] != NOTHING).all()
    assert (seen[28:] == NOTHING).all()
    assert (seen[:, 37:] == NOTHING).all()


def test_a_triangle_larger_than_the_picture_fills_it() -> None:
    huge = front(np.array([[-1e4, -1e4], [3e4, -1e4], [-1e4, 3e4]]))
    assert (rasterised(huge, np.ones(3), np.array([[0, 1, 2]], np.int32)) == 0).all()


def test_of_two_triangles_at_one_place_the_first_is_seen() -> None:
    one = front(np.array([[2.0, 2.0], [35.0, 3.0], [4.0, 27.0]]))
    xy = np.concatenate([one, one])
    seen = rasterised(xy, np.full(6, 1.5), np.array([[0, 1, 2], [3, 4, 5]], np.int32))
    assert set(np.unique(seen)) == {NOTHING, 0}


def test_depths_are_those_of_what_is_seen() -> None:
    square = front(np.array([[0.0, 0.0], [39.0, 0.0], [0.0, 58.0]]))
    depth_at, seen = np.empty((H, W), np.float32), np.empty((H, W), np.int32)
    depth = 1.0 + square[:, 0] / 39.0 + square[:, 1] / 58.0
    rasterise(square, depth, np.array([[0, 1, 2]], np.int32), depth_at, seen)
    y, x = np.mgrid[:H, :W]
    there = seen == 0
    np.testing.assert_allclose(depth_at[there], (1.0 + x / 39.0 + y / 58.0)[there], rtol=1e-6)
    assert (depth_at[~there] > 1e6).all()


def test_labels_are_those_of_the_triangles() -> None:
    seen = np.array([[NOTHING, 0, 2], [1, 1, NOTHING]], np.int32)
    out = np.full((2, 3), 77, np.uint8)
    label_triangles(seen, np.array([5, 9, 1], np.uint8), out)
    np.testing.assert_array_equal(out, [[0, 5, 1], [9, 9, 0]])


def test_the_box_of_the_vertices_in_view_is_that_of_numpy() -> None:
    rng = np.random.default_rng(2)
    xy, depth = rng.normal(0.0, 90.0, (60, 2)), rng.uniform(-0.5, 3.0, 60)
    seen = xy[depth > 0.2]
    n, *box = bounds(xy, depth, 0.2)
    assert 0 < n < 60
    assert n == len(seen)
    assert box == [*seen.min(axis=0), *seen.max(axis=0)]


def test_nothing_in_view_has_an_empty_box() -> None:
    n, left, top, right, bottom = bounds(np.zeros((3, 2)), np.full(3, -1.0), 0.2)
    assert n == 0
    assert left > right
    assert top > bottom
