"""A bumped camera and two that are swapped are warned of once, with what to do; and once when it is over."""

import logging
import threading
from pathlib import Path

import pytest

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.calibrate.bump.landmarks import find_landmarks
from mocapd.capture.simulated.socket_camera import SocketCamera
from mocapd.capture.simulated.sockets import Sockets
from mocapd.clock import nanoseconds
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service import camera_watch
from mocapd.service.camera_watch import CameraWatch
from mocapd.service.room_memory import RoomMemory
from mocapd.service.view_watch import ViewWatch
from mocapd.types import Bytes, Camera, Frame, Rig
from tests.calibrate.distant_scene import Room, camera, turn
from tests.calibrate.test_changed_places import room
from tests.capture.socket_control import SocketControl
from tests.e2e.fake_cameras import FakeCamera
from tests.outputs.frames import eventually


class Watching:
    """A watch whose cameras show what a test wants, looked at every second."""

    def __init__(self, rig: Rig | None, *names: str) -> None:
        self.watch = CameraWatch([FakeCamera(name) for name in names], rig, FrameHub(names))
        self.names, self.seq = names, 0

    def show(self, *pictures: Bytes, times: int = 1) -> set[Mounting]:
        for _ in range(times):
            self.seq += 1
            for name, pixels in zip(self.names, pictures, strict=True):
                self.watch.put(Frame(name, self.seq, nanoseconds(self.seq), pixels))
            self.watch.look()
        return {self.watch.mounting(name) for name in self.names}


@pytest.fixture
def left() -> Room:
    return Room(camera("left"))


def alone(left: Room) -> Watching:
    return Watching(Rig((left.camera, camera("unplugged"))), "left")


def test_a_bump_is_logged_once_and_so_is_its_end(
    left: Room, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    one = alone(left)
    assert one.show(left.picture(), times=5) == {Mounting.STEADY}
    assert not caplog.records
    assert one.show(left.picture(turn("yaw", 2.0)), times=8) == {Mounting.BUMPED}
    [warning] = caplog.records
    assert warning.levelno == logging.WARNING
    assert "'left' was turned by about 2.0 degrees" in warning.message
    assert "mocapd calibrate --step room" in warning.message
    assert one.show(left.picture(), times=8) == {Mounting.STEADY}
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.INFO]


def test_the_same_picture_says_nothing_new_and_one_of_another_size_nothing_at_all(
    left: Room,
) -> None:
    one = alone(left)
    one.show(left.picture())
    for _ in range(5):
        one.watch.look()
    assert one.watch.mounting("left") is Mounting.UNKNOWN
    assert one.show(left.picture()[:120], times=5) == {Mounting.UNKNOWN}


def test_cameras_that_are_swapped_from_the_start_are_warned_of_with_what_to_do(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO)
    cameras, (a, b) = room("close")
    both = Watching(Rig(cameras), *(one.name for one in cameras))
    assert both.show(b, a, times=4) == {Mounting.SWAPPED}
    [warning] = caplog.records
    assert "'left' and 'right' have changed places" in warning.message
    assert "mocapd calibrate --step room" in warning.message
    assert "shows what 'right' should" in both.watch.notice("left")
    assert both.show(a, b, times=14) == {Mounting.STEADY}  # and not bumped from the wrong place
    assert both.watch.notice("left") == ""
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.INFO]


def test_cameras_that_are_exchanged_while_it_runs_are_known_by_the_rooms_that_they_showed(
    left: Room, caplog: pytest.LogCaptureFixture
) -> None:
    """Different cameras with nothing in view together: one that shows something else is not swapped."""
    right, else_where = Room(camera("right"), seed=1), Room(camera("right"), seed=2)
    both = Watching(Rig((left.camera, right.camera)), "left", "right")
    assert both.show(left.picture(), right.picture(), times=5) == {Mounting.STEADY}
    assert Mounting.SWAPPED not in both.show(right.picture(), else_where.picture(), times=3)
    assert both.show(right.picture(), left.picture(), times=15) == {Mounting.SWAPPED}
    assert "have changed places" in caplog.text
    assert both.show(left.picture(), right.picture(), times=5) == {Mounting.STEADY}


