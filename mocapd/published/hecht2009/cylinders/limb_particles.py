"""A limb's particle filter: predict, weight, estimate and resample, as pure functions of arrays and random numbers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.fit.fit_params import TICK_S
from mocapd.published.hecht2009.cylinders.limb_params import LimbMotionParams, LimbScoreParams
from mocapd.published.hecht2009.cylinders.limb_score import (
    LimbView,
    UsualPenalties,
    learn_usual,
    limb_penalties,
    log_scores,
)
from mocapd.published.hecht2009.cylinders.particle_kernels import (
    NoiseDraws,
    motion_at,
    scatter,
)
from mocapd.published.hecht2009.resampling import normalised_weights, resample
from mocapd.types import Floats

Constrain = Callable[[Floats], Floats]  # points (N,3,3) to the nearest that the body allows [m]


@dataclass(frozen=True, slots=True, eq=False)
class LimbCloud:
    """N particles of one limb: points_m (N,3,3) from the trunk outwards [world], all of equal weight; previous_m: where the
    same were dt_s earlier; mean_m (3,3), variance_m2 (3,): of each point, the mean over the world's axes; usual: what
    the limb's penalties usually are."""

    points_m: Floats
    previous_m: Floats
    dt_s: float
    mean_m: Floats
    variance_m2: Floats
    usual: UsualPenalties


def start_cloud(points_m: Floats, n: int, n_cameras: int, params: LimbScoreParams) -> LimbCloud:
    """n particles at rest at one place (3,3) [m]."""
    points = np.repeat(points_m[None], n, axis=0)
    usual = UsualPenalties.initial(n_cameras, params)
    return LimbCloud(points, points.copy(), TICK_S, points_m.copy(), np.zeros(3), usual)


def spread_cloud(cloud: LimbCloud, sd_m: Floats, rng: np.random.Generator) -> LimbCloud:
    """A cloud at one place with its points spread at rest around it, with standard deviations sd_m (3,) along each axis; not
    yet constrained."""
    points = cloud.points_m + sd_m[:, None] * rng.standard_normal(cloud.points_m.shape)
    return replace(cloud, points_m=points, previous_m=points.copy(), variance_m2=sd_m**2)


def draw_noise(rng: np.random.Generator, n: int) -> NoiseDraws:
    """The numbers of one step for n particles."""
    return NoiseDraws(
        rng.random(n), rng.random(n), rng.standard_normal((n, 3, 3)), rng.standard_normal((n, 3))
    )


def predict(
    cloud: LimbCloud,
    dt_s: float,
    views: Sequence[LimbView],
    draws: NoiseDraws,
    params: LimbMotionParams,
) -> Floats:
    """Where particles may be dt_s later (N,3,3) [m]: constant velocity and noise, not yet constrained.

    The first noise grows with the square root of time, with the points' variance, and with what moves in the pictures
    at the predicted place; the second is along the viewing ray of one of the cameras.
    """
    share = params.velocity_share * dt_s / cloud.dt_s
    points: Floats = cloud.points_m + share * (cloud.points_m - cloud.previous_m)
    level = np.zeros(points.shape[:2])
    for view in views:
        h, w, _ = view.edges.shape
        motion_at(points, view.camera, view.motion, (w, h), level)
    moving_m = params.motion_sd_m_s * dt_s * np.minimum(level / params.full_motion, 1.0)
    own = np.minimum(cloud.variance_m2, params.most_sd_m**2)
    unknown = params.base_sd_m**2 + params.variance_share * own
    variance = unknown * (dt_s / TICK_S) + moving_m**2
    centres = np.array([-view.camera.R.T @ view.camera.t for view in views]).reshape(-1, 3)
    depth_share = params.depth_share if params.depth_noise else 0.0
    scatter(points, variance, centres, np.array(params.depth_sd_m), depth_share, draws)
    return points


def sum_up(points_m: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Mean (3,3) [m], and variance (3,) [m^2] of each point, the mean over the axes; points (N,3,3), weights (N,)."""
    mean = np.tensordot(weights, points_m, axes=1)
    return mean, np.tensordot(weights, (points_m - mean) ** 2, axes=1).mean(axis=1)


def step_cloud(
    cloud: LimbCloud,
    dt_s: float,
    radii_m: Floats,
    parts: tuple[int, int],
    views: Sequence[LimbView],
    constrain: Constrain | None,
    rng: np.random.Generator,
    motion: LimbMotionParams,
    score: LimbScoreParams,
) -> LimbCloud:
    """The cloud dt_s later, from the pictures of then; constrain: None leaves points where the noise has put them.

    Mean and variance are those before new particles are drawn, which would only add noise to them. With no view the
    cloud spreads, as all weights are equal.
    """
    points = predict(cloud, dt_s, views, draw_noise(rng, len(cloud.points_m)), motion)
    if constrain is not None:
        points = constrain(points)
    penalties = limb_penalties(points, radii_m, parts, views, score)
    weights = normalised_weights(log_scores(penalties, cloud.usual, views, score))
    usual = learn_usual(cloud.usual, penalties, weights, views, dt_s, score)
    mean, variance = sum_up(points, weights)
    chosen = resample(weights, rng.random(), len(points))
    return LimbCloud(points[chosen], cloud.points_m[chosen], dt_s, mean, variance, usual)
