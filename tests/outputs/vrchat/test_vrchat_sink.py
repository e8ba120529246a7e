"""The VRChat sink before a strict VRChat: an asymmetric person arrives as it stands, and only what is seen of it."""

import socket
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

from mocapd.clock import NS_PER_S
from mocapd.errors import ConfigError, UnavailableError
from mocapd.geometry import rotations
from mocapd.outputs.messages import Facing
from mocapd.outputs.vrchat.vrchat_sink import Params, VRChatSink
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.worn_trackers import BodyPart
from tests.outputs.frames import free_port
from tests.outputs.receivers.vrchat import MIRROR, VRChatReceiver
from tests.outputs.vrchat.poses import known_but, of_the_shirt, stepping_left

ALL: tuple[BodyPart, ...] = ("hip", "feet", "chest", "knees", "elbows")
# number: joint where it is, bone that turns it; as SlimeVR's VRCOSCHandler.kt and HumanSkeleton.kt have it
SLIMEVR = {
    1: ("hips", "hips"),
    2: ("leftFoot", "leftFoot"),
    3: ("rightFoot", "rightFoot"),
    4: ("leftLowerLeg", "leftUpperLeg"),
    5: ("rightLowerLeg", "rightUpperLeg"),
    6: ("upperChest", "upperChest"),
    7: ("leftLowerArm", "leftUpperArm"),
    8: ("rightLowerArm", "rightUpperArm"),
}
RECENTRED = Facing("pc", 0, 0.0, 0)
MILLI_S = NS_PER_S // 1000


def looks_to_the_left_rad(frame: SkeletonFrame) -> float:
    """Where the head looks, from above."""
    x, _, z = rotations.rotate(np.array(frame.joints["head"].r), np.array([0.0, 0.0, 1.0]))
    return float(np.arctan2(x, z))


class Line:
    """A sink, and a VRChat at the other end of its socket."""

    def __init__(self, listening: socket.socket) -> None:
        self._listening = listening
        self.vrchat = VRChatReceiver(hmd_head_m=(2.0, 1.55, -1.0), hmd_yaw_deg=25.0)
        self.sink = VRChatSink(Params())

    def open(self, **params: object) -> None:
        host, port = self._listening.getsockname()
        self.sink = VRChatSink(Params(f"{host}:{port}", **params))  # type: ignore[arg-type]
        self.sink.open()

    def send(self, frame: SkeletonFrame) -> list[str]:
        """What arrived of this frame: the addresses below `/tracking/trackers/`."""
        self.sink.send(frame)
        try:
            datagram = self._listening.recv(65536)
        except BlockingIOError:
            return []
        seen = self.vrchat.take(datagram, frame.publish_monotonic_ns / NS_PER_S)
        with pytest.raises(BlockingIOError):
            self._listening.recv(65536)
        return [address.removeprefix("/tracking/trackers/") for address in seen]

    def numbers(self, frame: SkeletonFrame) -> list[int]:
        """The trackers in this frame."""
        names = [address.partition("/")[0] for address in self.send(frame)]
        return sorted({int(name) for name in names if name != "head"})


@pytest.fixture
def line() -> Iterator[Line]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        listening.setblocking(False)
        one = Line(listening)
        yield one
        one.sink.close()


@pytest.mark.parametrize("yaw_deg", [0.0, 70.0, -160.0])
def test_every_tracker_is_where_its_joint_is_and_turned_as_its_bone(
    line: Line, yaw_deg: float
) -> None:
    line.open(trackers=ALL)
    frame = stepping_left(yaw_deg=yaw_deg)
    line.send(frame)
    for number, (place, bone) in SLIMEVR.items():
        pose = line.vrchat.in_world(number)
        assert pose.position_m == pytest.approx(frame.joints[place].p, abs=1e-4)
        expected = rotations.to_matrix(np.array(frame.joints[bone].r))
        assert np.abs(pose.rotation - expected).max() < 1e-4


def test_who_faces_forward_looks_along_unitys_z_with_the_left_on_the_left(line: Line) -> None:
    line.open(trackers=ALL)
    line.send(stepping_left())
    at = {number: line.vrchat.tracker(number).position_m for number in SLIMEVR}
    assert at[2][0] < at[1][0] - 0.3 < at[3][0]  # stepping left, which is -x
    assert at[7][1] > at[8][1] + 0.3  # the left elbow is up
    assert at[4][2] > at[1][2]  # the left knee before the hip
    forward = line.vrchat.tracker(1).rotation @ [0.0, 0.0, 1.0]
    assert forward == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)


