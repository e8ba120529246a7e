"""The distance of a head from two views close together."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.arrays import camera_arrays
from mocapd.geometry.camera_model import centre, project, rays
from mocapd.published.hecht2009.head.stereo_distance import (
    StereoView,
    swept_distance,
    view_angle_rad,
)
from mocapd.published.hecht2009.head.stereo_sweep_kernels import sweep
from mocapd.types import Bytes, Camera
from tests.published.hecht2009.head.ball_scene import Ball, camera, narrow_pair, picture

BETWEEN_M = (0.6, 5.0)


def view(of: Camera, *balls: Ball) -> StereoView:
    return StereoView(of, camera_arrays(of), grey(of, *balls))


def grey(of: Camera, *balls: Ball) -> Bytes:
    return np.asarray(cv2.cvtColor(picture(of, balls), cv2.COLOR_BGR2GRAY), np.uint8)


@given(
    x=st.floats(-0.5, 0.5), y=st.floats(1.2, 1.8), z=st.floats(-0.5, 1.3), yaw=st.floats(-3.1, 3.1)
)
@settings(max_examples=10, deadline=None)
def test_a_ball_is_as_far_as_it_is_whichever_way_it_is_turned(
    x: float, y: float, z: float, yaw: float
) -> None:
    left, right = narrow_pair()
    ball = Ball(np.array([x, y, z]), yaw_rad=yaw)
    away_m = float(np.linalg.norm(ball.middle_m - centre(left)))
    half_px = 0.7 * 300.0 * ball.radius_m / away_m
    middle = project(left, ball.middle_m)
    found = swept_distance(
        view(left, ball), view(right, ball), middle, half_px, BETWEEN_M, ball.radius_m
    )
    assert found is not None
    # half a pixel of disparity: the pictures are drawn without smoothing their edges
    assert abs(found.distance_m - away_m) < 0.5 * away_m**2 / (300.0 * 0.12) + 0.01
    assert found.correlation > 0.8
    assert abs(found.distance_m - away_m) < 4.0 * found.sigma_m


def test_a_motion_between_the_exposures_is_taken_out() -> None:
    left, right = narrow_pair()
    ball, motion = Ball(np.array([0.0, 1.5, 0.0])), np.array([0.012, 0.0, 0.0])
    later = Ball(ball.middle_m + motion)
    middle = project(left, ball.middle_m)
    of = [
        swept_distance(view(left, ball), view(right, later), middle, 9.0, BETWEEN_M, 0.1, m)
        for m in (None, motion)
    ]
    assert of[0] is not None
    assert of[1] is not None
    assert abs(of[1].distance_m - 2.5) < 0.08
    assert abs(of[0].distance_m - 2.5) > 0.15


def test_what_the_other_view_does_not_see_has_no_distance() -> None:
    left, right = narrow_pair()
    ball, other = Ball(np.array([0.0, 1.5, 0.0])), Ball(np.array([0.7, 1.9, 0.0]), yaw_rad=2.0)
    middle = project(left, ball.middle_m)
    assert swept_distance(view(left, ball), view(right, other), middle, 9.0, BETWEEN_M, 0.1) is None


def test_a_patch_without_contrast_or_beyond_the_picture_has_no_distance() -> None:
    left, right = narrow_pair()
    empty = view(left), view(right)
    assert swept_distance(*empty, np.array([160.0, 120.0]), 9.0, BETWEEN_M, 0.1) is None
    assert swept_distance(*empty, np.array([2.0, 2.0]), 9.0, BETWEEN_M, 0.1) is None


def test_cameras_that_have_changed_places_give_no_distance() -> None:
    left, right = narrow_pair()
    ball = Ball(np.array([0.05, 1.5, 0.0]))
    mine, other = StereoView(right, camera_arrays(right), grey(left, ball)), view(right, ball)
    other = StereoView(left, camera_arrays(left), other.grey)
    assert swept_distance(mine, other, project(left, ball.middle_m), 9.0, BETWEEN_M, 0.1) is None


def test_the_correlation_is_that_of_the_pixels_where_the_ball_would_be() -> None:
    left, right = narrow_pair()
    ball = Ball(np.array([0.1, 1.45, 0.2]))
    pictures = grey(left, ball), grey(right, ball)
    pixels = project(left, ball.middle_m) + np.random.default_rng(1).uniform(-6, 6, (30, 2))
    from_m, directions = rays(left, np.vstack([project(left, ball.middle_m), pixels]))
    cosine = directions[1:] @ directions[0]
    lateral = np.sqrt(np.maximum(1.0 / cosine**2 - 1.0, 0.0))
    values = np.array([_bilinear(pictures[0], *p) for p in pixels])
    distances = np.array([2.0, 2.3, 2.6, 3.5])
    out = np.empty(4)
    patch = from_m, np.ascontiguousarray(directions[1:]), lateral, values
    sweep(*patch, distances, 0.1, camera_arrays(right), pictures[1], out)
    for distance, correlation in zip(distances, out, strict=True):
        depth = distance - np.sqrt(0.1**2 - (lateral * distance) ** 2)
        points = from_m + (depth / cosine)[:, None] * directions[1:]
        seen = np.array([_bilinear(pictures[1], *p) for p in project(right, points)])
        assert correlation == pytest.approx(np.corrcoef(values, seen)[0, 1], abs=1e-9)


def _bilinear(of: Bytes, x: float, y: float) -> float:
    i, j = int(np.floor(x)), int(np.floor(y))
    a, b = x - i, y - j
    rows = of[j : j + 2, i : i + 2].astype(float)
    return float((1 - b) * (rows[0] @ (1 - a, a)) + b * (rows[1] @ (1 - a, a)))


def test_the_angle_between_two_views() -> None:
    point = np.array([0.0, 1.5, 0.0])
    assert view_angle_rad(camera(0.0, "a", -30.0), camera(0.0, "b", 30.0), point) == pytest.approx(np.pi / 3)  # fmt: skip
