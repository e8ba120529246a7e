"""The hull by rays: against a naive twin, around the true body, smaller with each camera."""

import numpy as np
import pytest

from mocapd.geometry.camera_model import project
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.hull.ray_hull import (
    RayHullParams,
    RayIntervals,
    hull_points,
    points_on,
    ray_hull,
    views_of,
    voxel_centres,
)
from tests.vision.hull.ring_of_cameras import (
    BOX_M,
    FIGURE,
    crossings_m,
    inside_figure,
    ring,
    silhouette,
)

CAMERAS = ring(4)
MASKS = [silhouette(camera, FIGURE) for camera in CAMERAS]


def inside_masks(
    points_m: Floats, cameras: list[Camera], masks: list[Bytes], grown_px: int = 0
) -> np.ndarray:
    """(P,) by the projection of the camera model; out of view counts as inside. grown_px: by which the masks are."""
    inside = np.ones(len(points_m), dtype=bool)
    for camera, mask in zip(cameras, masks, strict=True):
        at = np.nan_to_num(project(camera, points_m), nan=-1e6)
        h, w = mask.shape
        column, row = np.floor((at + 0.5) * (w, h) / camera.size_px).astype(int).T
        in_view = (column >= 0) & (row >= 0) & (column < w) & (row < h)
        grown = np.zeros_like(in_view)
        for down in range(-grown_px, grown_px + 1):
            for across in range(-grown_px, grown_px + 1):
                rows, columns = np.clip(row + down, 0, h - 1), np.clip(column + across, 0, w - 1)
                grown |= mask[rows, columns] > 0
        inside &= ~in_view | grown
    return inside


def within(hull: RayIntervals, n: int, at_m: Floats) -> np.ndarray:
    spans = hull.intervals_m[n, : hull.counts[n]]
    return np.asarray(((at_m[:, None] >= spans[:, 0]) & (at_m[:, None] <= spans[:, 1])).any(axis=1))


def test_intervals_are_those_of_a_ray_looked_at_point_by_point() -> None:
    hull = ray_hull(CAMERAS, MASKS, BOX_M, RayHullParams(rays=150))
    others = [k for k in range(4) if k != hull.own]
    wrong = looked_at = 0
    for n in range(len(hull.ways)):
        at_m = np.arange(1.5, 4.5, 0.005)
        points = hull.eye_m + at_m[:, None] * hull.ways[n]
        boxed = ((points > BOX_M[0]) & (points < BOX_M[1])).all(axis=1)
        naive = boxed & inside_masks(
            points, [CAMERAS[k] for k in others], [MASKS[k] for k in others]
        )
        wrong += int(np.count_nonzero(naive != within(hull, n, at_m)))
        looked_at += int(np.count_nonzero(naive))
    assert looked_at > 3000
    assert hull.counts.max() >= 2
    # a border lies within half a pixel, 7 mm here and more where a line grazes the outline
    assert wrong < 0.04 * looked_at


def test_what_a_ray_crosses_of_the_body_is_kept() -> None:
    hull = ray_hull(CAMERAS, MASKS, BOX_M)
    missed = total = 0.0
    for centre, radii in FIGURE:
        spans = crossings_m(hull.eye_m, hull.ways, centre, radii)
        for n in np.nonzero(np.isfinite(spans[:, 0]))[0].tolist():
            at_m = np.linspace(spans[n, 0], spans[n, 1], 30)
            share = 1.0 - within(hull, n, at_m).mean()
            missed += share * (spans[n, 1] - spans[n, 0])
            total += spans[n, 1] - spans[n, 0]
    # half a pixel of 10 mm at an outline of limbs 160 mm thick
    assert missed < 0.04 * total


