"""Joint limits: the compiled residual against a numpy twin, its derivative against differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.body.joint_limits import from_swing_twist, swing_twist
from mocapd.body.model import build_model
from mocapd.body.pose_space import upper_body
from mocapd.body.posing_kernels import retract
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.body.soft_limits import soft_limit

SPACE = upper_body()
LIMITS, GROUPS = SPACE.limits, SPACE.groups


def random_local(seed: int, size_rad: float = 2.2) -> Floats:
    rng = np.random.default_rng(seed)
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for names in GROUPS:
        local[[INDEX[name] for name in names]] = rotations.exp(
            rng.uniform(-size_rad, size_rad, 3) / len(names)
        )
    return local


def naive_excess(local: Floats) -> Floats:
    out = np.zeros((len(GROUPS), 3))
    for g in range(len(GROUPS)):
        if LIMITS.axis[g] >= 0:
            j = LIMITS.joint[g]
            angles = swing_twist(local[j], int(LIMITS.axis[g])) / LIMITS.share[j]
            out[g] = angles - np.clip(angles, LIMITS.lower_rad[g], LIMITS.upper_rad[g])
    return out


@given(st.integers(0, 100_000))
def test_excess_equals_numpy_twin(seed: int) -> None:
    local = random_local(seed)
    cost, excess, _ = soft_limit(LIMITS, local)
    np.testing.assert_allclose(excess, naive_excess(local), atol=1e-6)
    assert cost == pytest.approx(0.5 * (excess**2).sum())


def test_derivative_equals_differences() -> None:
    model = build_model(1.75)
    checked = 0
    for seed in range(30):
        local = random_local(seed)
        _, excess, derivative = soft_limit(LIMITS, local)
        for g in range(len(GROUPS)):
            for k in range(3):
                ends = []
                for h in (-1e-5, 1e-5):
                    step = np.zeros(3 + 3 * len(GROUPS))
                    step[3 + 3 * g + k] = h
                    root, moved = np.zeros(3), np.empty_like(local)
                    retract(
                        root, local, step, model.group_of_joint, model.share_of_joint, root, moved
                    )
                    ends.append(naive_excess(moved)[g])
                slope = (ends[1] - ends[0]) / 2e-5
                outside = np.abs(excess[g]) > 1e-3
                np.testing.assert_allclose(
                    derivative[g, outside, k], slope[outside], atol=2e-4, rtol=1e-3
                )
                checked += int(outside.sum())
    assert checked > 200


def test_the_t_pose_and_a_bent_elbow_are_free_and_a_broken_one_is_not() -> None:
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    assert soft_limit(LIMITS, local)[0] == 0.0
    local[INDEX["leftLowerArm"]] = rotations.exp(np.radians([0.0, -140.0, 0.0]))
    local[INDEX["rightLowerArm"]] = rotations.exp(np.radians([0.0, 140.0, 0.0]))
    assert soft_limit(LIMITS, local)[0] == 0.0
    local[INDEX["leftLowerArm"]] = rotations.exp(np.radians([0.0, 40.0, 0.0]))
    assert soft_limit(LIMITS, local)[0] > 0.0


def test_swing_twist_round_trip() -> None:
    rng = np.random.default_rng(0)
    for axis in range(3):
        angles = rng.uniform(-1.5, 1.5, (50, 3))
        np.testing.assert_allclose(
            swing_twist(from_swing_twist(angles, axis), axis), angles, atol=1e-9
        )


def test_left_and_right_are_mirror_images() -> None:
    left, right = (SPACE.group(side + "UpperArm") for side in ("left", "right"))
    mirror = np.array([1.0, -1.0, -1.0])
    for a, b in ((LIMITS.lower_rad, LIMITS.upper_rad), (LIMITS.upper_rad, LIMITS.lower_rad)):
        np.testing.assert_allclose(a[right, 1:], mirror[1:] * b[left, 1:])
    np.testing.assert_allclose(LIMITS.lower_rad[right, 0], LIMITS.lower_rad[left, 0])
