"""Cameras that freeze, vanish or come back changed: the others go on, and subscribers and status are told."""

import socket
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise, takewhile
from typing import Any

import pytest
from pythonosc.osc_bundle import OscBundle

from mocapd.app.terminal.status_line import status_text
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.service.health import camera_message
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.types import Tracking
from tests.capture.films import SIZE_PX
from tests.e2e.fake_cameras import FakeCamera, daemon_on


@dataclass(frozen=True)
class Heard:
    """The beginning of one body as it came over OSC."""

    seq: int
    joints: int
    capture_ns: int
    tracking: str
    cameras: str


class Game:
    """Listens on a port of its own."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(10.0)
        self.port: int = self._socket.getsockname()[1]
        self.heard: list[Heard] = []

    def hear_until(self, enough: Callable[[Heard], bool]) -> list[Heard]:
        """What comes from now on, up to the body that is enough."""
        began = len(self.heard)
        while True:
            head: Any = next(iter(OscBundle(self._socket.recv(2000)))).params
            _, seq, part, _, joints, capture_s, capture_ns, _, tracking, _, cameras, _ = head
            if part > 0:
                continue
            t_ns = (capture_s % 2**32) * 10**9 + capture_ns
            self.heard.append(Heard(seq, joints, t_ns, tracking, cameras))
            if enough(self.heard[-1]):
                return self.heard[began:]

    def close(self) -> None:
        self._socket.close()


@pytest.fixture
def game() -> Iterator[Game]:
    game = Game()
    yield game
    game.close()


def wait_until(condition: Callable[[], bool]) -> bool:
    """Whether it became true within a minute."""
    pause = threading.Event()
    return any(condition() or pause.wait(0.01) for _ in range(6000))


def status_of(daemon: Service, name: str) -> CaptureStatus:
    return daemon.statuses()[name]


@pytest.mark.parametrize("how", ["frozen", "unplugged"])
def test_when_no_camera_delivers_subscribers_hear_coasting_then_lost(game: Game, how: str) -> None:
    cameras = FakeCamera("a"), FakeCamera("b")
    with daemon_on(*cameras, osc_port=game.port) as daemon:
        game.hear_until(lambda one: one.seq >= 20)
        for camera in cameras:
            getattr(camera, how).set()
        game.hear_until(lambda one: one.tracking == "lost")
        game.hear_until(lambda one: one.tracking == "lost")
        gone = list(takewhile(lambda one: one.tracking != "live", reversed(game.heard)))[::-1]
        snapshot = daemon.snapshot()
        assert snapshot.metrics.tracking is Tracking.LOST
        assert "canned lost" in status_text(snapshot)
        assert snapshot.metrics.latency_ms.p95 < 1000.0  # of frames only
        assert wait_until(lambda: daemon.snapshot().metrics.rate_hz == 0.0)
        for camera in cameras:
            getattr(camera, how).clear()
        game.hear_until(lambda one: one.tracking == "live")
        assert not daemon.wait(0.0)
    assert len(gone) > 3
    assert [one.tracking for one in gone] == ["coasting"] * (len(gone) - 2) + ["lost"] * 2
    assert all(one.joints == 22 for one in gone[:-2])
    assert all(one.joints == 0 for one in gone[-2:])
    assert all(one.cameras == "" for one in gone)
    assert all(b.seq == a.seq + 1 for a, b in pairwise(game.heard))
    assert all(b.capture_ns > a.capture_ns for a, b in pairwise(game.heard))


def test_of_two_cameras_one_freezes_and_the_other_goes_on(game: Game) -> None:
    frozen, other = FakeCamera("a"), FakeCamera("b")
    with daemon_on(frozen, other, osc_port=game.port) as daemon:
        game.hear_until(lambda one: one.cameras == "a,b")
        frozen.frozen.set()
        game.hear_until(lambda one: one.cameras == "b")
        went_on = game.hear_until(lambda _: status_of(daemon, "a").is_silent)
        assert "lost" not in {one.tracking for one in went_on}
        assert len(went_on) > 5  # of some sixty, on a machine with nothing else to do
        snapshot = daemon.snapshot()
        assert "a silent 1 s" in status_text(snapshot)
        assert wait_until(lambda: status_of(daemon, "a").fps_hz == 0.0)
        message = camera_message(
            "home",
            CameraInput(frozen, "test"),
            status_of(daemon, "a"),
            snapshot.metrics.cameras["a"],
            snapshot.mountings["a"],
        )
        assert (message.state, message.rate_hz) == ("live", 0.0)
        assert message.detail.startswith("silent for")
        assert status_of(daemon, "b").fps_hz > 0.0


def test_a_camera_back_in_another_size_is_lost_and_the_other_goes_on(game: Game) -> None:
    changed, other = FakeCamera("a"), FakeCamera("b")
    with daemon_on(changed, other, osc_port=game.port) as daemon:
        game.hear_until(lambda one: one.cameras == "a,b")
        changed.other_size.set()
        changed.unplugged.set()
        assert wait_until(lambda: "320x240" in status_of(daemon, "a").reason)
        assert status_of(daemon, "a").state is CaptureState.LOST
        newest = len(game.heard)
        game.hear_until(lambda one: len(game.heard) > newest + 20)
        assert game.heard[-1].cameras == "b"
        assert not daemon.wait(0.0)
        changed.unplugged.clear()
        changed.other_size.clear()
        game.hear_until(lambda one: one.cameras == "a,b")


def test_a_camera_that_a_setup_opens_in_another_size_takes_no_part_meanwhile(game: Game) -> None:
    changed, other = FakeCamera("a"), FakeCamera("b")
    with daemon_on(changed, other, osc_port=game.port) as daemon:
        game.hear_until(lambda one: one.cameras == "a,b")
        changed.size_px = (32, 24)
        game.hear_until(lambda one: one.cameras == "b")
        newest = len(game.heard)
        game.hear_until(lambda _: len(game.heard) > newest + 20)
        assert not daemon.wait(0.0)
        changed.size_px = SIZE_PX
        game.hear_until(lambda one: one.cameras == "a,b")


def test_of_recordings_that_stop_nothing_is_told(game: Game) -> None:
    camera = FakeCamera("a", recorded=True)
    with daemon_on(camera, osc_port=game.port) as daemon:
        game.hear_until(lambda one: one.seq >= 10)
        camera.frozen.set()
        assert wait_until(lambda: status_of(daemon, "a").is_silent)
        newest = daemon.bodies.newest()
        assert newest is not None
        assert newest.body.tracking is Tracking.LIVE
