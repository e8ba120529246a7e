"""Poses for tests: every joint turned, so that a wrong parent or order shows."""

import numpy as np

from mocapd.body.skeleton import N_JOINTS, global_from_local
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose, Skeleton


def random_local(seed: int, spread_rad: float = 0.6) -> Floats:
    """Local rotations (J,4)."""
    rng = np.random.default_rng(seed)
    return rotations.exp(rng.normal(0.0, spread_rad, (N_JOINTS, 3)))


def random_root(seed: int) -> Floats:
    """Where the hips are [m], around the middle of the play area."""
    return np.array([0.0, 0.95, 0.0]) + np.random.default_rng(seed).normal(0.0, 0.15, 3)


def pose_of(skeleton: Skeleton, root_m: Floats, local_xyzw: Floats) -> Pose:
    return Pose(root_m, global_from_local(skeleton, local_xyzw))
