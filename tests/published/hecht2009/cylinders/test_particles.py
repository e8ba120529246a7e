"""Particles: how they move and scatter, are weighed and drawn anew."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.fit.fit_params import TICK_S
from mocapd.geometry.camera_model import centre, project
from mocapd.published.hecht2009.cylinders.limb_params import LimbMotionParams, LimbScoreParams
from mocapd.published.hecht2009.cylinders.limb_particles import (
    LimbCloud,
    draw_noise,
    predict,
    spread_cloud,
    start_cloud,
    step_cloud,
    sum_up,
)
from mocapd.published.hecht2009.cylinders.limb_score import LimbView
from mocapd.published.hecht2009.cylinders.occlusion import allocate_occlusion
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from mocapd.published.hecht2009.resampling import normalised_weights, resample
from mocapd.types import Floats
from tests.published.hecht2009.cylinders.naive import (
    ENDS_M,
    LEFT_ARM,
    RADII_M,
    WORK_PX,
    camera,
    limb_of,
)

SCORE = LimbScoreParams()
STILL = LimbMotionParams(base_sd_m=0.0, variance_share=0.0, motion_sd_m_s=0.0, depth_noise=False)
ARM_M = limb_of(ENDS_M, LEFT_ARM)
N = 4000


def view(x_m: float = 0.3, moving: int = 0) -> LimbView:
    """A grey picture without edges; moving: what the motion image says everywhere."""
    width, height = WORK_PX
    return LimbView(
        0, work_camera(camera(x_m), WORK_PX), np.full((height, width, 3), 90, np.uint8),
        np.zeros((height, width, 3), np.int16), np.full((height // 4, width // 4), moving, np.uint8),
        np.full((len(ENDS_M), SCORE.along, 3), np.nan, np.float32),
        allocate_occlusion(len(ENDS_M), WORK_PX, SCORE.cell_px),
    )  # fmt: skip


def cloud(n: int = N) -> LimbCloud:
    return start_cloud(ARM_M, n, 1, SCORE)


def scattered(
    params: LimbMotionParams, views: list[LimbView], of: LimbCloud | None = None
) -> Floats:
    draws = draw_noise(np.random.default_rng(1), N)
    return predict(of or cloud(), TICK_S, views, draws, params) - ARM_M


def test_a_cloud_about_an_unsure_place_is_as_wide_and_at_rest() -> None:
    sd = np.array([0.0, 0.02, 0.1])
    wide = spread_cloud(cloud(), sd, np.random.default_rng(0))
    assert wide.points_m.std(axis=0) == pytest.approx(np.repeat(sd[:, None], 3, 1), rel=0.1)
    assert wide.points_m.mean(axis=0) == pytest.approx(ARM_M, abs=0.02)
    assert np.array_equal(wide.points_m, wide.previous_m)
    assert wide.variance_m2 == pytest.approx(sd**2)


@pytest.mark.parametrize("dt_s", [1 / 60, 1 / 30, 0.1])
def test_velocity_goes_on_by_its_share_whatever_the_time_between(dt_s: float) -> None:
    velocity = np.array([0.6, -0.3, 0.9])
    moving = replace(cloud(5), previous_m=cloud(5).points_m - 0.05 * velocity, dt_s=0.05)
    draws = draw_noise(np.random.default_rng(0), 5)
    got = predict(moving, dt_s, [], draws, replace(STILL, velocity_share=0.7))
    assert got - ARM_M == pytest.approx(np.broadcast_to(0.7 * dt_s * velocity, (5, 3, 3)))


def test_the_base_noise_is_as_wide_as_it_says_and_the_same_each_way() -> None:
    off = scattered(replace(STILL, base_sd_m=0.02), [])
    assert off.std(axis=0) == pytest.approx(np.full((3, 3), 0.02), rel=0.06)
    assert off.mean(axis=0) == pytest.approx(np.zeros((3, 3)), abs=0.0015)


def test_noise_grows_with_a_points_variance_and_with_motion_in_the_picture() -> None:
    unsure = replace(cloud(), variance_m2=np.array([0.0, 0.01, 0.04]))
    off = scattered(replace(STILL, variance_share=0.25), [], unsure)
    assert off.std(axis=(0, 2)) == pytest.approx([0.0, 0.05, 0.10], rel=0.06)
    params = replace(STILL, motion_sd_m_s=1.5)
    assert not scattered(params, [view(moving=0)]).any()
    some, all_ = (scattered(params, [view(moving=m)]).std() for m in (32, 255))
    assert all_ == pytest.approx(1.5 * TICK_S, rel=0.06)
    assert some == pytest.approx(all_ * (32 / 255) / params.full_motion, rel=0.06)


def test_the_share_alpha_scatters_along_the_viewing_ray_and_farthest_at_the_end() -> None:
    params = LimbMotionParams(base_sd_m=0.0, variance_share=0.0, motion_sd_m_s=0.0)
    off = scattered(params, [view()])
    moved = np.abs(off).sum(axis=(1, 2)) > 0.0
    assert moved.mean() == pytest.approx(params.depth_share, abs=0.025)
    rays = ARM_M - centre(camera(0.3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    along = np.vecdot(off[moved], rays)
    assert off[moved] == pytest.approx(along[..., None] * rays, abs=1e-9)
    assert along[:, :2].std(axis=0) == pytest.approx(params.depth_sd_m[:2], rel=0.08)
    # one metre is cut off at the camera, 2.7 m away, seldom
    assert along[:, 2].std() == pytest.approx(params.depth_sd_m[2], rel=0.08)
    seen = project(camera(0.3), ARM_M + off[moved])
    assert seen == pytest.approx(np.broadcast_to(project(camera(0.3), ARM_M), seen.shape), abs=1e-6)


def test_depth_noise_is_spread_over_all_cameras() -> None:
    params = LimbMotionParams(base_sd_m=0.0, variance_share=0.0, motion_sd_m_s=0.0)
    off = scattered(params, [view(-1.0), view(1.0)])
    moved = off[np.abs(off).sum(axis=(1, 2)) > 0.0][:, 2]
    ray = ARM_M[2] - centre(camera(-1.0))
    first = np.linalg.norm(np.cross(moved, ray), axis=1) < 1e-6
    assert first.mean() == pytest.approx(0.5, abs=0.06)


@given(
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=40),
    st.floats(0.0, 0.999),
    st.integers(1, 60),
)
def test_each_particle_is_drawn_as_often_as_it_weighs(
    raw: list[float], start: float, m: int
) -> None:
    weights = (np.array(raw) + 1e-3) / (np.array(raw) + 1e-3).sum()
    count = np.bincount(resample(weights, start, m), minlength=len(weights))
    assert (count >= np.floor(m * weights - 1e-9)).all()
    assert (count <= np.ceil(m * weights + 1e-9)).all()


def test_resampling_is_unbiased() -> None:
    weights = normalised_weights(np.random.default_rng(2).normal(0.0, 2.0, 23))
    count = np.zeros(23)
    starts = (np.arange(2000) + 0.5) / 2000
    for start in starts:
        count += np.bincount(resample(weights, start, 10), minlength=23)
    assert count / len(starts) == pytest.approx(10 * weights, abs=2e-3)


def test_weights_are_likelihoods_whatever_their_constant() -> None:
    log_scores = np.array([-1000.0, -1001.0, -1800.0])
    weights = normalised_weights(log_scores)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[0] / weights[1] == pytest.approx(np.e)
    assert weights == pytest.approx(normalised_weights(log_scores + 5000.0))


def test_mean_and_variance_are_those_of_the_weighted_points() -> None:
    rng = np.random.default_rng(3)
    points, count = rng.normal(size=(6, 3, 3)), np.array([1, 2, 3, 0, 1, 3])
    repeated = np.repeat(points, count, axis=0)
    mean, variance = sum_up(points, count / count.sum())
    assert mean == pytest.approx(repeated.mean(axis=0))
    assert variance == pytest.approx(repeated.var(axis=0).mean(axis=1))


def test_only_the_points_where_the_picture_moves_scatter() -> None:
    still = view(moving=0)
    x, y = (project(camera(0.3), ARM_M[2]) + 0.5) / 8.0  # 640 pixels to 80
    still.motion[int(y), int(x)] = 255
    off = scattered(replace(STILL, motion_sd_m_s=1.5), [still])
    assert off.std(axis=(0, 2)) == pytest.approx([0.0, 0.0, 1.5 * TICK_S], rel=0.06)


def test_particles_drawn_anew_keep_their_own_velocity() -> None:
    side = np.where(np.arange(60) % 3 == 0, -1.0, 1.0)[:, None, None] * np.array([1.0, 0.0, 0.0])
    points = ARM_M + 0.25 * side
    of = replace(cloud(60), points_m=points, previous_m=points - 0.02 * side)
    half = view(0.0)
    half.colour[:, int((project(camera(), ARM_M[0])[0] + 0.5) / 2) :] = 200
    reference = np.full_like(half.reference, 200.0)
    seen = replace(half, reference=reference)
    got = step_cloud(
        of, TICK_S, RADII_M[list(LEFT_ARM)], LEFT_ARM, [seen], None, np.random.default_rng(0), STILL,
        SCORE,
    )  # fmt: skip
    right = got.points_m[:, 0, 0] > ARM_M[0, 0]
    assert right.all()
    step = STILL.velocity_share * 0.02
    assert got.points_m - got.previous_m == pytest.approx(
        np.broadcast_to([step, 0.0, 0.0], (60, 3, 3))
    )


def run(seed: int, steps: int = 4) -> LimbCloud:
    rng, of = np.random.default_rng(seed), cloud(100)
    for _ in range(steps):
        of = step_cloud(
            of, TICK_S, RADII_M[list(LEFT_ARM)], LEFT_ARM, [view(moving=90)], None, rng,
            LimbMotionParams(), SCORE,
        )  # fmt: skip
    return of


def test_one_seed_gives_one_result() -> None:
    a, b, other = run(7), run(7), run(8)
    assert (a.points_m == b.points_m).all()
    assert (a.mean_m == b.mean_m).all()
    assert (a.mean_m != other.mean_m).any()


def test_particles_stay_where_the_constraint_puts_them() -> None:
    def straight_down(points: Floats) -> Floats:
        out = np.repeat(points[:, :1], 3, axis=1)
        out[:, 1, 1] -= 0.3
        out[:, 2, 1] -= 0.55
        return out

    of = step_cloud(
        cloud(50), TICK_S, RADII_M[list(LEFT_ARM)], LEFT_ARM, [view()], straight_down,
        np.random.default_rng(0), LimbMotionParams(), SCORE,
    )  # fmt: skip
    assert np.diff(of.points_m, axis=1) == pytest.approx(
        np.broadcast_to([[0.0, -0.3, 0.0], [0.0, -0.25, 0.0]], (50, 2, 3))
    )


def test_a_limb_that_nobody_sees_spreads_and_stays_finite() -> None:
    rng, of = np.random.default_rng(4), cloud(100)
    radii, spread = RADII_M[list(LEFT_ARM)], []
    for _ in range(300):
        of = step_cloud(of, TICK_S, radii, LEFT_ARM, [], None, rng, LimbMotionParams(), SCORE)
        spread.append(of.variance_m2.mean() ** 0.5)
    assert spread[2] < spread[20] < spread[-1] < 20.0