def identical(cameras: tuple[Camera, ...], folder: Path) -> tuple[Watching, FrameHub]:
    """Webcams that only their ports tell apart, and what takes their frames."""
    names = tuple(one.name for one in cameras)
    webcams = {name: f"usb:1-{k}:1bcf:28c4:" for k, name in enumerate(names, 1)}
    sockets = Sockets(SocketControl(folder / "sockets.json", webcams).path)
    sources = [SocketCamera(name, sockets, FakeCamera) for name in names]
    both, taken = Watching(None, *names), FrameHub(names)
    both.watch = CameraWatch(sources, Rig(cameras), taken, RoomMemory(folder))
    return both, taken


def test_identical_webcams_that_points_and_memory_call_swapped_keep_their_memory(
    tmp_path: Path,
) -> None:
    cameras, (a, b) = room("symmetrical")
    RoomMemory(tmp_path).write(
        {one.name: one for one in cameras},
        {
            one.name: [find_landmarks(pixels, one)]
            for one, pixels in zip(cameras, (a, b), strict=True)
        },
    )
    both, taken = identical(cameras, tmp_path)
    assert both.show(b, a, times=14) == {Mounting.SWAPPED}
    assert {taken.newest(name) for name in both.names} == {None}
    assert all("were swapped" in both.watch.notice(name) for name in both.names)
    for name in both.names:
        both.watch.went(name)
    assert both.show(a, b, times=5) == {Mounting.STEADY}


def test_identical_webcams_that_were_swapped_at_the_first_start_take_part_once_they_are_put_right(
    tmp_path: Path,
) -> None:
    cameras, (a, b) = room("close")
    both, taken = identical(cameras, tmp_path)
    watch, names = both.watch, both.names
    assert both.show(b, a, times=3) == {Mounting.SWAPPED}
    for name in names:
        watch.went(name)
    assert both.show(a, b, times=14) == {Mounting.STEADY}
    newest = taken.newest(names[0])
    assert newest is not None
    assert newest.seq == both.seq
    assert {watch.notice(name) for name in names} == {""}


def test_without_a_rig_nothing_is_known() -> None:
    nothing = Watching(None, "left")
    nothing.watch.start()
    nothing.watch.look()
    nothing.watch.stop()
    assert nothing.watch.mounting("left") is Mounting.UNKNOWN
    assert (nothing.watch.off_m, nothing.watch.notice("left")) == (0.0, "")


def test_the_checks_run_in_a_thread_of_their_own_and_its_error_ends_the_service(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They took a fifth of a second of the main thread's time, in the first second of a stream."""
    monkeypatch.setattr(camera_watch, "_LOOK_EVERY_S", 0.01)
    threads, errors = list[str](), list[BaseException]()

    def look(_watch: CameraWatch) -> None:
        threads.append(threading.current_thread().name)
        if len(threads) == 3:
            raise ValueError

    monkeypatch.setattr(CameraWatch, "look", look)
    monkeypatch.setattr(threading, "excepthook", lambda _: None)
    rig = Rig((camera("left"), camera("right")))
    sources = [FakeCamera(name) for name in rig.names]
    watch = CameraWatch(sources, rig, FrameHub(rig.names), on_death=errors.append)
    watch.start()
    assert eventually(lambda: bool(errors), 60.0)
    watch.stop()
    assert threads == ["camera-watch"] * 3
    assert isinstance(errors[0], ValueError)


def test_an_error_while_views_are_compared_is_handed_on_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    errors = list[BaseException]()

    def compare(_watch: ViewWatch) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(ViewWatch, "_compare", compare)
    monkeypatch.setattr(threading, "excepthook", lambda _: None)
    rig = Rig((camera("left"), camera("right")))
    watch = CameraWatch([], rig, FrameHub(rig.names), on_death=errors.append)
    watch.start()
    assert eventually(lambda: bool(errors), 60.0)
    watch.stop()
    assert isinstance(errors[0], ZeroDivisionError)
