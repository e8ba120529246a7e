"""What the viewer shows when, without a browser."""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import Floats, Ints
from mocapd_analysis.live.buffer import LONGEST_S, LiveBuffer
from mocapd_analysis.measures import measure
from mocapd_analysis.viewer.figure import (
    TRAIL_POINTS,
    cylinders,
    pose_at,
    trail_at,
    unit_cylinder,
    unit_sphere,
)
from mocapd_analysis.viewer.playback import RATES, Playback, rate_of
from mocapd_analysis.viewer.readings import PLOT_POINTS, reading, speed_window, summary
from tests.clients.analysis.motions import AT, session, times, turning_arm
from tests.outputs import recorded

T = times(4.0, 30.0)
WHOLE = session(T, turning_arm(T, "left", 0.5 * T))
KEPT = (T < 1.5) | (T > 2.5)
GAPPED = session(T[KEPT], WHOLE.joints_m[KEPT])


def test_a_pose_between_frames_lies_between_them() -> None:
    pose = pose_at(WHOLE, 0.5 * float(T[10] + T[11]))
    assert pose is not None
    np.testing.assert_allclose(pose, 0.5 * (WHOLE.joints_m[10] + WHOLE.joints_m[11]))


def test_nobody_is_shown_in_a_gap_before_and_after() -> None:
    assert pose_at(GAPPED, 2.0) is None
    assert pose_at(GAPPED, -0.5) is None
    assert pose_at(GAPPED, 9.0) is None
    assert pose_at(GAPPED, 4.0) is not None
    assert pose_at(GAPPED, 1.0) is not None


def test_a_trail_ends_at_the_hand_and_does_not_cross_a_gap() -> None:
    trail = trail_at(WHOLE, "leftHand", 2.0, 1.0)
    assert trail.shape == (TRAIL_POINTS, 3)
    np.testing.assert_allclose(trail[-1], WHOLE.positions_m("leftHand")[60], atol=1e-9)
    np.testing.assert_allclose(trail[0], WHOLE.positions_m("leftHand")[30], atol=1e-9)
    after = trail_at(GAPPED, "leftHand", 2.8, 2.0)
    first_after = GAPPED.positions_m("leftHand")[GAPPED.segments[1].start]
    np.testing.assert_allclose(after[0], first_after, atol=1e-9)


def test_cylinders_end_at_the_joints() -> None:
    joints_m = WHOLE.joints_m[50]
    middles, wxyz, scales = cylinders(joints_m, WHOLE.parents, np.full(22, 0.04))
    child = np.flatnonzero(WHOLE.parents >= 0)
    w, v = wxyz[:, :1], wxyz[:, 1:]
    up = np.tile([0.0, 0.5, 0.0], (len(child), 1)) * scales[:, 1:2]
    turned = up + 2.0 * np.cross(v, np.cross(v, up) + w * up)
    np.testing.assert_allclose(middles + turned, joints_m[child], atol=1e-9)
    np.testing.assert_allclose(middles - turned, joints_m[WHOLE.parents[child]], atol=1e-9)


@pytest.mark.parametrize("shape", [unit_cylinder, unit_sphere])
def test_what_a_person_is_made_of_is_closed_and_looks_outward(
    shape: Callable[[], tuple[Floats, Ints]],
) -> None:
    vertices, faces = shape()
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    assert (np.vecdot(normals, (a + b + c) / 3.0) > 0.0).all()
    edges = {(int(x), int(y)) for f in faces for x, y in zip(f, np.roll(f, -1), strict=True)}
    assert all((y, x) in edges for x, y in edges)


def test_slow_motion_and_the_end() -> None:
    playback = Playback(0.0, 2.0, 0.0, rate=rate_of("1/4"))
    playback.advance(1.0)
    assert playback.at_s == pytest.approx(0.25)
    playback.rate = 1.0
    playback.advance(2.0)
    assert playback.at_s == pytest.approx(0.25)  # again from the beginning
    playback.loop = False
    playback.advance(5.0)
    assert (playback.at_s, playback.playing) == (2.0, False)
    playback.seek(99.0)
    assert playback.at_s == 2.0
    assert [rate_of(words) for words in RATES] == [1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0, 2.0]


def test_stepping_goes_from_frame_to_frame() -> None:
    playback = Playback(0.0, 4.0, 1.0)
    playback.step(WHOLE, 1)
    assert playback.at_s == pytest.approx(float(T[31]))
    assert not playback.playing
    playback.step(WHOLE, -500)
    assert playback.at_s == 0.0


def test_a_still_session_of_one_frame_plays() -> None:
    playback = Playback(0.0, 0.0, 0.0)
    playback.advance(0.1)
    assert playback.at_s == 0.0


def test_the_panel_says_speed_angle_and_gap() -> None:
    found = measure(GAPPED)
    arm_m = np.linalg.norm(
        GAPPED.joints_m[0, AT["leftHand"]] - GAPPED.joints_m[0, AT["leftUpperArm"]]
    )
    assert f"{0.5 * arm_m:.2f} m/s" in reading(found, 1.0)
    assert "nobody was tracked" in reading(found, 2.0)
    assert "4.0 s, 30 Hz" in summary(found)
    window = speed_window(found, 1.0)
    assert {len(one) for one in window} == {PLOT_POINTS}
    assert all(np.isfinite(one).all() for one in window)


def lost(frame: SkeletonFrame) -> SkeletonFrame:
    return SkeletonFrame(**{f: getattr(frame, f) for f in frame.__struct_fields__} | {"joints": {}})


def test_a_live_session_grows_forgets_and_survives_what_is_no_pose() -> None:
    buffer = LiveBuffer("live")
    assert buffer.session() is None
    frames = recorded.frames(2.0, 30.0)
    assert all(buffer.add(frame) for frame in frames)
    assert not buffer.add(lost(frames[-1]))
    assert not buffer.add(frames[3])  # an old one
    assert buffer.refused == 1
    one = buffer.session()
    assert one is not None
    assert len(one.times_s) == len(frames)
    late = recorded.frame_at(LONGEST_S + 1.0, 9000)
    assert buffer.add(late)
    after = buffer.session()
    assert after is not None
    assert after.duration_s <= LONGEST_S
    assert len(after.gaps_s) == 1


def test_a_unix_clock_that_is_set_back_costs_a_live_session_no_frame() -> None:
    buffer = LiveBuffer("live")
    for frame in recorded.frames(2.0, 30.0):
        back_ns = 10 * 10**9 if frame.seq >= 30 else 0
        unix_ns = frame.capture_unix_ns - back_ns
        assert buffer.add(msgspec.structs.replace(frame, capture_unix_ns=unix_ns))
