"""Angles, reach, swings, symmetry and repetitions of motions that are known."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd_analysis.joint_angles import angles_of
from mocapd_analysis.joint_speeds import speeds_of
from mocapd_analysis.measures import measure
from mocapd_analysis.reach import reaches_of
from mocapd_analysis.repetitions import rhythm_of
from mocapd_analysis.session import Session, segments_of
from mocapd_analysis.symmetry import together
from tests.clients.analysis.motions import (
    AT,
    REST_M,
    session,
    standing,
    times,
    turning_arm,
    with_joint,
)

T = times(6.0)


def circling(radius_m: float, hz: float) -> Session:
    turn = 2.0 * np.pi * hz
    return with_joint(
        T,
        "leftHand",
        lambda t: (
            radius_m * np.stack([np.cos(turn * t), np.sin(turn * t), np.zeros_like(t)], axis=1)
        ),
    )


def test_a_circle_has_the_speed_and_acceleration_of_a_circle() -> None:
    turn = 2.0 * np.pi * 1.5
    speeds = speeds_of(circling(0.3, 1.5))
    hand = AT["leftHand"]
    np.testing.assert_allclose(speeds.speed_m_s[20:-20, hand], 0.3 * turn, rtol=0.005)
    np.testing.assert_allclose(speeds.acceleration_m_s2[20:-20, hand], 0.3 * turn**2, rtol=0.05)
    np.testing.assert_allclose(speeds.speed_m_s[:, AT["head"]], 0.0, atol=1e-9)


def test_the_way_of_a_circle_is_its_length() -> None:
    found = measure(circling(0.3, 1.5))
    assert found.joints["leftHand"].way_m == pytest.approx(9 * 2 * np.pi * 0.3, rel=0.01)
    assert found.joints["leftHand"].mean_speed_m_s == pytest.approx(0.9 * np.pi, rel=0.01)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0, 180.0])
def test_a_raised_arm_has_its_angle(degrees: float) -> None:
    angles = angles_of(session(T, turning_arm(T, "left", np.full(len(T), np.radians(degrees)))))
    np.testing.assert_allclose(angles["leftShoulder"], degrees, atol=2.0)  # the trunk's own lean
    np.testing.assert_allclose(angles["leftElbow"], 0.0, atol=1e-4)
    np.testing.assert_allclose(angles["rightShoulder"], 90.0, atol=5.0)


def test_elbow_and_knee_bend_by_what_they_are_bent() -> None:
    joints_m = standing(T)
    elbow, arm = AT["rightLowerArm"], REST_M[AT["rightLowerArm"]] - REST_M[AT["rightUpperArm"]]
    along = arm / np.linalg.norm(arm)
    up = np.array([0.0, 1.0, 0.0]) - along * along[1]
    up /= np.linalg.norm(up)
    bent = np.radians(70.0)
    joints_m[:, AT["rightHand"]] = REST_M[elbow] + 0.25 * (np.cos(bent) * along + np.sin(bent) * up)
    angles = angles_of(session(T, joints_m))
    np.testing.assert_allclose(angles["rightElbow"], 70.0, atol=1e-4)
    assert angles["leftKnee"].max() < 10.0  # standing


def test_twist_is_positive_with_the_left_shoulder_behind() -> None:
    joints_m = standing(T)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        wide = sign * 0.18
        # turned to the left by 40 degrees about +Y: the left shoulder goes back, to -Z
        turned = np.radians(40.0)
        joints_m[:, AT[f"{side}UpperArm"]] = [
            wide * np.cos(turned), 1.4, REST_M[AT["leftUpperLeg"], 2] - wide * np.sin(turned),
        ]  # fmt: skip
    np.testing.assert_allclose(angles_of(session(T, joints_m))["twist"], 40.0, atol=1.0)


def test_reach_is_the_persons_own_wherever_it_stands_and_looks() -> None:
    joints_m = turning_arm(T, "left", np.linspace(0.0, np.pi, len(T)))
    here = reaches_of(session(T, joints_m))["left"]
    quarter = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # faces +X
    there = reaches_of(session(T, joints_m @ quarter.T + np.array([3.0, 0.0, -2.0])))["left"]
    arm_m = np.linalg.norm(REST_M[AT["leftHand"]] - REST_M[AT["leftUpperArm"]])
    assert here.from_shoulder_m == pytest.approx(arm_m, abs=1e-6)
    shoulder = REST_M[AT["leftUpperArm"]]
    assert here.highest_m == pytest.approx(shoulder[1] + arm_m, abs=0.01)
    assert here.outward_m == pytest.approx(shoulder[0] + arm_m, abs=0.01)
    assert here.forward_m == pytest.approx(0.0, abs=0.05)
    for name in ("from_shoulder_m", "highest_m", "forward_m", "outward_m", "across_m", "up_m"):
        assert getattr(there, name) == pytest.approx(getattr(here, name), abs=1e-6)


def test_each_swing_is_found_at_its_time_and_speed() -> None:
    tops_s, speeds = (1.0, 2.5, 4.6), (3.0, 4.0, 3.5)

    def way(t: np.ndarray) -> np.ndarray:
        x = sum(
            sign * 0.1 * peak * np.tanh((t - at) / 0.1)
            for at, peak, sign in zip(tops_s, speeds, (1, -1, 1), strict=True)
        )
        return np.stack([x, 0.0 * t, 0.0 * t], axis=1)

    found = measure(with_joint(T, "rightHand", way))
    assert [swing.side for swing in found.swings] == ["right"] * 3
    assert [swing.at_s for swing in found.swings] == pytest.approx(tops_s, abs=0.01)
    assert [swing.peak_m_s for swing in found.swings] == pytest.approx(speeds, rel=0.03)
    assert found.best_swing is not None
    assert found.best_swing.peak_m_s == pytest.approx(4.0, rel=0.03)


def swinging(t: np.ndarray) -> np.ndarray:
    """Once by 0.8 m to +X, at 1.5 s, with 4 m/s; up a little."""
    x = 0.4 * np.tanh((t - 1.5) / 0.1)
    return np.stack([x, 0.1 * x, 0.0 * t], axis=1)


def test_a_swing_says_from_where_to_where() -> None:
    (swing,) = measure(with_joint(T, "rightHand", swinging)).swings
    half_s = 0.1 * np.arccosh(np.sqrt(2.0))
    assert (swing.start_s, swing.end_s) == pytest.approx((1.5 - half_s, 1.5 + half_s), abs=0.01)
    rest_m = REST_M[AT["rightHand"]]
    for at_s, place_m in ((swing.start_s, swing.start_m), (swing.end_s, swing.end_m)):
        assert place_m == pytest.approx(rest_m + swinging(np.array([at_s]))[0], abs=0.01)
    assert swing.way_m == pytest.approx(
        np.linalg.norm(np.subtract(swing.end_m, swing.start_m)), rel=0.03
    )


@pytest.mark.parametrize("rate_hz", [30.0, 60.0])
@pytest.mark.parametrize("leap_m", [0.15, 0.3, 0.6, 1.5])
def test_single_noisy_frames_are_no_swings(rate_hz: float, leap_m: float) -> None:
    """A hand that a tracker sets elsewhere for one frame, sure of itself."""
    rng, t_s = np.random.default_rng(7), times(8.0, rate_hz)
    joints_m = standing(t_s) + rng.normal(0.0, 0.003, (len(t_s), len(REST_M), 3))
    for frame in range(20, len(t_s) - 20, 23):
        way = rng.normal(size=3)
        joints_m[frame, AT["leftHand"]] += leap_m * way / np.linalg.norm(way)
    found = measure(session(t_s, joints_m))
    assert found.swings == ()
    if leap_m >= 0.3:  # what could not be a person's has no part in any figure
        assert found.joints["leftHand"].peak_speed.value < 1.0


@pytest.mark.parametrize("rate_hz", [30.0, 60.0])
@pytest.mark.parametrize("off_frames", [-1, 0, 1])
def test_a_hole_of_one_frame_loses_no_peak_and_makes_none(rate_hz: float, off_frames: int) -> None:
    """Of a frame that is missing, of a hand that is not seen in one, and of one that is wrong in it."""
    t_s = times(3.0, rate_hz)
    whole = with_joint(t_s, "rightHand", swinging)
    frame = int(np.argmin(np.abs(t_s - 1.5))) + off_frames
    missing = session(np.delete(t_s, frame), np.delete(whole.joints_m, frame, axis=0))
    confidence, wrong_m = whole.confidence.copy(), whole.joints_m.copy()
    confidence[frame, AT["rightHand"]] = 0.0
    wrong_m[frame, AT["rightHand"]] += [0.3, -0.8, 0.2]
    for one in (missing, session(t_s, wrong_m, confidence), session(t_s, wrong_m)):
        found = measure(one)
        (swing,) = found.swings
        assert swing.at_s == pytest.approx(1.5, abs=0.02)
        assert swing.peak_m_s == pytest.approx(4.02, rel=0.05)
        assert found.joints["rightHand"].peak_speed.value == pytest.approx(4.02, rel=0.05)


def test_a_swing_that_was_not_seen_is_none() -> None:
    one = circling(0.4, 1.5)
    hidden = one.confidence.copy()
    hidden[:, AT["leftHand"]] = 0.0
    found = measure(replace(one, confidence=hidden))
    assert found.swings == ()
    assert "leftHand" not in found.joints
    assert "leftElbow" not in found.angles


def test_where_the_hand_is_seen_again_is_no_swing() -> None:
    one = circling(0.4, 1.5)  # as fast all the time: there is no top
    hidden = one.confidence.copy()
    hidden[100:130, AT["leftHand"]] = 0.0
    assert measure(replace(one, confidence=hidden)).swings == ()


def test_symmetry_of_a_mirrored_motion_is_zero_and_of_half_a_motion_two_thirds() -> None:
    turn = 2.0 * np.pi
    angle = 1.0 + 0.5 * np.sin(turn * T)
    both = turning_arm(T, "left", angle)
    both[:, AT["rightLowerArm"]] = turning_arm(T, "right", angle)[:, AT["rightLowerArm"]]
    both[:, AT["rightHand"]] = turning_arm(T, "right", angle)[:, AT["rightHand"]]
    pairs = {pair.measure: pair.index_percent for pair in measure(session(T, both)).pairs}
    assert pairs["wrist way"] == pytest.approx(0.0, abs=0.1)
    half = turning_arm(T, "right", 1.0 + 0.25 * np.sin(turn * T))
    both[:, AT["rightHand"]] = half[:, AT["rightHand"]]
    pairs = {pair.measure: pair.index_percent for pair in measure(session(T, both)).pairs}
    assert pairs["wrist way"] == pytest.approx(100.0 * 2.0 / 3.0, abs=2.0)


def test_a_side_that_follows_is_told_with_its_delay() -> None:
    left = np.exp(-(((T % 2.0) - 0.7) ** 2) / 0.02)
    right = np.exp(-(((T % 2.0) - 1.0) ** 2) / 0.02)
    found = together(T, left, right)
    assert found is not None
    assert found.right_follows_s == pytest.approx(0.3, abs=0.02)
    assert found.best_correlation > 0.95 > found.correlation
    assert together(T, left, np.zeros(len(T))) is None


@pytest.mark.parametrize(
    ("hz", "seconds", "count"), [(1.0, 10.0, 10), (0.5, 16.0, 8), (2.0, 6, 12)]
)
def test_repetitions_are_counted(hz: float, seconds: float, count: int) -> None:
    t = times(seconds, 30.0)
    angle = 1.2 - 0.8 * np.cos(2.0 * np.pi * hz * t)
    random = np.random.default_rng(5)
    joints_m = turning_arm(t, "left", angle) + random.normal(scale=0.003, size=(len(t), 22, 3))
    repeated = measure(session(t, joints_m)).repetitions
    assert repeated is not None
    assert len(repeated.each) == count
    assert repeated.rhythm.period_s == pytest.approx(1.0 / hz, rel=0.05)
    tops_s = [one.top_s for one in repeated.each]
    assert tops_s == pytest.approx([(n + 0.5) / hz for n in range(count)], abs=0.1 / hz)


def test_what_does_not_repeat_has_no_repetitions() -> None:
    assert measure(session(T, standing(T))).repetitions is None
    assert rhythm_of(T, np.tanh(T - 3.0)) is None
    once = turning_arm(T, "left", 1.0 + np.tanh(T - 3.0))
    assert measure(session(T, once)).repetitions is None


def test_a_gap_parts_the_session_and_no_figure_goes_across() -> None:
    one = circling(0.3, 1.0)
    kept = (one.times_s < 2.0) | (one.times_s > 3.5)
    joints_m = one.joints_m[kept].copy()
    joints_m[one.times_s[kept] > 3.0] += 4.0  # somewhere else in the room
    found = measure(session(one.times_s[kept], joints_m))
    assert len(found.session.gaps_s) == 1
    assert found.session.gaps_s[0] == pytest.approx((2.0, 3.5), abs=0.04)
    assert found.joints["leftHand"].peak_speed.value == pytest.approx(0.6 * np.pi, rel=0.05)
    assert found.joints["hips"].way_m == pytest.approx(0.0, abs=1e-6)


def test_a_slow_recording_is_no_row_of_gaps() -> None:
    assert len(segments_of(np.arange(0.0, 10.0, 0.2))) == 1
    assert segments_of(np.array([])) == ()


def test_one_frame_is_survived() -> None:
    found = measure(session(np.array([0.0]), standing(np.array([0.0]))))
    assert found.swings == ()
    assert found.repetitions is None
    assert found.joints == {}