def test_each_camera_more_leaves_less_of_the_rays() -> None:
    order = sorted(range(4), key=lambda k: -np.count_nonzero(MASKS[k]))
    lengths = []
    for n in (1, 2, 3, 4):
        hull = ray_hull([CAMERAS[k] for k in order[:n]], [MASKS[k] for k in order[:n]], BOX_M)
        assert hull.own == 0
        counted = hull.intervals_m[np.arange(hull.intervals_m.shape[1]) < hull.counts[:, None]]
        lengths.append(np.diff(counted).sum())
    assert lengths[0] > lengths[1] > lengths[2] > lengths[3]


def test_points_are_inside_every_silhouette_and_fill_the_body() -> None:
    points = hull_points(CAMERAS, MASKS, BOX_M, RayHullParams(points=1000)).points_m
    assert points.shape == (1000, 3)
    assert inside_masks(points, CAMERAS, MASKS, grown_px=1).all()
    assert inside_figure(points).mean() > 0.6
    for centre, radii in FIGURE:
        near = (((points - centre) / radii) ** 2).sum(axis=-1) <= 1.0
        assert near.sum() > 100


def test_an_interval_has_points_in_proportion_to_its_length() -> None:
    ways = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    intervals = np.array([[[1.0, 2.0], [4.0, 4.5]], [[2.0, 4.0], [np.nan, np.nan]]])
    hull = RayIntervals(0, 0.01, np.zeros(3), ways, intervals, np.array([2, 1]))
    found = points_on(hull, 70)
    points = found.points_m
    z, x = points[:, 2], points[:, 0]
    assert np.count_nonzero((z >= 1.0) & (z <= 2.0)) == 20
    assert np.count_nonzero((z >= 4.0) & (z <= 4.5)) == 10
    assert np.count_nonzero((x >= 2.0) & (x <= 4.0)) == 40
    # a cone of 0.01 sr between two distances
    assert np.isclose(found.volumes_m3[x >= 2.0].sum(), 0.01 * (4.0**3 - 2.0**3) / 3.0, rtol=1e-3)


@pytest.mark.parametrize("masks", [[], [np.zeros((240, 320), np.uint8)] * 4])
def test_nothing_in_view_is_an_empty_hull(masks: list[Bytes]) -> None:
    assert hull_points(CAMERAS[: len(masks)], masks, BOX_M).points_m.shape == (0, 3)


def test_a_camera_that_does_not_see_a_place_says_nothing_of_it() -> None:
    """Nor does one with the place at its back."""
    narrow = ring(4)
    away = ring(1)[0]
    turned = Camera("away", away.size_px, away.K, away.dist, np.diag([-1.0, 1.0, -1.0]) @ away.R,
                    np.diag([-1.0, 1.0, -1.0]) @ away.t_m)  # fmt: skip
    blind = np.zeros((240, 320), np.uint8)
    with_it = hull_points([*narrow, turned], [*MASKS, blind], BOX_M)
    without = hull_points(narrow, MASKS, BOX_M)
    assert np.array_equal(with_it.points_m, without.points_m)
    views = views_of([*narrow, turned], without.points_m)
    assert (views == 4).all()
    assert np.array_equal(views_of(narrow, np.array([[0.0, 40.0, 0.0], [0.0, 0.9, 0.0]])), [0, 4])


def test_the_volume_is_that_of_the_hull() -> None:
    hull = hull_points(CAMERAS, MASKS, BOX_M)
    centres, _ = voxel_centres(BOX_M, 0.02)
    counted = np.count_nonzero(inside_masks(centres, CAMERAS, MASKS)) * 0.02**3
    assert np.isclose(hull.volumes_m3.sum(), counted, rtol=0.08)


def test_silhouettes_of_another_size_give_the_same_hull() -> None:
    half = [silhouette(camera, FIGURE, (160, 120)) for camera in CAMERAS]
    fine, coarse = (hull_points(CAMERAS, masks, BOX_M).points_m for masks in (MASKS, half))
    assert np.allclose(fine.mean(axis=0), coarse.mean(axis=0), atol=0.03)
    assert np.allclose(fine.std(axis=0), coarse.std(axis=0), atol=0.03)