def test_hip_and_feet_and_the_heads_place_go_out_by_default(line: Line) -> None:
    line.open()
    expected = [f"{n}/{kind}" for n in (1, 2, 3) for kind in ("position", "rotation")]
    assert line.send(stepping_left()) == ["head/position", *expected]
    line.open(head=False)
    assert line.send(stepping_left()) == expected


def test_in_vrchat_the_body_hangs_below_the_headset(line: Line) -> None:
    """By the head's place alone; to be turned to the headset as well it takes a recentre."""
    line.open()
    for at_m in ((0.3, -0.4), (-1.0, 2.0)):
        frame = stepping_left(at_m=at_m)
        line.send(frame)
        joints = frame.joints
        for number, name in ((1, "hips"), (2, "leftFoot")):
            below = np.subtract(joints[name].p, joints["head"].p)
            expected = MIRROR @ below + line.vrchat.hmd_head_m
            assert line.vrchat.aligned(number).position_m == pytest.approx(expected, abs=1e-4)


def test_a_body_of_which_the_shirt_tells_no_legs_sends_none(line: Line) -> None:
    line.open(trackers=ALL)
    for number, trunk in enumerate((1.0, 0.9)):
        frame = stepping_left(confidence=of_the_shirt(trunk), now_ns=number * NS_PER_S)
        assert line.numbers(frame) == [1, 6, 7, 8]
    assert "not seen: left foot, right foot, left knee, right knee" in line.sink.status().detail


