"""A body as sent: sides, axes, times, and the lost one."""

import numpy as np
import pytest

from mocapd.body.skeleton import global_from_local
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.messages import CalibratedCamera
from mocapd.outputs.wire import SCHEMA, SkeletonFrame
from mocapd.types import BodyState, Camera, Rig, Tracking
from tests.outputs.frames import (
    CAPTURE_NS,
    PUBLISH_NS,
    UNIX_OFFSET_NS,
    left_hand_up,
    whole_frame,
)


def test_left_is_left_and_up_is_up() -> None:
    joints = whole_frame().joints
    head, left, right = (joints[name].p for name in ("head", "leftHand", "rightHand"))
    assert left[1] > head[1] + 0.2  # +Y is up
    assert right[1] == pytest.approx(joints["rightUpperArm"].p[1], abs=0.05)
    assert right[0] < head[0] < left[0] + 0.3  # facing +Z the left is towards +X
    assert joints["leftUpperArm"].p[0] > joints["rightUpperArm"].p[0]
    # the right shin points backwards, towards -Z, the left one down
    assert joints["rightFoot"].p[2] < joints["rightLowerLeg"].p[2] - 0.3
    assert joints["leftFoot"].p[1] < joints["leftLowerLeg"].p[1] - 0.3


def test_only_the_bone_that_turned_has_a_local_rotation() -> None:
    joints = whole_frame().joints
    quarter = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5))
    assert joints["leftUpperArm"].l == pytest.approx(quarter)
    assert joints["leftUpperArm"].r == pytest.approx(quarter)
    assert joints["leftHand"].r == pytest.approx(quarter)
    assert joints["leftHand"].l == pytest.approx((0.0, 0.0, 0.0, 1.0))
    assert joints["rightHand"].r == pytest.approx((0.0, 0.0, 0.0, 1.0))


def test_local_rotations_compose_to_the_global_ones() -> None:
    body, skeleton = left_hand_up()
    joints = whole_frame().joints
    assert tuple(joints) == skeleton.names
    composed = global_from_local(skeleton, np.array([joint.l for joint in joints.values()]))
    assert body.pose is not None
    assert rotations.angle_rad(composed, body.pose.quats_xyzw).max() < 1e-9


def test_times_and_names_are_carried_on() -> None:
    frame = whole_frame(seq=12)
    assert (frame.schema, frame.instance, frame.person, frame.seq) == (SCHEMA, "pc", 0, 12)
    assert frame.capture_monotonic_ns == CAPTURE_NS
    assert frame.capture_unix_ns == CAPTURE_NS + UNIX_OFFSET_NS
    assert frame.publish_monotonic_ns == PUBLISH_NS
    assert (frame.tracker, frame.tracking, frame.cameras) == ("colour", "live", ("left", "right"))
    assert [joint.c for joint in frame.joints.values()] == pytest.approx(np.linspace(0, 1, 22))


def test_an_uncertainty_is_in_tenths_of_a_millimetre_and_absent_where_nothing_is_known() -> None:
    joints = whole_frame().joints
    assert joints["hips"].u == 0.0101
    assert joints["leftHand"].u == 0.1001
    assert joints["leftFoot"].u is None


def test_lost_has_no_joints() -> None:
    body, skeleton = left_hand_up()
    lost = BodyState(CAPTURE_NS, Tracking.LOST, "colour", None, None, np.zeros(22))
    stale = BodyState(  # a pose that lingers in a lost body is not sent either
        CAPTURE_NS, Tracking.LOST, "colour", body.pose, body.joints_m, np.zeros(22)
    )
    for state in (lost, stale):
        frame = skeleton_frame(
            state,
            skeleton,
            instance="pc",
            seq=0,
            publish_monotonic_ns=0,
            unix_from_monotonic_ns=0,
        )
        assert isinstance(frame, SkeletonFrame)
        assert (frame.tracking, frame.joints) == ("lost", {})


def test_the_rig_is_sent_by_rows() -> None:
    K = np.arange(9.0).reshape(3, 3)
    camera = Camera("left", (640, 480), K, np.arange(5.0), K + 10, np.array([1.0, 2.0, 3.0]))
    (sent,) = calibration_info(Rig((camera,)), instance="pc", source="rig.json").cameras
    assert sent == CalibratedCamera(
        "left",
        (640, 480),
        K=(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0),
        dist=(0.0, 1.0, 2.0, 3.0, 4.0),
        R=(10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0),
        t_m=(1.0, 2.0, 3.0),
    )
