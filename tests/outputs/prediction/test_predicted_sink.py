"""An output at a rate of its own: more poses than frames, each for its own moment, and quiet when nothing is known."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import pytest

from mocapd.clock import monotonic_ns
from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import StateMessage
from mocapd.outputs.output_table import OUTPUTS, build_sinks, default_sections
from mocapd.outputs.prediction.predicted_sink import PredictedSink
from mocapd.outputs.prediction.prediction_params import PredictionParams
from mocapd.outputs.wire import SkeletonFrame
from tests.outputs.frames import eventually
from tests.outputs.prediction.moving import UNIX_NS, frame_at, swinging, walking
from tests.outputs.test_zenoh_sink import HEALTH

RATE_HZ = 90.0
FEWEST, MOST = 12, 3000


class KeepingSink:
    """Keeps what it is sent."""

    name = "kept"

    def __init__(self) -> None:
        self.got: list[SkeletonFrame] = []
        self.told: list[StateMessage] = []
        self.closed = 0
        self.error: Exception | None = None

    def open(self) -> None: ...

    def send(self, frame: SkeletonFrame) -> None:
        if self.error is not None:
            raise self.error
        self.got.append(frame)

    def send_state(self, message: StateMessage) -> None:
        self.told.append(message)

    def status(self) -> SinkStatus:
        return SinkStatus(len(self.got), 0, -1, "kept")

    def close(self) -> None:
        self.closed += 1


@contextmanager
def opened(sink: KeepingSink, ahead_s: float = 0.0) -> Iterator[PredictedSink]:
    predicted = PredictedSink(sink, RATE_HZ, ahead_s)
    predicted.open()
    try:
        yield predicted
    finally:
        predicted.close()


def as_now(t_s: float, **changes: object) -> SkeletonFrame:
    """A frame that was seen 40 ms ago."""
    now_ns = monotonic_ns()
    fields = {
        "capture_monotonic_ns": now_ns - 40_000_000,
        "capture_unix_ns": now_ns - 40_000_000 + UNIX_NS,
        "publish_monotonic_ns": now_ns,
    }
    return msgspec.structs.replace(frame_at(t_s, swinging, walking), **(fields | changes))


def play(sink: PredictedSink, kept: KeepingSink) -> list[SkeletonFrame]:
    """Frames at 30 Hz, sent as they come, until twice as many poses have come out."""
    pause, sent = threading.Event(), list[SkeletonFrame]()
    while len(sent) < FEWEST or len(kept.got) < 2 * len(sent):
        assert len(sent) < MOST
        sent.append(as_now(len(sent) / 30.0))
        sink.send(sent[-1])
        pause.wait(1.0 / 30.0)
    return sent


def test_there_are_more_poses_than_frames_and_each_is_of_its_own_moment() -> None:
    kept = KeepingSink()
    with opened(kept, ahead_s=0.01) as sink:
        sent = play(sink, kept)
    got = kept.got
    assert [frame.seq for frame in got] == list(range(len(got)))
    of_frames = {one.capture_monotonic_ns for one in sent}
    for frame in got:
        assert frame.predicted_ns > 0
        assert frame.capture_monotonic_ns - frame.predicted_ns in of_frames
        assert frame.capture_unix_ns - frame.capture_monotonic_ns == UNIX_NS
        until_ns = frame.publish_monotonic_ns + 10_000_000
        # for when it is on the screen, or as far as anybody can tell
        assert frame.capture_monotonic_ns == until_ns or frame.predicted_ns == 100_000_000
    places = [frame.joints["leftHand"].p for frame in got[6:] if frame.predicted_ns < 100_000_000]
    assert len(set(places)) == len(places)


def test_nothing_is_said_when_nothing_is_known() -> None:
    kept = KeepingSink()
    with opened(kept) as sink:
        old_ns = monotonic_ns() - 10_000_000_000
        sink.send(as_now(0.0, publish_monotonic_ns=old_ns))
        sink.send(as_now(0.1, tracking="lost", joints={}))
        assert eventually(lambda: bool(kept.got))
        threading.Event().wait(0.1)
    assert [frame.tracking for frame in kept.got] == ["lost"]


def test_states_go_through_and_it_ends_with_its_sink() -> None:
    kept = KeepingSink()
    sink = PredictedSink(kept, RATE_HZ, 0.0)
    sink.send_state(HEALTH)
    sink.open()
    sink.close()
    sink.close()
    assert kept.told == [HEALTH]
    assert kept.closed == 2
    sink.send(as_now(0.0))  # late: nobody minds
    assert kept.got == []
    assert sink.status().detail == "kept"


def test_what_ends_the_output_ends_the_next_send() -> None:
    kept = KeepingSink()
    kept.error = UnavailableError("gone", "kept", "plug it in")

    def is_told() -> bool:
        try:
            sink.send(as_now(0.0))
        except UnavailableError as error:
            return error is kept.error
        return False

    with opened(kept) as sink:
        assert eventually(is_told)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_defect_of_the_output_ends_the_next_send_too() -> None:
    kept = KeepingSink()
    kept.error = ZeroDivisionError()
    with opened(kept) as sink:
        sink.send(as_now(0.0))
        assert eventually(lambda: not sink._thread.is_alive())  # type: ignore[union-attr]
        with pytest.raises(RuntimeError, match="output kept died"):
            sink.send(as_now(0.0))


def test_any_output_may_be_predicted() -> None:
    prediction = PredictionParams(hz=50.0)
    for name, entry in OUTPUTS.items():
        section = type(entry.section())
        (sink,) = build_sinks({name: section(enabled=True)}, "pc", prediction)  # type: ignore[call-arg]
        assert isinstance(sink, PredictedSink)
        assert sink.name == name
    assert not any(
        isinstance(sink, PredictedSink) for sink in build_sinks(default_sections(), "pc")
    )


def test_a_prediction_of_an_output_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(ConfigError, match="'vcm'"):
        build_sinks(default_sections(), "pc", PredictionParams(hz=50.0, outputs=("vcm",)))
