"""The motion between two cameras' bodies, with depth errors and outliers as lone cameras make them."""

import numpy as np
import pytest

from mocapd.calibrate.self_calibration.relative_pose import relative_pose
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.types import Floats

R = rotations.to_matrix(rotations.exp(np.array([0.05, 1.1, -0.02])))
T_M = np.array([-2.4, 0.1, 1.5])


def bodies(n: int = 400, seed: int = 0) -> tuple[Floats, Floats]:
    points = np.random.default_rng(seed).uniform(-0.6, 0.6, (n, 3)) + [0.0, 0.0, 2.8]
    return points, points @ R.T + T_M


def angle_deg(a: Floats, b: Floats) -> float:
    apart = rotations.angle_rad(rotations.from_matrix(a), rotations.from_matrix(b))
    return float(np.degrees(apart))


def test_exact_points_give_the_exact_pose() -> None:
    first, second = bodies()
    pose = relative_pose(first, second, np.ones(len(first)))
    np.testing.assert_allclose(pose.R, R, atol=1e-9)
    np.testing.assert_allclose(pose.t_m, T_M, atol=1e-9)


def test_a_quarter_of_wrong_arms_does_not_matter() -> None:
    rng = np.random.default_rng(1)
    first, second = bodies()
    first = first * (1.0 + rng.normal(0.0, 0.03, (len(first), 1)))
    second = second * (1.0 + rng.normal(0.0, 0.03, (len(second), 1)))
    second[::4] += rng.normal(0.0, 1.0, (100, 3))
    pose = relative_pose(first, second, np.ones(len(first)))
    assert angle_deg(pose.R, R) < 2.0
    assert np.linalg.norm(pose.t_m - T_M) < 0.1


def test_points_without_weight_are_not_asked() -> None:
    first, second = bodies()
    second[:200] += 5.0
    weights = np.ones(len(first))
    weights[:200] = 0.0
    assert angle_deg(relative_pose(first, second, weights).R, R) < 1e-6


def test_too_few_points_are_refused() -> None:
    first, second = bodies(40)
    with pytest.raises(ConfigError, match="40 joints"):
        relative_pose(first, second, np.ones(40))


def test_bodies_that_have_nothing_in_common_are_refused() -> None:
    first, _ = bodies()
    rng = np.random.default_rng(2)
    with pytest.raises(ConfigError, match="mirrored"):
        relative_pose(first, rng.uniform(-2.0, 2.0, first.shape), np.ones(len(first)))
