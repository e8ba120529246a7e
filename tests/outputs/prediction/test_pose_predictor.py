"""A pose for a time without a frame: nearer to the truth than the last one, of the same bones, and never wild."""

import math
from collections.abc import Iterable

import msgspec
import numpy as np
import pytest

from mocapd.body.bones import PARENT_OF
from mocapd.outputs.prediction.pose_predictor import MOST_AHEAD_S, PosePredictor
from mocapd.outputs.wire import Joint, SkeletonFrame
from tests.outputs.frames import small_frame, whole_frame
from tests.outputs.prediction.moving import UNIX_NS, distance_m, frame_at, swinging, walking

AHEAD_S = 0.033
HANDS = ("leftHand", "rightHand")


def told(frames: Iterable[SkeletonFrame]) -> PosePredictor:
    predictor = PosePredictor()
    for frame in frames:
        predictor.take(frame)
    return predictor


def after(frame: SkeletonFrame, ahead_s: float) -> int:
    return frame.capture_unix_ns + round(ahead_s * 1e9)


def there(predictor: PosePredictor, unix_ns: int) -> SkeletonFrame:
    frame = predictor.at(unix_ns)
    assert frame is not None
    return frame


@pytest.mark.parametrize("rate_hz", [15, 30, 60])
def test_it_is_nearer_than_the_last_pose(rate_hz: int) -> None:
    predictor = PosePredictor()
    held, predicted = [], []
    for k in range(3 * rate_hz):
        frame = frame_at(k / rate_hz, swinging, walking)
        predictor.take(frame)
        truth = frame_at(k / rate_hz + AHEAD_S, swinging, walking)
        if k > rate_hz:
            held += [distance_m(frame, truth, hand) for hand in HANDS]
            found = there(predictor, truth.capture_unix_ns)
            predicted += [distance_m(found, truth, hand) for hand in HANDS]
    assert np.mean(np.square(predicted)) < 0.45**2 * np.mean(np.square(held))


def test_what_smoothing_delays_is_made_up_for() -> None:
    lag_s = 0.02
    smoothed = [
        msgspec.structs.replace(
            frame_at(k / 30.0 - lag_s, swinging, walking),
            capture_unix_ns=UNIX_NS + round(k / 30.0 * 1e9),
            smoothing_lag_ns=round(lag_s * 1e9),
        )
        for k in range(20)
    ]
    truth = frame_at(19 / 30.0, swinging, walking)
    found = there(told(smoothed), truth.capture_unix_ns)
    assert distance_m(found, truth, "hips") < 0.3 * distance_m(smoothed[-1], truth, "hips")
    assert found.smoothing_lag_ns == 0


def test_bones_keep_their_length_and_rotations_agree() -> None:
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    found = there(told(frames), after(frames[-1], 0.08))
    for name, joint in found.joints.items():
        assert math.hypot(*joint.r) == pytest.approx(1.0)
        assert joint.r[3] >= 0.0
        assert joint.l[3] >= 0.0
        if name in PARENT_OF:
            parent = PARENT_OF[name]
            now, before = (
                np.linalg.norm(np.subtract(one.joints[name].p, one.joints[parent].p))
                for one in (found, frames[-1])
            )
            assert now == pytest.approx(before, abs=1e-9)
    assert list(found.joints) == list(frames[-1].joints)


def test_a_frame_says_how_much_of_it_is_predicted() -> None:
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    found = there(told(frames), after(frames[-1], 0.02))
    assert found.predicted_ns == 20_000_000
    assert found.capture_unix_ns == after(frames[-1], 0.02)
    assert found.capture_monotonic_ns - frames[-1].capture_monotonic_ns == 20_000_000
    assert found.seq == frames[-1].seq


def test_who_stands_still_stays() -> None:
    frames = [frame_at(k / 30.0, lambda _: {}, lambda _: np.zeros(3)) for k in range(8)]
    found = there(told(frames), after(frames[-1], 0.05))
    assert max(distance_m(found, frames[-1], name) for name in found.joints) < 1e-9


def test_farther_than_anybody_can_tell_the_pose_stays() -> None:
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    predictor = told(frames)
    last = there(predictor, after(frames[-1], MOST_AHEAD_S))
    assert there(predictor, after(frames[-1], 3600.0)) == last
    assert distance_m(last, frames[-1], "leftHand") < 1.0


def test_the_past_and_the_lost_are_as_they_were_sent() -> None:
    assert PosePredictor().at(0) is None
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    predictor = told(frames)
    assert predictor.at(after(frames[-1], -0.01)) is frames[-1]
    lost = msgspec.structs.replace(frames[-1], tracking="lost", joints={})
    predictor.take(lost)
    assert predictor.at(after(lost, 0.05)) is lost


@pytest.mark.parametrize(
    "change",
    [
        {"capture_unix_ns": UNIX_NS + 5_000_000_000},
        {"capture_unix_ns": UNIX_NS - 5_000_000_000},
        {"instance": "another"},
        {"person": 1},
    ],
    ids=str,
)
def test_what_does_not_follow_begins_anew(change: dict[str, object]) -> None:
    """After a pause, a clock that was set, or of somebody else: no motion can be told from it."""
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    other = msgspec.structs.replace(frame_at(1.0, swinging, walking), **change)
    found = there(told([*frames, other]), after(other, 0.05))
    assert max(distance_m(found, other, name) for name in other.joints) < 1e-9


