"""The golden packets for VMT: the sender makes them, and a strict VMT makes of them the person as they stood."""

import json

import numpy as np
import pytest

from mocapd.geometry import rotations
from tests.golden import stepping_left
from tests.golden.make_vmt import TRACKERS, WORN, datagrams, kept, trackers_json
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.receivers.vmt import VmtReceiver


def test_the_files_are_what_is_sent() -> None:
    sent, files = datagrams(), kept()
    assert sent.keys() == files.keys()
    for name, data in sent.items():
        assert len(data) == len(files[name])
        for mine, theirs in zip(decoded(data), decoded(files[name]), strict=True):
            assert mine.address == theirs.address
            assert [v.tag for v in mine.values] == [v.tag for v in theirs.values]
            for a, b in zip(mine.values, theirs.values, strict=True):
                # another machine's sine may end in another bit
                assert a.value == (pytest.approx(b.value, abs=1e-6) if a.tag == "f" else b.value)
    mine, theirs = json.loads(trackers_json()), json.loads(TRACKERS.read_text())
    assert mine.keys() == theirs.keys()
    for name, told in mine.items():
        assert np.abs(np.array(told["p_m"]) - theirs[name]["p_m"]).max() < 2e-6
        assert np.abs(np.array(told["rows"]) - theirs[name]["rows"]).max() < 2e-6


def test_every_tracker_is_shown_where_its_joint_is_and_turned_as_its_bone() -> None:
    vmt, told = VmtReceiver(), json.loads(TRACKERS.read_text())
    messages = vmt.take(kept()["room_00"])
    assert [message.address for message in messages] == ["/VMT/Room/Driver"] * 8
    assert vmt.on == [*WORN]
    for number in WORN:
        shown = vmt.devices[number]
        assert np.abs(shown.position_m - told[f"VMT_{number}"]["p_m"]).max() < 1e-6
        assert np.abs(shown.rotation - told[f"VMT_{number}"]["rows"]).max() < 1e-5


def test_who_faces_forward_looks_along_minus_z_with_the_left_at_minus_x() -> None:
    vmt = VmtReceiver()
    vmt.take(kept()["room_00"])
    at = {number: vmt.devices[number].position_m for number in WORN}
    assert at[2][0] < at[1][0] < at[3][0] - 0.05  # stepping left, which is -x
    assert at[7][1] > at[8][1] + 0.3  # the left elbow is up
    assert at[7][0] < at[6][0] < at[8][0]
    forward = vmt.devices[1].rotation @ [0.0, 0.0, -1.0]
    assert forward[2] < -0.95


def test_below_the_headset_the_body_hangs_from_the_eyes() -> None:
    vmt = VmtReceiver(hmd_m=(2.0, 1.5, -1.0))
    messages = vmt.take(kept()["headset_00"])
    assert {message.address for message in messages} == {"/VMT/Follow/Driver"}
    joints = stepping_left.frame().joints
    head = joints["head"]
    eyes_m = np.array(head.p) + rotations.rotate(np.array(head.r), np.array([0.0, 0.08, 0.09]))
    for number, (place, _) in WORN.items():
        x, y, z = np.array(joints[place].p) - eyes_m
        assert np.abs(vmt.devices[number].position_m - [2.0 - x, 1.5 + y, -1.0 - z]).max() < 1e-5


def test_when_nobody_is_seen_every_tracker_is_switched_off() -> None:
    vmt = VmtReceiver()
    vmt.take(kept()["lost_00"])
    assert vmt.on == []
    assert not any(device.is_registered for device in vmt.devices)  # nor is any added by it
    vmt.take(kept()["room_00"])
    vmt.take(kept()["lost_00"])
    assert vmt.on == []
