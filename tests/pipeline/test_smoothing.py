"""A smoothed body keeps its bones, its state and its time, and starts afresh when it must."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.pipeline.smoothing import PRESETS, Smoother
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.trackers.canned.tracker import canned_pose
from mocapd.types import BodyState, Pose, Tracking

SKELETON = standard_skeleton(1.7)
STEP_NS = 33_333_333
N = len(SKELETON.names)


def body_at(t_ns: int, noise: np.random.Generator | None = None) -> BodyState:
    pose = canned_pose(SKELETON, CannedMotion(), t_ns)
    if noise is not None:
        wobble = rotations.exp(0.05 * noise.standard_normal((N, 3)))
        pose = Pose(
            pose.root_m + 0.01 * noise.standard_normal(3),
            rotations.multiply(wobble, pose.quats_xyzw),
        )
    joints_m = joint_positions(SKELETON, pose)
    return BodyState(t_ns, Tracking.LIVE, "canned", pose, joints_m, np.full(N, 0.5), ("a",))


def lost_at(t_ns: int) -> BodyState:
    return BodyState(t_ns, Tracking.LOST, "canned", None, None, np.zeros(N))


@pytest.mark.parametrize("preset", list(PRESETS))
def test_bones_keep_their_lengths_exactly(preset: str) -> None:
    smoother = Smoother(preset, SKELETON)
    rng = np.random.default_rng(5)
    parents = SKELETON.parents[1:]
    lengths = np.linalg.norm(SKELETON.rest_m[1:] - SKELETON.rest_m[parents], axis=1)
    for k in range(30):
        body = smoother.step(body_at(k * STEP_NS, rng))
        assert body.joints_m is not None
        got = np.linalg.norm(body.joints_m[1:] - body.joints_m[parents], axis=1)
        assert np.allclose(got, lengths, atol=1e-12)


def test_a_still_body_trembles_less() -> None:
    smoother = Smoother("balanced", SKELETON)
    rng = np.random.default_rng(6)
    raw, smooth = [], []
    still = body_at(0)
    assert still.pose is not None
    for k in range(120):
        pose = Pose(still.pose.root_m + 0.005 * rng.standard_normal(3), still.pose.quats_xyzw)
        body = replace(still, t_ns=k * STEP_NS, pose=pose, joints_m=joint_positions(SKELETON, pose))
        after = smoother.step(body)
        assert body.joints_m is not None
        assert after.joints_m is not None
        raw.append(body.joints_m[INDEX["head"]])
        smooth.append(after.joints_m[INDEX["head"]])
    assert np.std(smooth[30:], axis=0).mean() < 0.6 * np.std(raw[30:], axis=0).mean()


def test_only_pose_and_joints_change() -> None:
    smoother = Smoother("smooth", SKELETON)
    smoother.step(body_at(0))
    before = replace(body_at(STEP_NS), tracking=Tracking.COASTING)
    after = smoother.step(before)
    assert (after.t_ns, after.tracking, after.tracker, after.cameras) == (
        before.t_ns,
        before.tracking,
        before.tracker,
        before.cameras,
    )
    assert np.array_equal(after.confidence, before.confidence)


@pytest.mark.parametrize("preset", list(PRESETS))
def test_its_lag_adds_to_that_of_the_trackers_filter(preset: str) -> None:
    smoother, chosen = Smoother(preset, SKELETON), PRESETS[preset]
    after = smoother.step(replace(body_at(0), smoothing_lag_ns=7_000_000))
    own_s = 0.0 if chosen is None else chosen.lag_s
    assert after.smoothing_lag_ns == 7_000_000 + round(1e9 * own_s)


@pytest.mark.parametrize("interruption", ["lost", "gap", "backwards"])
def test_nothing_of_the_past_survives_an_interruption(interruption: str) -> None:
    smoother = Smoother("smooth", SKELETON)
    for k in range(10):
        smoother.step(body_at(k * STEP_NS))
    t_ns = 10 * STEP_NS
    if interruption == "lost":
        gone = lost_at(t_ns)
        assert smoother.step(gone) is gone
        t_ns += STEP_NS
    elif interruption == "gap":
        t_ns += 1_000_000_000
    else:
        t_ns = 0
    body = body_at(t_ns)
    after = smoother.step(body)
    assert body.joints_m is not None
    assert after.joints_m is not None
    assert np.allclose(after.joints_m, body.joints_m, atol=1e-12)


def test_off_hands_on_the_very_body() -> None:
    body = body_at(0)
    assert Smoother("off", SKELETON).step(body) is body


def test_a_refined_skeleton_takes_effect() -> None:
    smoother = Smoother("balanced", SKELETON)
    smoother.step(body_at(0))
    smoother.skeleton = standard_skeleton(1.9)
    after = smoother.step(body_at(STEP_NS))
    assert after.pose is not None
    assert after.joints_m is not None
    assert np.allclose(after.joints_m, joint_positions(smoother.skeleton, after.pose))


def test_an_unknown_preset_names_those_that_exist() -> None:
    with pytest.raises(ConfigError, match="off, responsive, balanced, smooth"):
        Smoother("silky", SKELETON)
