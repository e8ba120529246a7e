"""A slow sink does not hold up the pipeline, and a broken one does not go unnoticed."""

import threading
import time

import msgspec
import pytest

from mocapd.errors import UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import CalibrationInfo, StateMessage
from mocapd.outputs.threaded import ThreadedSink
from mocapd.outputs.wire import SkeletonFrame
from tests.outputs.frames import eventually, small_frame
from tests.outputs.test_zenoh_sink import CAMERA, HEALTH


class SlowSink:
    """Takes one frame, then waits until it is let on."""

    name = "slow"

    def __init__(self) -> None:
        self.got: list[int] = []
        self.told: list[StateMessage] = []
        self.busy = threading.Event()
        self.let_on = threading.Event()
        self.closed = 0

    def open(self) -> None: ...

    def send(self, frame: SkeletonFrame) -> None:
        self.busy.set()
        self.let_on.wait(10.0)
        self.got.append(frame.seq)

    def send_state(self, message: StateMessage) -> None:
        self.told.append(message)

    def status(self) -> SinkStatus:
        return SinkStatus(len(self.got), 0, -1, "slow")

    def close(self) -> None:
        self.closed += 1


class BrokenSink(SlowSink):
    def __init__(self, error: Exception) -> None:
        super().__init__()
        self.error = error

    def send(self, frame: SkeletonFrame) -> None:
        raise self.error


def keep_sending(sink: ThreadedSink, for_s: float = 10.0) -> None:
    deadline_s = time.monotonic() + for_s
    while time.monotonic() < deadline_s:
        sink.send(small_frame())
        time.sleep(0.01)


def test_the_newest_frame_wins_and_the_displaced_are_counted() -> None:
    inner = SlowSink()
    sink = ThreadedSink(inner)
    sink.open()
    sink.send(small_frame(seq=0))
    assert inner.busy.wait(10.0)
    for seq in range(1, 6):
        sink.send(small_frame(seq=seq))
    inner.let_on.set()
    assert eventually(lambda: len(inner.got) == 2)
    assert inner.got == [0, 5]
    assert sink.status() == SinkStatus(2, 4, -1, "slow; 4 too late")
    sink.close()
    sink.close()
    assert inner.closed == 2


def test_a_named_error_of_the_sink_reaches_the_sender() -> None:
    sink = ThreadedSink(BrokenSink(UnavailableError("gone")))
    sink.open()
    with pytest.raises(UnavailableError, match="gone"):
        keep_sending(sink)
    sink.close()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_sink_that_dies_is_noticed_by_the_sender() -> None:
    sink = ThreadedSink(BrokenSink(ZeroDivisionError()))
    sink.open()
    with pytest.raises(RuntimeError, match="output slow died"):
        keep_sending(sink)
    sink.close()


def test_it_may_be_opened_again() -> None:
    inner = SlowSink()
    inner.let_on.set()
    sink = ThreadedSink(inner)
    for seq in range(2):
        sink.open()
        sink.send(small_frame(seq=seq))
        assert eventually(lambda seq=seq: inner.got[-1:] == [seq])  # type: ignore[misc]
        sink.close()


def test_of_states_the_newest_about_each_subject_arrives_however_many_frames_pile_up() -> None:
    inner = SlowSink()
    sink = ThreadedSink(inner)
    calibration = CalibrationInfo("pc", "before open", ())
    sink.send_state(calibration)
    sink.open()
    sink.send(small_frame(seq=0))
    assert inner.busy.wait(10.0)
    other = msgspec.structs.replace(CAMERA, camera="right")
    lost = msgspec.structs.replace(CAMERA, state="lost")
    for message in (HEALTH, CAMERA, other, lost):
        sink.send_state(message)
        sink.send(small_frame(seq=1))
    inner.let_on.set()
    assert eventually(lambda: inner.got == [0, 1])
    assert inner.told == [calibration, HEALTH, lost, other]
    sink.close()
