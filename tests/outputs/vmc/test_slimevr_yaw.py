"""A body that turns and walks keeps its yaw in SlimeVR, minutes later as at the beginning: what docs/slimevr.md promises."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.types import Floats, Pose
from tests.outputs.frames import left_hand_up
from tests.outputs.receivers.slimevr import SlimevrInput
from tests.outputs.vmc.posed_by import posed

TURNS_DEG = (0.0, 35.0, -70.0, 120.0, 179.0)
PAIRS = (("LeftUpperLeg", "RightUpperLeg"), ("LeftUpperArm", "RightUpperArm"))


def yaw_rad(left_m: Floats, right_m: Floats) -> float:
    """About +Y, where the line from the right joint to the left one points."""
    x, _, z = left_m - right_m
    return math.atan2(-z, x)


@pytest.mark.parametrize("after_s", [0.0, 120.0])
def test_the_yaw_of_hips_and_chest_is_that_of_the_body(after_s: float) -> None:
    body, skeleton = left_hand_up()
    assert body.pose is not None
    encoder, receiver = (
        VmcEncoder(vmc_heading(0.0, 0.0, by_root=False), False, "one", None),
        SlimevrInput(),
    )
    rest = rest_skeleton(skeleton, instance="pc", stature_m=1.75)
    for number, turn_deg in enumerate(TURNS_DEG):
        turn = rotations.exp(np.radians([0.0, turn_deg, 0.0]))
        quats_xyzw = rotations.multiply(turn, body.pose.quats_xyzw)
        pose = Pose(body.pose.root_m + [0.3 * number, 0.0, 0.1], quats_xyzw)
        joints_m = joint_positions(skeleton, pose)
        frame = skeleton_frame(
            replace(body, pose=pose, joints_m=joints_m),
            skeleton,
            instance="pc",
            seq=number,
            publish_monotonic_ns=round(after_s * 1e9) + number,
            unix_from_monotonic_ns=0,
        )
        sent = encoder.encode(frame, rest, calibration=1, time_s=after_s + number)
        found = posed(receiver, sent)
        for left, right in PAIRS:
            names = [name[0].lower() + name[1:] for name in (left, right)]
            true_rad = yaw_rad(*(joints_m[INDEX[name]] for name in names))
            off_rad = yaw_rad(found[left], found[right]) - true_rad
            assert math.degrees(math.remainder(off_rad, math.tau)) == pytest.approx(0.0, abs=0.1)
