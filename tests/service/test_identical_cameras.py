"""Two identical webcams: held back after both were unplugged, until each sees its own room."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.boundary.image_decoding import decode_picture
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.simulated.sim import SimSource
from mocapd.capture.simulated.socket_camera import SocketCamera
from mocapd.capture.simulated.sockets import Sockets
from mocapd.service.camera_watch import CameraWatch
from mocapd.service.room_memory import FILE_NAME, RoomMemory
from mocapd.sim.film import Film, load_film
from mocapd.types import Bytes, Frame, Rig
from tests.capture.socket_control import SocketControl
from tests.sim import small

ALIKE = {"left": "usb:1-1:1bcf:28c4:", "right": "usb:1-2:1bcf:28c4:"}
S = 1_000_000_000


@pytest.fixture(scope="module")
def film(cache_home: Path) -> Film:
    return load_film(small.scenario(), cache_home)


@dataclass
class Through:
    """What comes through."""

    frames: list[Frame] = field(default_factory=list)

    def put(self, frame: Frame, /) -> None:
        self.frames.append(frame)


def wait_until(condition: Callable[[], bool]) -> bool:
    pause = threading.Event()
    return any(condition() or pause.wait(0.01) for _ in range(1000))


class Daemon:
    """The watch as a session has it, whose cameras show what a test wants."""

    def __init__(
        self,
        film: Film,
        folder: Path,
        webcams: dict[str, str],
        rig: Rig | None,
        memory: RoomMemory | None = None,
    ) -> None:
        control = SocketControl(folder / "sockets.json", webcams)
        sockets = Sockets(control.path)
        sources = [SocketCamera(name, sockets, lambda w: SimSource(film, w)) for name in webcams]
        self.film, self.through = film, Through()
        self.watch = CameraWatch(sources, rig, self.through, memory)
        self._t_ns = 0

    def send(
        self, camera: str, seen_by: str = "", index: int = 0, pixels: Bytes | None = None
    ) -> bool:
        """A frame of a camera, of what some webcam sees, then a look; whether it came through."""
        self._t_ns += S
        jpegs = self.film.frames[seen_by or camera]
        if pixels is None:
            pixels = decode_picture(jpegs[index % len(jpegs)], cv2.IMREAD_COLOR)
        self.watch.put(Frame(camera, self._t_ns // S, self._t_ns, pixels))
        self.watch.look()
        return bool(self.through.frames) and self.through.frames[-1].t_ns == self._t_ns

    def both_unplugged(self) -> None:
        for name in ALIKE:
            self.watch.went(name)


@pytest.fixture
def daemon(film: Film, tmp_path: Path) -> Daemon:
    daemon = Daemon(film, tmp_path, ALIKE, film.setup.rig)
    for name in ALIKE:
        assert daemon.send(name)
    return daemon


def test_back_where_they_were_they_are_known_by_what_they_see(daemon: Daemon) -> None:
    daemon.both_unplugged()
    for name in ALIKE:
        assert not daemon.send(name, index=20)
        assert daemon.send(name, index=21)
        assert daemon.watch.notice(name) == ""


def test_swapped_they_take_no_part_until_they_are_put_back(daemon: Daemon) -> None:
    daemon.both_unplugged()
    for name, other in (("left", "right"), ("right", "left")):
        assert not daemon.send(name, seen_by=other, index=20)
        assert not daemon.send(name, seen_by=other, index=21)
        assert f"sees what {other} saw" in daemon.watch.notice(name)
        assert "plug each into the port where it was" in daemon.watch.notice(name)
        assert daemon.watch.mounting(name) is Mounting.SWAPPED
    daemon.both_unplugged()
    for name in ALIKE:
        daemon.send(name)
        assert daemon.send(name)
        assert daemon.watch.mounting(name) is not Mounting.SWAPPED


def test_what_is_known_of_neither_is_asked_about(daemon: Daemon) -> None:
    daemon.both_unplugged()
    anywhere = np.random.default_rng(3).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    anywhere = np.asarray(cv2.GaussianBlur(anywhere, (0, 0), 2.0), np.uint8)
    assert not daemon.send("left", pixels=anywhere)
    assert not daemon.send("left", pixels=anywhere)
    assert "cannot be distinguished from right" in daemon.watch.notice("left")
    assert "restart mocapd" in daemon.watch.notice("left")


def test_one_that_is_unplugged_alone_is_not_doubted(daemon: Daemon) -> None:
    daemon.watch.went("left")
    assert daemon.send("right")
    assert daemon.send("left", seen_by="right")  # in its own port, and the other one is in its own
    daemon.watch.went("right")
    assert daemon.send("right")


def test_before_either_was_seen_whoever_starts_is_believed(film: Film, tmp_path: Path) -> None:
    daemon = Daemon(film, tmp_path, ALIKE, film.setup.rig)
    daemon.both_unplugged()
    for name in ALIKE:
        assert daemon.send(name)


def test_the_last_of_two_is_itself_when_the_other_is_known(film: Film, tmp_path: Path) -> None:
    daemon = Daemon(film, tmp_path, ALIKE, film.setup.rig)
    daemon.watch.went("right")
    assert daemon.send("left")
    daemon.watch.went("left")
    assert not daemon.send("right")
    daemon.send("left")
    assert daemon.send("left")
    daemon.send("right")
    assert daemon.send("right")


@pytest.mark.parametrize("case", ["other serials", "not calibrated"])
def test_cameras_that_cannot_be_confused_are_not_held(
    film: Film, tmp_path: Path, case: str
) -> None:
    serials = {"left": ALIKE["left"] + "A", "right": ALIKE["right"] + "B"}
    webcams = serials if case == "other serials" else ALIKE
    rig = film.setup.rig if case == "other serials" else None
    daemon = Daemon(film, tmp_path, webcams, rig)
    for name in ALIKE:
        daemon.send(name)
    daemon.both_unplugged()
    for name in ALIKE:
        assert daemon.send(name)


Restart = Callable[..., Daemon]


@pytest.fixture
def again(film: Film, tmp_path: Path) -> Restart:
    """Starts a daemon that remembers one that ran before."""

    def start(rig: Rig | None = None) -> Daemon:
        return Daemon(film, tmp_path, ALIKE, rig or film.setup.rig, RoomMemory(tmp_path))

    before = start()
    for name in ALIKE:
        assert before.send(name)
    assert wait_until((tmp_path / FILE_NAME).exists)
    assert (tmp_path / FILE_NAME).stat().st_mode & 0o777 == 0o600
    return start


def test_swapped_while_mocapd_was_off_they_take_no_part(again: Restart) -> None:
    daemon = again()
    for name, other in (("left", "right"), ("right", "left")):
        assert not daemon.send(name, seen_by=other, index=9)
        assert not daemon.send(name, seen_by=other, index=10)
        assert f"sees what {other} saw" in daemon.watch.notice(name)


def test_as_they_were_they_are_known_after_a_start(again: Restart) -> None:
    daemon = again()
    for name in ALIKE:
        daemon.send(name, index=9)
        assert daemon.send(name, index=10)
        assert daemon.watch.notice(name) == ""


def test_what_they_see_after_a_start_and_never_saw_is_believed_and_told(
    again: Restart,
) -> None:
    daemon = again()
    dark = np.zeros((120, 160, 3), np.uint8)
    daemon.send("left", pixels=dark)
    assert daemon.send("left", pixels=dark)
    assert "does not see what it saw when mocapd ran last" in daemon.watch.notice("left")
    daemon.send("left")  # the light goes on
    assert daemon.send("left")
    assert daemon.watch.notice("left") == ""


def test_another_calibration_begins_anew(again: Restart, film: Film) -> None:
    moved = Rig(tuple(replace(one, t_m=one.t_m + 0.1) for one in film.setup.rig.cameras))
    daemon = again(moved)
    assert daemon.send("left", seen_by="right")


@pytest.mark.parametrize("damage", [b"", b"x" * 100, b"cut"])
def test_a_damaged_memory_is_told_and_made_anew(
    again: Restart,
    film: Film,
    tmp_path: Path,
    damage: bytes,
    caplog: pytest.LogCaptureFixture,
) -> None:
    path = tmp_path / FILE_NAME
    path.write_bytes(path.read_bytes()[:-7] if damage == b"cut" else damage)
    daemon = again()
    assert "rooms_of_twins.msgpack cannot be used (its checksum does not fit)" in caplog.text
    assert len([*tmp_path.glob(f"{FILE_NAME}.corrupt-*")]) == 1
    for name in ALIKE:
        assert daemon.send(name)
    cameras = {camera.name: camera for camera in film.setup.rig.cameras}
    assert wait_until(lambda: len(RoomMemory(tmp_path).read(cameras)) == 2)
    assert not again().send("left")  # it is remembered, so looked at first


def test_where_nothing_can_be_kept_it_is_told_once(
    film: Film, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").touch()
    memory = RoomMemory(tmp_path / "file" / "state")
    daemon = Daemon(film, tmp_path, ALIKE, film.setup.rig, memory)
    for _ in range(2):
        for name in ALIKE:
            assert daemon.send(name)
    assert wait_until(lambda: "cannot be saved for the next start" in caplog.text)
    memory.write({}, {})
    assert caplog.text.count("cannot be saved for the next start") == 1
