"""Capture threads: newest frame, lost cameras sought again, death noticed, stopping in time."""

import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.capture.camera_thread.reopening import BackOff, RestartBudget
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.file import FileSource, size_error
from mocapd.capture.pace import Pace
from mocapd.clock import monotonic_ns
from mocapd.errors import CameraLost, ConfigError, UnavailableError
from mocapd.types import Frame
from tests.capture.films import picture, write_film

QUICK = BackOff(first_s=0.01, longest_s=0.05)


class Shelf:
    """A mailbox that keeps everything, and can be waited for."""

    def __init__(self) -> None:
        self.items: list[Frame] = []
        self.changed = threading.Condition()

    def put(self, item: Frame, /) -> None:
        with self.changed:
            self.items.append(item)
            self.changed.notify_all()

    def wait_for(self, count: int) -> bool:
        with self.changed:
            return self.changed.wait_for(lambda: len(self.items) >= count, 120.0)


def nobody_dies(error: BaseException) -> None:
    raise AssertionError(error)


def wait_until(condition: Callable[[], bool]) -> bool:
    """Whether it became true within ten seconds."""
    pause = threading.Event()
    return any(condition() or pause.wait(0.01) for _ in range(1000))


def test_frames_reach_the_mailbox_and_the_end_is_a_state(tmp_path: Path) -> None:
    shelf = Shelf()
    source = FileSource("a", write_film(tmp_path / "a.avi", 10))
    capture = CaptureThread(source, shelf, nobody_dies)
    capture.start()
    assert shelf.wait_for(10)
    assert wait_until(lambda: capture.status().state is CaptureState.ENDED)
    status = capture.status()
    assert (status.camera, status.frames, status.torn, status.reopens) == ("a", 10, 0, 0)
    assert "10 frames" in status.reason
    assert status.last_frame_ns == shelf.items[-1].t_ns
    assert capture.stop()


def test_an_absent_camera_is_lost_with_the_reason_and_found_when_it_comes(tmp_path: Path) -> None:
    shelf = Shelf()
    path = tmp_path / "late.avi"
    capture = CaptureThread(FileSource("late", path), shelf, nobody_dies, back_off=QUICK)
    capture.start()
    assert wait_until(lambda: capture.status().state is CaptureState.LOST)
    assert "late.avi" in capture.status().reason
    write_film(tmp_path / "ready.avi", 5).rename(path)
    assert shelf.wait_for(5)
    assert [frame.seq for frame in shelf.items] == list(range(5))
    assert capture.stop()