def test_a_tracker_ends_where_its_bone_is_hidden_and_does_not_flicker(line: Line) -> None:
    line.open(trackers=("hip", "feet", "elbows"), rate_hz=200.0)
    seen = []
    for number, value in enumerate((1.0, 0.2, 0.1, 0.05, 0.1, 0.14, 0.2)):
        confidence = known_but(value, "leftUpperArm")
        frame = stepping_left(confidence=confidence, now_ns=number * NS_PER_S // 30)
        seen.append(7 in line.numbers(frame))
    assert seen == [True, True, True, False, False, False, True]


def test_of_a_lost_person_nothing_is_sent(line: Line) -> None:
    line.open()
    assert line.send(stepping_left(live=False)) == []
    line.sink.send_state(RECENTRED)
    assert line.send(stepping_left(live=False, now_ns=NS_PER_S)) == []
    # the wish waits until somebody is there
    assert "head/rotation" in line.send(stepping_left(now_ns=2 * NS_PER_S))


@pytest.mark.parametrize("yaw_deg", [0.0, 70.0, 180.0, -160.0])
def test_a_recentre_turns_the_body_to_the_headset_at_once(line: Line, yaw_deg: float) -> None:
    line.open()
    now_ns = 0
    for _ in range(5):
        now_ns += NS_PER_S // 30
        frame = stepping_left(yaw_deg=yaw_deg, head_yaw_deg=15.0, now_ns=now_ns)
        assert "head/rotation" not in line.send(frame)
    line.sink.send_state(RECENTRED)
    to_left = 0.0
    for number in range(30):
        now_ns += NS_PER_S // 30
        moved = stepping_left(
            yaw_deg=yaw_deg + number, at_m=(0.1 * number, 0.0), head_yaw_deg=15.0, now_ns=now_ns
        )
        assert ("head/rotation" in line.send(moved)) is (number == 0)
        # the head looks where the headset looked at that moment, and everything else hangs on it
        to_left = looks_to_the_left_rad(moved) if number == 0 else to_left
        hmd = rotations.to_matrix(rotations.exp(np.array([0.0, np.radians(25.0), 0.0])))
        back = rotations.to_matrix(rotations.exp(np.array([0.0, -to_left, 0.0])))
        joints = moved.joints
        below = MIRROR @ back @ np.subtract(joints["leftFoot"].p, joints["head"].p)
        foot = line.vrchat.aligned(2)
        assert foot.position_m == pytest.approx(hmd @ below + line.vrchat.hmd_head_m, abs=1e-3)
        turned = MIRROR @ back @ rotations.to_matrix(np.array(joints["leftFoot"].r)) @ MIRROR
        assert np.abs(foot.rotation - hmd @ turned).max() < 1e-3
    assert (line.vrchat.snaps, line.vrchat.slerps) == (1, 0)


def test_after_a_recentre_the_person_faces_forward_or_by_the_yaw_that_is_set(line: Line) -> None:
    before, after = stepping_left(yaw_deg=100.0), stepping_left(yaw_deg=100.0, now_ns=NS_PER_S)
    head_to_hip = np.radians(100.0) - looks_to_the_left_rad(before)
    for own_deg in (0.0, 30.0):
        line.open(yaw_deg=own_deg)
        line.send(before)
        forward = line.vrchat.tracker(1).rotation @ [0.0, 0.0, 1.0]
        to_left = np.radians(100.0 + own_deg)
        assert forward == pytest.approx([-np.sin(to_left), 0.0, np.cos(to_left)], abs=1e-4)
        line.sink.send_state(RECENTRED)
        line.send(after)
        forward = line.vrchat.tracker(1).rotation @ [0.0, 0.0, 1.0]
        to_left = np.radians(own_deg) + head_to_hip
        assert forward == pytest.approx([-np.sin(to_left), 0.0, np.cos(to_left)], abs=1e-4)
        assert line.vrchat.degrees["head"] == pytest.approx([0.0, -own_deg, 0.0], abs=1e-4)


def test_recentres_in_a_hurry_keep_the_silence_that_lets_vrchat_snap(line: Line) -> None:
    line.open()
    turned_s = []
    for number in range(60):
        line.sink.send_state(RECENTRED)
        now_ns = number * NS_PER_S // 30
        if "head/rotation" in line.send(stepping_left(yaw_deg=3.0 * number, now_ns=now_ns)):
            turned_s.append(now_ns / NS_PER_S)
    assert len(turned_s) >= 4
    assert all(later - before > 0.3 for before, later in pairwise(turned_s))
    assert line.vrchat.slerps == 0


def test_a_head_that_only_follows_is_taken_from_the_chest(line: Line) -> None:
    line.open(trackers=("hip",))
    line.sink.send_state(RECENTRED)
    line.send(stepping_left(yaw_deg=40.0, head_yaw_deg=80.0, confidence=known_but(0.4, "head")))
    forward = line.vrchat.tracker(1).rotation @ [0.0, 0.0, 1.0]
    assert forward == pytest.approx([0.0, 0.0, 1.0], abs=0.02)


@pytest.mark.parametrize(
    ("came_hz", "cap_hz", "expected"), [(30, 60, 30), (90, 60, 60), (60, 60, 60), (120, 30, 30)]
)
def test_the_rate_is_capped_and_not_halved_by_jitter(
    line: Line, came_hz: int, cap_hz: float, expected: int
) -> None:
    line.open(rate_hz=cap_hz)
    jitter_ns = np.random.default_rng(1).uniform(-2.0, 2.0, 4 * came_hz) * MILLI_S
    sent = sum(
        bool(line.send(stepping_left(now_ns=round(i * NS_PER_S / came_hz + jitter_ns[i]))))
        for i in range(4 * came_hz)
    )
    assert sent == pytest.approx(4 * expected, rel=0.03)


def test_nobody_listening_is_a_state_and_the_first_frame_for_somebody_arrives() -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = VRChatSink(Params(f"127.0.0.1:{port}"))
    assert sink.status().detail.startswith("closed")
    sink.open()
    for number in range(5):
        sink.send(stepping_left(now_ns=number * NS_PER_S))
    status = sink.status()
    assert status.listeners == 0
    assert status.refused >= 4
    assert status.detail == f"no receiver on 127.0.0.1:{port}"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", port))
        listening.settimeout(5.0)
        for number in range(5, 8):
            sink.send(stepping_left(now_ns=number * NS_PER_S))
            VRChatReceiver().take(listening.recv(2000), float(number))
        assert sink.status().listeners == 1
    sink.close()
    sink.close()
    assert (sink.status().sent, sink.status().refused) == (3, 5)  # counted on when it is closed


@pytest.mark.parametrize("text", ["localhost:9000", "127.0.0.1", "127.0.0.1:0", "", "automatic"])
def test_a_destination_that_does_not_do_says_what_does(text: str) -> None:
    with pytest.raises(ConfigError, match=r"vrchat\.destination.*127\.0\.0\.1:9000"):
        Params(text)


def test_an_address_without_a_route_is_unavailable() -> None:
    with pytest.raises(UnavailableError, match=r"vrchat\.destination.*255\.255\.255\.255:9000"):
        VRChatSink(Params("255.255.255.255:9000")).open()
