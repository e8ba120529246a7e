"""Webcams pulled out, put back, into other ports, swapped and ailing: which is found, what is told, how it comes back."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.camera_thread.reopening import BackOff, RestartBudget
from mocapd.capture.camera_thread.thread import MOST_STUCK, CaptureThread
from mocapd.capture.simulated.sim import SimSource
from mocapd.capture.simulated.socket_camera import SocketCamera
from mocapd.capture.simulated.sockets import Fault, Sockets
from mocapd.clock import monotonic_ns
from mocapd.errors import InputError
from mocapd.sim.film import Film
from mocapd.types import Frame
from tests.capture.films import number_of, numbered_sim_film, picture
from tests.capture.socket_control import SocketControl

SERIALS = {"cam0": "usb:1-1:046d:0825:A0", "cam1": "usb:1-2:046d:0825:B1"}
TWINS = {"cam0": "usb:1-1:1bcf:28c4:", "cam1": "usb:1-2:1bcf:28c4:"}
QUICK = BackOff(first_s=0.01, longest_s=0.05)


def two_films() -> Film:
    """cam0 sees the numbers from 0, cam1 those from 100."""
    film = numbered_sim_film()
    other = tuple(cv2.imencode(".jpg", picture(100 + i))[1].tobytes() for i in range(30))
    return Film(film.scenario, 0, {**film.frames, "cam1": other}, film.setup)


@dataclass
class Seen:
    """A mailbox: which webcam each frame was of, and the frames."""

    frames: list[Frame] = field(default_factory=list)

    def put(self, frame: Frame, /) -> None:
        self.frames.append(frame)

    def webcams(self, camera: str) -> set[str]:
        return {
            "cam1" if number_of(one.pixels) >= 100 else "cam0"
            for one in self.frames
            if one.camera == camera
        }


def never(error: BaseException) -> None:
    raise AssertionError(error)


def wait_until(condition: Callable[[], bool]) -> bool:
    pause = threading.Event()
    return any(condition() or pause.wait(0.01) for _ in range(3000))


class TwoCameras:
    """cam0 and cam1 in their sockets, each with its thread."""

    def __init__(
        self, folder: Path, webcams: dict[str, str], plugged: bool = True, **kw: object
    ) -> None:
        film = two_films()
        self.control = SocketControl(folder / "sockets.json", webcams, plugged)
        sockets = Sockets(self.control.path)
        self.seen = Seen()
        # as long as the film shows the same world again, to whoever opens it anew
        epoch_ns = monotonic_ns()
        self.threads = {
            name: CaptureThread(
                SocketCamera(name, sockets, lambda webcam: SimSource(film, webcam, epoch_ns)),
                self.seen,
                never,
                back_off=QUICK,
                **kw,  # type: ignore[arg-type]
            )
            for name in webcams
        }
        for thread in self.threads.values():
            thread.start()

    def status(self, name: str) -> CaptureStatus:
        return self.threads[name].status()

    def until(self, name: str, state: CaptureState) -> CaptureStatus:
        assert wait_until(lambda: self.status(name).state is state), self.status(name)
        return self.status(name)

    def until_told(self, name: str, words: str) -> None:
        assert wait_until(lambda: words in self.status(name).trouble), self.status(name)

    def stop(self) -> None:
        for thread in self.threads.values():
            thread.let_go()
        for thread in self.threads.values():
            thread.stop()


Cameras = Callable[..., TwoCameras]


@pytest.fixture
def cameras(tmp_path: Path) -> Iterator[Cameras]:
    made: list[TwoCameras] = []

    def make(webcams: dict[str, str], plugged: bool = True, **kw: object) -> TwoCameras:
        made.append(TwoCameras(tmp_path, webcams, plugged, **kw))
        return made[-1]

    yield make
    for one in made:
        one.stop()


def test_one_that_is_unplugged_is_lost_at_once_and_the_other_goes_on(
    cameras: Cameras, caplog: pytest.LogCaptureFixture
) -> None:
    two = cameras(SERIALS)
    two.until("cam0", CaptureState.LIVE)
    two.until("cam1", CaptureState.LIVE)
    two.control.unplug("cam0")
    two.until("cam0", CaptureState.LOST)
    assert "cam0: lost: was unplugged" in caplog.text  # soon another reason: it is not plugged in
    before = two.status("cam1").frames
    assert wait_until(lambda: two.status("cam1").frames > before + 5)
    two.control.plug("cam0")
    assert two.until("cam0", CaptureState.LIVE).reopens == 1


def test_one_in_another_port_is_the_same_camera_and_it_is_told(cameras: Cameras) -> None:
    two = cameras(SERIALS)
    two.until("cam0", CaptureState.LIVE)
    two.control.unplug("cam0")
    two.until("cam0", CaptureState.LOST)
    two.control.plug("cam0", "2-4")
    two.until("cam0", CaptureState.LIVE)
    assert "another USB port than configured (2-4)" in two.status("cam0").trouble
    assert two.seen.webcams("cam0") == {"cam0"}


def test_two_with_serials_in_each_others_ports_keep_their_names(cameras: Cameras) -> None:
    two = cameras(SERIALS)
    for name in SERIALS:
        two.until(name, CaptureState.LIVE)
        two.control.unplug(name)
        two.until(name, CaptureState.LOST)
    two.control.plug("cam0", "1-2")
    two.control.plug("cam1", "1-1")
    for name in SERIALS:
        two.until(name, CaptureState.LIVE)
        assert two.seen.webcams(name) == {name}


def test_of_twins_one_that_moves_alone_is_known_and_two_are_asked_about(
    cameras: Cameras, caplog: pytest.LogCaptureFixture
) -> None:
    two = cameras(TWINS)
    for name in TWINS:
        two.until(name, CaptureState.LIVE)
    two.control.unplug("cam0")
    two.until("cam0", CaptureState.LOST)
    two.control.plug("cam0", "2-1")
    two.until("cam0", CaptureState.LIVE)
    for name in TWINS:
        two.control.unplug(name)
        two.until(name, CaptureState.LOST)
    two.control.plug("cam1", "2-2")
    for name in TWINS:
        two.until_told(name, "port 2-2 may be this one or its twin")
    two.control.sockets.pop("2-2")  # first: else it could be cam0, which moved
    two.control.plug("cam1")
    two.control.plug("cam0")
    for name in TWINS:
        two.until(name, CaptureState.LIVE)
        assert two.seen.webcams(name) == {name}
    # each thread has logged by now: its status is told a moment before
    assert sum("may be this one" in one.getMessage() for one in caplog.records) == len(TWINS)


def test_cameras_that_are_not_there_at_the_start_join_when_they_come(cameras: Cameras) -> None:
    two = cameras(SERIALS, plugged=False)
    assert "not plugged in" in two.until("cam0", CaptureState.LOST).reason
    two.control.plug("cam1", "1-7")
    two.until("cam1", CaptureState.LIVE)
    assert two.seen.webcams("cam1") == {"cam1"}
    two.control.plug("cam0")
    two.until("cam0", CaptureState.LIVE)


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (Fault.BLACK, "its picture is black -- uncover the lens"),
        (Fault.TORN, "many of its pictures come damaged -- check its cable"),
        (Fault.SMALL, "sends 32x24, its calibration is for 64x48: it takes no part"),
    ],
)
def test_pictures_that_are_wrong_are_told_until_they_are_right(
    cameras: Cameras, fault: Fault, told: str, caplog: pytest.LogCaptureFixture
) -> None:
    two = cameras(SERIALS, size_px=(64, 48))
    two.until("cam0", CaptureState.LIVE)
    two.control.ail("cam0", fault)
    two.until_told("cam0", told)
    assert two.status("cam0").state is CaptureState.LIVE
    assert two.status("cam1").trouble == ""
    two.control.ail("cam0", Fault.NONE)
    assert wait_until(lambda: two.status("cam0").trouble == "")
    assert sum(told in one.getMessage() for one in caplog.records) == 1


def test_one_that_freezes_is_opened_again_then_left_out_and_comes_back_with_its_plug(
    cameras: Cameras,
) -> None:
    two = cameras(SERIALS, budget=RestartBudget(most=1, within_s=60.0, rest_s=600.0))
    two.until("cam0", CaptureState.LIVE)
    two.control.ail("cam0", Fault.FROZEN)
    two.until_told(
        "cam0", "left out for 600 s, as it failed 2 times within 60 s: sends the same picture"
    )
    assert two.status("cam0").reopens == 1
    two.control.unplug("cam0")
    two.control.plug("cam0")
    two.until("cam0", CaptureState.LIVE)
    assert two.status("cam1").reopens == 0


def test_a_driver_that_does_not_come_back_is_left_to_itself(
    cameras: Cameras, caplog: pytest.LogCaptureFixture
) -> None:
    two = cameras(SERIALS, stuck_s=0.5)
    two.until("cam0", CaptureState.LIVE)
    two.control.ail("cam0", Fault.STUCK)

    def watched(condition: Callable[[], bool]) -> Callable[[], bool]:
        def after_watching() -> bool:
            two.threads["cam0"].watch()
            return condition()

        return after_watching

    def threads_of(name: str) -> int:
        return sum(one.name == f"capture-{name}" for one in threading.enumerate())

    assert threads_of("cam0") == 1
    assert wait_until(watched(lambda: threads_of("cam0") == MOST_STUCK))
    for _ in range(100):  # no further one is risked
        two.threads["cam0"].watch()
        threading.Event().wait(0.01)
    assert threads_of("cam0") == MOST_STUCK
    assert "its driver has not come back for" in two.status("cam0").trouble
    frames = two.status("cam0").frames
    two.control.unplug("cam0")  # by which drivers come back
    two.control.plug("cam0")
    assert wait_until(watched(lambda: two.status("cam0").frames > frames))
    assert wait_until(lambda: threads_of("cam0") == 1)
    seqs = [(one.seq, one.t_ns) for one in two.seen.frames if one.camera == "cam0"]
    assert [t_ns for _, t_ns in seqs] == sorted(t_ns for _, t_ns in seqs)


def test_one_that_is_to_be_opened_anew_is_and_costs_nothing(cameras: Cameras) -> None:
    two = cameras(SERIALS, budget=RestartBudget(most=0))
    two.until("cam0", CaptureState.LIVE)
    two.threads["cam0"].renew("the machine has slept for 60 s")
    assert wait_until(lambda: two.status("cam0").reopens == 1)
    assert two.status("cam0").state is CaptureState.LIVE


def test_a_loose_plug_does_not_fill_the_log(
    cameras: Cameras, caplog: pytest.LogCaptureFixture
) -> None:
    two = cameras(SERIALS)
    for _ in range(14):
        two.until("cam0", CaptureState.LIVE)
        two.control.unplug("cam0")
        two.until("cam0", CaptureState.LOST)
        two.control.plug("cam0")
    told = [one.getMessage() for one in caplog.records if one.levelname == "WARNING"]
    assert sum("cam0: lost: was unplugged" in one for one in told) == 10
    assert sum("was lost 11 times within 10 minutes" in one for one in told) == 1


def test_a_damaged_control_file_is_a_named_error(tmp_path: Path) -> None:
    path = tmp_path / "sockets.json"
    path.write_text('{"webcams": {}, "sockets": {"1-1": {"webcam": "cam0"}}}')
    with pytest.raises(InputError, match="there is no webcam 'cam0'"):
        Sockets(path).find("cam0")
    path.write_text('{"webcams": {}, "sockets"')
    with pytest.raises(InputError, match=r"sockets.json.*no sockets"):
        Sockets(path).now()