def test_the_measured_rate_is_told_and_a_low_one_is_warned_of(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    shelf = Shelf()
    source = FileSource("slow", write_film(tmp_path / "a.avi", 60, 30.0))  # time runs fast offline
    seen: list[float] = []

    class Watching:
        def put(self, item: Frame, /) -> None:
            seen.append(capture.status().fps_hz)
            shelf.put(item)

    capture = CaptureThread(source, Watching(), nobody_dies, expected_hz=60.0)
    capture.start()
    assert shelf.wait_for(60)
    assert capture.stop()
    assert seen[-1] == pytest.approx(30.0, abs=0.1)
    warnings = [record.getMessage() for record in caplog.records if "Hz" in record.getMessage()]
    assert len(warnings) == 1
    # a film knows no dim light
    assert warnings[0] == "slow: delivers 30.0 Hz, asked for 60 Hz: the processor is overloaded"


def test_stop_wakes_a_read_that_waits(tmp_path: Path) -> None:
    shelf = Shelf()
    source = FileSource("a", write_film(tmp_path / "a.avi", 3), fps_hz=0.01, pace=Pace(live=True))
    capture = CaptureThread(source, shelf, nobody_dies)
    capture.start()
    assert shelf.wait_for(1)  # the next one is due in 100 s
    assert capture.stop()
    assert capture.status().state is CaptureState.ENDED
    assert capture.status().reason == "stopped"


def test_stop_wakes_the_pause_before_reopening(tmp_path: Path) -> None:
    long = BackOff(first_s=100.0, longest_s=100.0)
    capture = CaptureThread(FileSource("a", tmp_path / "no"), Shelf(), nobody_dies, back_off=long)
    capture.start()
    assert wait_until(lambda: capture.status().state is CaptureState.LOST)
    assert capture.stop()


class StuckSource:
    """A driver that does not come back from its read, as a webcam that stalls for ten seconds."""

    name = "stuck"
    recorded = False

    def __init__(self) -> None:
        self.inside, self.freed = threading.Event(), threading.Event()

    def open(self) -> None:
        pass

    def read(self) -> Frame:
        self.inside.set()
        self.freed.wait()
        raise RuntimeError("the driver went mad")

    def close(self) -> None:
        pass


class HeldSource(StuckSource):
    """Whose node a second opening finds busy, as a driver has it that hangs."""

    openings = 0

    def open(self) -> None:
        self.openings += 1
        if self.inside.is_set() and not self.freed.is_set():
            raise UnavailableError("busy: used already by this process", fix="end that program")

    def read(self) -> Frame:
        self.inside.set()
        self.freed.wait()
        return Frame(self.name, 0, monotonic_ns(), picture(0))


def test_while_a_driver_hangs_its_own_grip_is_not_told_as_another_programs() -> None:
    source = HeldSource()
    capture = CaptureThread(source, Shelf(), nobody_dies, back_off=QUICK, stuck_s=0.1)
    capture.start()

    def tried_again() -> bool:
        capture.watch()
        return source.openings > 3

    assert wait_until(tried_again)
    assert "its driver has not come back" in capture.status().reason
    assert capture.status().reason.endswith("unplug the camera and plug it in again")
    source.freed.set()
    assert wait_until(lambda: capture.status().state is CaptureState.LIVE)
    assert capture.stop()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_read_that_never_returns_blocks_neither_status_nor_stop() -> None:
    died: list[BaseException] = []
    source = StuckSource()
    capture = CaptureThread(source, Shelf(), died.append)
    capture.start()
    assert source.inside.wait(10.0)
    assert capture.status().frames == 0
    assert not capture.stop(timeout_s=0.1)
    source.freed.set()
    assert capture.stop(timeout_s=10.0)
    assert [str(error) for error in died] == ["the driver went mad"]
    assert capture.status().reason == "the driver went mad"


def test_what_waiting_does_not_mend_ends_the_thread(tmp_path: Path) -> None:
    died: list[BaseException] = []
    source = FileSource("a", write_film(tmp_path / "a.avi", 3), size_px=(640, 480))
    capture = CaptureThread(source, Shelf(), died.append)
    capture.start()
    assert wait_until(lambda: bool(died))
    assert isinstance(died[0], ConfigError)
    assert capture.stop()
    assert capture.status().state is CaptureState.ENDED
    assert "640x480" in capture.status().reason


class ChangingCamera:
    """A network camera as others set it: lost after two frames, then back in another size, then mended."""

    name = "net"
    recorded = False

    def __init__(self) -> None:
        self.openings = 0
        self.mended = threading.Event()
        self._seq = 0

    def open(self) -> None:
        self.openings += 1
        if self.openings > 1 and not self.mended.is_set():
            raise size_error("rtsp://net/live", self.name, (160, 120), (320, 240))

    def read(self) -> Frame:
        self._seq += 1
        if self._seq == 3:
            raise CameraLost("stopped sending", self.name)
        threading.Event().wait(0.01)
        return Frame(self.name, self._seq, monotonic_ns(), picture(1))

    def close(self) -> None: ...


def test_a_camera_that_comes_back_in_another_size_is_lost_until_it_fits_again(
    caplog: pytest.LogCaptureFixture,
) -> None:
    shelf, source = Shelf(), ChangingCamera()
    capture = CaptureThread(source, shelf, nobody_dies, back_off=QUICK)
    capture.start()
    assert wait_until(lambda: source.openings > 4)
    status = capture.status()
    assert status.state is CaptureState.LOST
    assert "160x120, but camera 'net' was calibrated at 320x240" in status.reason
    warnings = [one.getMessage() for one in caplog.records if "160x120" in one.getMessage()]
    assert len(warnings) == 1
    source.mended.set()
    assert shelf.wait_for(5)
    assert capture.status().state is CaptureState.LIVE
    assert capture.status().reopens == 1
    assert capture.stop()


class StallingCamera:
    """Sends ten frames at 100 Hz; then its read does not come back until it is closed."""

    name = "stalling"
    recorded = False

    def __init__(self) -> None:
        self.closed = threading.Event()
        self._seq = 0

    def open(self) -> None: ...

    def read(self) -> Frame:
        self._seq += 1
        if self.closed.wait(60.0 if self._seq > 10 else 0.01):
            raise CameraLost("closed", self.name)
        return Frame(self.name, self._seq, monotonic_ns(), picture(1))

    def close(self) -> None:
        self.closed.set()


def test_the_rate_falls_by_the_clock_while_a_read_blocks() -> None:
    shelf = Shelf()
    capture = CaptureThread(StallingCamera(), shelf, nobody_dies)
    capture.start()
    assert shelf.wait_for(10)
    first_hz = capture.status().fps_hz
    assert first_hz > 0.0
    assert wait_until(lambda: capture.status().is_silent)
    assert capture.status().state is CaptureState.LIVE
    assert capture.status().fps_hz < first_hz
    assert capture.status().trouble.startswith("silent for 1 s")
    assert wait_until(lambda: capture.status().fps_hz == 0.0)
    assert capture.status().silent_s >= 2.0
    assert capture.stop()
    assert not capture.status().is_silent


def test_stopping_before_starting_is_allowed(tmp_path: Path) -> None:
    assert CaptureThread(FileSource("a", tmp_path / "a"), Shelf(), nobody_dies).stop()


def test_the_pause_doubles_up_to_its_limit() -> None:
    pauses = [BackOff(0.1, 5.0).pause_s(failures) for failures in range(1, 10)]
    assert pauses[:4] == pytest.approx([0.1, 0.2, 0.4, 0.8])
    assert pauses[-1] == 5.0
    assert BackOff().pause_s(100_000) == 5.0


class LateCamera(ChangingCamera):
    """Not there at first; then there in another size."""

    def open(self) -> None:
        self.openings += 1
        if self.openings < 3:
            raise UnavailableError("is not plugged in", self.name)
        if not self.mended.is_set():
            raise size_error("usb", self.name, (160, 120), (320, 240))


def test_a_camera_that_comes_later_and_does_not_fit_does_not_end_the_others() -> None:
    shelf, source = Shelf(), LateCamera()
    capture = CaptureThread(source, shelf, nobody_dies, back_off=QUICK)
    capture.start()
    assert wait_until(lambda: "160x120" in capture.status().reason)
    source.mended.set()
    assert shelf.wait_for(2)
    assert capture.stop()


class ShortCamera:
    """A network camera that sends one frame after each opening."""

    name = "net"
    recorded = False

    def __init__(self) -> None:
        self.openings = 0
        self._sent = False

    def open(self) -> None:
        self.openings += 1
        self._sent = False

    def read(self) -> Frame:
        if self._sent:
            raise CameraLost("stopped sending", fix="check its network")
        self._sent = True
        return Frame(self.name, 0, monotonic_ns(), picture(self.openings % 256))

    def close(self) -> None: ...


def test_a_camera_that_fails_over_and_over_is_left_out_and_rests() -> None:
    source = ShortCamera()
    budget = RestartBudget(most=3, within_s=60.0, rest_s=0.3)
    capture = CaptureThread(source, Shelf(), nobody_dies, back_off=QUICK, budget=budget)
    capture.start()
    assert wait_until(lambda: "left out" in capture.status().reason)
    reason = capture.status().reason
    assert reason.startswith("left out for 0 s, as it failed 4 times within 60 s: stopped sending")
    assert reason.endswith("check its network")
    assert source.openings == 4
    assert wait_until(lambda: source.openings > 4)  # it has rested
    assert capture.stop()