def test_a_frame_timed_just_after_another_is_no_leap() -> None:
    """A pose held while no camera delivered, then a delayed frame, which must not be timed before it."""
    seen = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    held = msgspec.structs.replace(seen[-1], capture_unix_ns=after(seen[-1], 0.15))
    late = msgspec.structs.replace(
        frame_at(8 / 30.0, swinging, walking), capture_unix_ns=held.capture_unix_ns + 1
    )
    found = there(told([*seen, held, late]), after(late, 0.05))
    assert max(distance_m(found, late, name) for name in late.joints) < 0.5


def test_cameras_of_several_rates_give_two_frames_of_an_instant_and_a_steady_prediction() -> None:
    """A set whose newest picture is older than the last set's is timed 1 ns after it."""
    predictor = PosePredictor()
    for k in range(20):
        for t_s in (k / 30.0, k / 30.0 + 1e-9, k / 30.0 + 0.012):
            frame = frame_at(t_s, swinging, walking)
            predictor.take(frame)
            truth = frame_at(t_s + AHEAD_S, swinging, walking)
            found = there(predictor, truth.capture_unix_ns)
            if k > 5:
                assert distance_m(found, truth, "hips") < 0.5 * distance_m(frame, truth, "hips")


@pytest.mark.parametrize("away_s", [0.16, 0.24, 0.4])
def test_after_a_held_pose_nobody_overshoots(away_s: float) -> None:
    """While no camera delivers, the last pose is sent again. The way of all that time is not made since the last of these
    frames."""
    seen = [frame_at(k / 30.0, lambda _: {}, walking) for k in range(8)]
    held = [
        msgspec.structs.replace(
            seen[-1], tracking="coasting", capture_unix_ns=after(seen[-1], held_s), cameras=()
        )
        for held_s in (0.15, 0.25, 0.35)
        if held_s < away_s
    ]
    predictor = told([*seen, *held])
    for k in range(4):
        frame = frame_at(7 / 30.0 + away_s + k / 30.0, lambda _: {}, walking)
        predictor.take(frame)
        moved_m = distance_m(there(predictor, after(frame, 0.04)), frame, "hips")
        assert moved_m < 0.06  # at 1.3 m/s it is 0.05 m


def test_what_nobody_sees_does_not_fly_off() -> None:
    seen, hidden = (
        [frame_at(k / 30.0, swinging, lambda _: np.zeros(3), sure) for k in range(8)]
        for sure in (1.0, 0.0)
    )
    moved_m = [
        distance_m(there(told(frames), after(frames[-1], 0.05)), frames[-1], "leftHand")
        for frames in (seen, hidden)
    ]
    assert moved_m[0] > 0.02
    assert moved_m[1] < 1e-9


def test_bones_that_come_and_go_do_no_harm() -> None:
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
    partly = [
        msgspec.structs.replace(
            frame,
            joints={n: joint for n, joint in frame.joints.items() if (k + i) % 3 or n == "hips"},
        )
        for k, frame in enumerate(frames)
        for i, _ in enumerate([0])
    ]
    strange = {**partly[-1].joints, "tail": frames[-1].joints["head"]}
    last = msgspec.structs.replace(frames[-1], joints=strange)
    found = there(told([*partly[:-1], last]), after(last, 0.033))
    assert set(found.joints) == set(strange)
    assert max(distance_m(found, last, name) for name in strange) < 0.5


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 1e300])
def test_numbers_that_are_none_stay_in_their_frame(number: float) -> None:
    """Such a frame is shown as it is; the ones after it are none the worse."""
    frames = [frame_at(k / 30.0, swinging, walking) for k in range(12)]
    spoilt = Joint((number,) * 3, (number,) * 4, (number,) * 4, number)
    bad = msgspec.structs.replace(frames[3], joints=dict.fromkeys(frames[3].joints, spoilt))
    predictor = told([*frames[:3], bad])
    assert set(there(predictor, after(bad, 0.05)).joints) == set(bad.joints)
    for frame in frames[4:]:
        predictor.take(frame)
    found = there(predictor, after(frames[-1], AHEAD_S))
    truth = frame_at(11 / 30.0 + AHEAD_S, swinging, walking)
    for hand in HANDS:
        assert distance_m(found, truth, hand) < distance_m(frames[-1], truth, hand)


def test_each_joint_keeps_how_certain_it_is() -> None:
    frame = whole_frame()
    found = there(told([frame]), after(frame, 0.03))
    for name, joint in frame.joints.items():
        assert (found.joints[name].c, found.joints[name].u) == (joint.c, joint.u)


def test_two_bones_are_enough() -> None:
    """As a message of another program might be."""
    first = small_frame()
    second = small_frame(capture_unix_ns=first.capture_unix_ns + 33_000_000)
    found = there(told([first, second]), second.capture_unix_ns + 33_000_000)
    assert list(found.joints) == list(first.joints)
    assert found.joints["leftUpperArm"].p == pytest.approx(first.joints["leftUpperArm"].p)
