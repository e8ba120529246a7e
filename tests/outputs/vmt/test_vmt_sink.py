"""The VMT sink before a strict VMT: what is seen is on, all else is off; headings, and what may be configured."""

import math
import socket
from collections.abc import Iterator

import numpy as np
import pytest

from mocapd.clock import NS_PER_S
from mocapd.config.effective import load_config
from mocapd.errors import ConfigError
from mocapd.outputs.messages import Facing
from mocapd.outputs.vmt.vmt_sink import Params, VmtSink
from mocapd.outputs.wire import SkeletonFrame
from tests.outputs.frames import free_port
from tests.outputs.receivers.vmt import PORT, VmtReceiver
from tests.outputs.vrchat.poses import known_but, of_the_shirt, stepping_left

RECENTRED = Facing("pc", 0, 0.0, 0)
STEP_NS = NS_PER_S // 30


class Line:
    """A sink, and a VMT at the other end of its socket."""

    def __init__(self, listening: socket.socket) -> None:
        self._listening = listening
        self.vmt = VmtReceiver()
        self.sink = VmtSink(Params())

    def open(self, **params: object) -> None:
        host, port = self._listening.getsockname()
        self.sink = VmtSink(Params(f"{host}:{port}", **params))  # type: ignore[arg-type]
        self.sink.open()

    def hear(self) -> bool:
        """Whether a datagram has come."""
        try:
            self.vmt.take(self._listening.recv(65536))
        except BlockingIOError:
            return False
        return True

    def send(self, frame: SkeletonFrame) -> bool:
        """Whether it was sent."""
        self.sink.send(frame)
        return self.hear()

    def heading_deg(self) -> float:
        """Where the hip's tracker looks: 0 is forward, positive to its left."""
        x, _, z = self.vmt.devices[1].rotation @ [0.0, 0.0, -1.0]
        return math.degrees(math.atan2(-x, -z))


@pytest.fixture
def line() -> Iterator[Line]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        listening.setblocking(False)
        one = Line(listening)
        yield one
        one.sink.close()


def test_the_port_is_vmts_and_all_trackers_go_out(line: Line) -> None:
    assert Params().destination == f"127.0.0.1:{PORT}"
    line.open()
    assert line.send(stepping_left())
    assert line.vmt.on == [1, 2, 3, 4, 5, 6, 7, 8]


def test_legs_that_the_shirt_does_not_show_are_off_and_named(line: Line) -> None:
    line.open()
    line.send(stepping_left())
    assert line.vmt.on == [1, 2, 3, 4, 5, 6, 7, 8]
    line.send(stepping_left(confidence=of_the_shirt(), now_ns=STEP_NS))
    assert line.vmt.on == [1, 6, 7, 8]
    assert "not seen: left foot, right foot, left knee, right knee" in line.sink.status().detail


def test_a_person_who_is_lost_and_a_daemon_that_ends_leave_no_tracker_standing(line: Line) -> None:
    line.open()
    line.send(stepping_left())
    assert len(line.vmt.on) == 8
    line.send(stepping_left(live=False, now_ns=STEP_NS))
    assert line.vmt.on == []
    line.send(stepping_left(now_ns=2 * STEP_NS))
    assert len(line.vmt.on) == 8
    line.sink.close()
    assert line.hear()
    assert line.vmt.on == []


def test_what_was_never_on_is_not_switched_off_at_the_end(line: Line) -> None:
    line.open()
    line.sink.close()
    assert not line.hear()


@pytest.mark.parametrize("yaw_deg", [0.0, 70.0, -160.0])
def test_a_recentre_makes_where_the_person_looks_forward(line: Line, yaw_deg: float) -> None:
    line.open()
    line.send(stepping_left(yaw_deg=yaw_deg))
    assert line.heading_deg() == pytest.approx(yaw_deg, abs=1e-3)
    line.sink.send_state(RECENTRED)
    line.send(stepping_left(live=False, now_ns=STEP_NS))  # the wish waits for somebody
    line.send(stepping_left(yaw_deg=yaw_deg, now_ns=2 * STEP_NS))
    assert line.heading_deg() == pytest.approx(0.0, abs=3.0)  # head and hips are not quite one
    apart = line.vmt.devices[2].position_m - line.vmt.devices[3].position_m
    assert apart[0] < -0.3  # the left foot is at the left
    line.send(stepping_left(yaw_deg=yaw_deg + 30.0, now_ns=3 * STEP_NS))
    assert line.heading_deg() == pytest.approx(30.0, abs=3.0)


def test_without_a_head_nothing_hangs_below_the_headset(line: Line) -> None:
    line.open(anchor="headset")
    line.send(stepping_left(confidence=known_but(0.0, "neck")))
    assert line.vmt.on == []
    line.send(stepping_left(now_ns=STEP_NS))
    hip, foot = (line.vmt.devices[number].position_m for number in (1, 2))
    assert line.vmt.hmd_m[1] - 0.9 < hip[1] < line.vmt.hmd_m[1] - 0.4
    assert foot[1] < hip[1] - 0.5
    line.vmt.hmd_m = np.array([1.0, 1.2, 3.0])
    line.send(stepping_left(at_m=(-2.0, 5.0), now_ns=2 * STEP_NS))
    assert line.vmt.devices[1].position_m == pytest.approx(hip + [1.0, -0.4, 3.0], abs=1e-5)


def test_when_nobody_listens_that_is_counted() -> None:
    sink = VmtSink(Params(f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}"))
    sink.open()
    for number in range(5):
        sink.send(stepping_left(now_ns=number * STEP_NS))
    assert sink.status().refused >= 1
    assert "no receiver" in sink.status().detail
    sink.close()
    sink.close()
    assert sink.status().detail == "closed"


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("vmt.destination", "localhost:39570", "not localhost"),
        ("vmt.anchor", "belt", "headset"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(key: str, value: str, said: str) -> None:
    with pytest.raises(ConfigError, match=key) as caught:
        load_config({key: value}, env={}, candidates=())
    assert said in str(caught.value)
