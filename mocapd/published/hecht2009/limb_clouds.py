"""The particles of all limbs of a body, at its start and after a takeover."""

import numpy as np

from mocapd.published.hecht2009.cylinders.limb_particles import (
    LimbCloud,
    spread_cloud,
    start_cloud,
)
from mocapd.published.hecht2009.mass_spring.body_points import (
    JOINT_POINTS,
    JOINTS_OF_POINTS,
    LIMBS,
    N_POINTS,
)
from mocapd.published.hecht2009.params import Params
from mocapd.types import Floats


def clouds_at(points_m: Floats, n_cameras: int, params: Params) -> dict[str, LimbCloud]:
    """Clouds of LIMBS at the points of a body (16,3) [m]."""
    return {
        limb: start_cloud(points_m[list(which)], params.particles, n_cameras, params.score)
        for limb, which in LIMBS.items()
    }


def clouds_about(
    points_m: Floats,
    uncertainty_m: Floats,
    n_cameras: int,
    rng: np.random.Generator,
    params: Params,
) -> dict[str, LimbCloud]:
    """Clouds about the points of another tracker's body (16,3) [m], as wide as the uncertainty of its joints (22,) [m]."""
    sd_m = np.zeros(N_POINTS)
    sd_m[JOINT_POINTS] = uncertainty_m[JOINTS_OF_POINTS]
    sd_m = np.minimum(sd_m, params.motion.most_sd_m)
    return {
        limb: spread_cloud(cloud, sd_m[list(LIMBS[limb])], rng)
        for limb, cloud in clouds_at(points_m, n_cameras, params).items()
    }
