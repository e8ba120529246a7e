"""The particles: they move as they should, and drawing some where the measurements are favours nobody."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.arrays import camera_arrays
from mocapd.published.hecht2009.head.head_cloud import (
    Cloud,
    along_ray,
    at_distance,
    cloud_about,
    cloud_at,
    fuse,
    is_far,
    moments,
    observations,
    predict,
    propose,
    resampled,
)
from mocapd.published.hecht2009.head.head_colours import initial_colours, light_gain, update_colours
from mocapd.published.hecht2009.head.head_particle_kernels import score_heads, score_observations
from mocapd.published.hecht2009.head.head_samples import INSIDE, OUTLINE
from mocapd.published.hecht2009.head.head_shape import ellipse_of, head_size
from mocapd.published.hecht2009.resampling import normalised_weights
from mocapd.types import Bytes, Camera, Floats, Singles
from tests.published.hecht2009.head.ball_scene import Ball, camera, picture

MIDDLE = np.array([0.1, 1.5, -0.2])
MANY = 4000


def cloud(sd_m: float = 0.03, seed: int = 0) -> Cloud:
    return cloud_at(MIDDLE, sd_m**2 * np.eye(3), np.random.default_rng(seed), MANY)


@given(dt_s=st.floats(0.005, 0.2))
@settings(max_examples=20)
def test_a_cloud_moves_with_its_velocity_and_spreads(dt_s: float) -> None:
    before = Cloud(cloud().place_m, np.tile([1.0, 0.0, -0.5], (4000, 1)))
    after = predict(before, dt_s, np.random.default_rng(1))
    moved = after.place_m.mean(axis=0) - before.place_m.mean(axis=0)
    assert np.allclose(moved, dt_s * np.array([1.0, 0.0, -0.5]), atol=0.003 + 0.1 * dt_s**2 * 8)
    assert (after.place_m.std(axis=0) > before.place_m.std(axis=0)).all()


def test_two_rays_that_cross_and_one_distance_each_say_where_the_head_is() -> None:
    eyes = np.array([[-1.0, 1.5, 2.0], [1.0, 1.5, 2.0]])
    rays = [(MIDDLE - eye) / np.linalg.norm(MIDDLE - eye) for eye in eyes]
    crossing = observations([along_ray(e, r, 0.01) for e, r in zip(eyes, rays, strict=True)])
    away_m = float(np.linalg.norm(MIDDLE - eyes[0]))
    one = eyes[0], rays[0]
    placed = observations([along_ray(*one, 0.01), at_distance(*one, away_m, 0.01)])
    for seen in (crossing, placed):
        mean, covariance = fuse(MIDDLE + 0.2, np.eye(3), seen)
        assert np.allclose(mean, MIDDLE, atol=0.002)
        assert np.sqrt(np.linalg.eigvalsh(covariance).max()) < 0.03


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_particles_drawn_at_the_measurements_stand_for_the_same_cloud(
    seed: int,
) -> None:
    """With nothing weighed but what makes up for the drawing, mean and spread stay as they were."""
    eye = np.array([0.0, 1.5, 2.5])
    beside = MIDDLE + (0.06, 0.0, 0.0)
    ray = (beside - eye) / np.linalg.norm(beside - eye)
    seen = observations([along_ray(eye, ray, 0.03)])
    rng = np.random.default_rng(seed)
    before = cloud(0.04, seed)
    after, log_weight = propose(before, seen, rng)
    assert not np.array_equal(after.place_m, before.place_m)
    mean, covariance = moments(after.place_m, normalised_weights(log_weight))
    assert np.allclose(mean, MIDDLE, atol=0.006)
    assert np.allclose(np.sqrt(np.diag(covariance)), 0.04, rtol=0.12)


def test_resampling_keeps_particles_in_proportion_to_their_weight() -> None:
    before = Cloud(np.arange(12.0).reshape(4, 3), np.zeros((4, 3)))
    weight = np.array([0.5, 0.25, 0.25, 0.0])
    kept = resampled(before, weight, np.random.default_rng(0)).place_m[:, 0]
    assert sorted(kept.tolist()) == [0.0, 0.0, 3.0, 6.0]


def test_a_cloud_far_from_its_measurements_is_drawn_anew_there() -> None:
    there = MIDDLE + np.array([0.0, 0.0, 0.5])
    seen = observations([(there, np.eye(3) / 0.02**2)])
    near = observations([(MIDDLE, np.eye(3) / 0.02**2)])
    assert is_far(cloud(), seen)
    assert not is_far(cloud(), near)
    anew = cloud_about(seen, cloud(), np.random.default_rng(0))
    assert np.allclose(anew.place_m.mean(axis=0), there, atol=0.005)


def test_measurements_weigh_by_their_distance_and_outliers_by_no_more_than_their_share() -> None:
    places = np.stack([MIDDLE, MIDDLE + (0.02, 0.0, 0.0), MIDDLE + (9.0, 0.0, 0.0)])
    out = np.zeros(3)
    score_observations(places, MIDDLE[None], np.eye(3)[None] / 0.02**2, 0.01, out)
    assert np.allclose(out, [0.0, np.log(0.99 * np.exp(-0.5) + 0.01), np.log(0.01)])


@pytest.mark.parametrize("yaw_rad", [0.0, 2.5])
def test_the_place_of_a_head_scores_best_by_its_colours(yaw_rad: float) -> None:
    of, size = camera(0.0, "one"), head_size(1.75)
    ball = Ball(np.array([0.1, 1.55, 0.1]), yaw_rad=yaw_rad)
    pixels = picture(of, (ball,))
    outline = ellipse_of(of, ball.middle_m, size)
    assert outline is not None
    colours = update_colours(initial_colours(), pixels, outline, True, 0.0)
    gain = light_gain(pixels, outline)
    steps = np.linspace(-0.15, 0.15, 13)
    for axis in np.eye(3)[:2]:
        middles = ball.middle_m + steps[:, None] * axis
        scores = _scores(of, middles, pixels, colours.head_odds, outline.up, gain)
        assert abs(steps[np.argmax(scores)]) < 0.04


def _scores(
    of: Camera, middles: Floats, pixels: Bytes, odds: Singles, up: Floats, gain: float
) -> Floats:
    size, out = head_size(1.75), np.empty(len(middles))
    score_heads(
        np.ascontiguousarray(middles), np.array([size.width_m, size.height_m]), INSIDE, OUTLINE,
        camera_arrays(of), pixels, odds, gain, np.zeros((0, 0), np.uint8), up, out,
    )  # fmt: skip
    return out
