"""Signs of life come of what is done: a standstill anywhere on the way of a frame ends them."""

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from mocapd.app.daemon.notifier import Notifier
from mocapd.app.daemon.supervision import ProgressWatch, Supervision
from mocapd.body.shape import BodyShape, mean_shape
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.config.sections import Config
from mocapd.outputs import output_table
from mocapd.outputs.output_table import OutputEntry
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.metrics import Metrics
from mocapd.service.service import Service, Snapshot
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import FrameSet, Tracking
from tests.app.daemon.manager import Manager
from tests.app.terminal.test_status_line import CAMERA, METRICS
from tests.capture.films import SIZE_PX
from tests.e2e.fake_cameras import FakeCamera
from tests.outputs.frames import eventually
from tests.service.test_publisher import Recorder
from tests.service.test_service import Enabled

ALWAYS_DUE_NS = 1
LOOKS = 12  # three seconds of the daemon's


class HeldTracker(CannedTracker):
    """Stays in a step once it is held, as a kernel would that never ends."""

    def __init__(self) -> None:
        super().__init__()
        self.held, self.free = threading.Event(), threading.Event()

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        if self.held.is_set():
            self.free.wait()
        return super().step(frames, shape)


class HeldSink(Recorder):
    """An output that blocks once it is held."""

    def __init__(self) -> None:
        super().__init__()
        self.held, self.free = threading.Event(), threading.Event()

    def send(self, frame: SkeletonFrame) -> None:
        if self.held.is_set():
            self.free.wait()
        super().send(frame)


@dataclass(eq=False)
class Setting:
    """A daemon, each part of which can be made to stand still."""

    cameras: tuple[FakeCamera, FakeCamera]
    tracker: HeldTracker
    sink: HeldSink
    service: Service
    watch: ProgressWatch = field(default_factory=ProgressWatch)

    def has_progressed(self) -> bool:
        return self.watch.has_progressed(self.service.snapshot())

    def comes_to_a_standstill(self) -> bool:
        """What was under way may still count once; then nothing does, however often it is looked at."""
        pause = threading.Event()
        counted = 0
        for _ in range(LOOKS):
            pause.wait(0.02)
            counted += self.has_progressed()
        return counted <= 1


@contextmanager
def daemon(monkeypatch: pytest.MonkeyPatch) -> Iterator[Setting]:
    sink = HeldSink()
    entry = OutputEntry(Enabled, lambda _section, _name: sink)
    monkeypatch.setattr(output_table, "OUTPUTS", {"recorder": entry})
    config = Config(outputs={"recorder": Enabled()}, state_dir=Path("/nonexistent"))
    cameras, tracker = (FakeCamera("a"), FakeCamera("b")), HeldTracker()
    inputs = tuple(CameraInput(camera, "test", SIZE_PX) for camera in cameras)
    session = Session(inputs, None, "", tracker, mean_shape(1.75))
    with Service(config, session) as service:
        try:
            yield Setting(cameras, tracker, sink, service)
        finally:
            tracker.free.set()
            sink.free.set()


def test_a_daemon_that_works_progresses_again_and_again(monkeypatch: pytest.MonkeyPatch) -> None:
    with daemon(monkeypatch) as one:
        for _ in range(5):
            assert eventually(one.has_progressed, 60.0)


@pytest.mark.parametrize("part", ["tracker", "sink"])
def test_a_pipeline_that_is_stuck_does_not(monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    with daemon(monkeypatch) as one:
        assert eventually(one.has_progressed, 60.0)
        stuck: HeldTracker | HeldSink = getattr(one, part)
        stuck.held.set()
        sent = len(one.sink.frames)
        assert eventually(one.comes_to_a_standstill, 60.0)
        assert len(one.sink.frames) <= sent + 1
        stuck.free.set()
        assert eventually(one.has_progressed, 60.0)


def test_nor_does_a_camera_that_counts_as_live_and_sends_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Though the other one goes on."""
    with daemon(monkeypatch) as one:
        assert eventually(one.has_progressed, 60.0)
        one.cameras[0].frozen.set()
        assert eventually(one.comes_to_a_standstill, 60.0)
        sent = len(one.sink.frames)
        assert eventually(lambda: len(one.sink.frames) > sent + 5, 60.0)
        assert not one.has_progressed()


def test_cameras_that_are_unplugged_are_no_standstill(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is another session, which counts anew."""
    with daemon(monkeypatch) as one:
        assert eventually(one.has_progressed, 60.0)
        for camera in one.cameras:
            camera.unplugged.set()
        for _ in range(3):
            assert eventually(one.has_progressed, 60.0)
        camera = FakeCamera("c")
        inputs = (CameraInput(camera, "test", SIZE_PX),)
        one.service.replace(
            one.service.config, Session(inputs, None, "", CannedTracker(), mean_shape(1.75))
        )
        for _ in range(3):
            assert eventually(one.has_progressed, 60.0)


def _snapshot(metrics: Metrics, camera: CaptureStatus) -> Snapshot:
    return Snapshot(metrics, {"left": camera}, {})


def test_an_hour_in_the_journal_is_a_line_and_a_state(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """While all figures change four times a second."""
    manager = Manager(tmp_path / "notify")
    notifier = Notifier(manager.address)
    notifier.ready("")
    supervision = Supervision(notifier)
    with caplog.at_level(logging.INFO):
        for beat in range(4 * 3600):
            metrics = replace(METRICS, rate_hz=29.0 + beat % 7, published=beat, turns=beat)
            camera = replace(CAMERA, fps_hz=29.0 + beat % 5, frames=beat)
            supervision.on_tick(_snapshot(metrics, camera))
    assert len(caplog.records) == 1
    assert [one["STATUS"] for one in manager.waiting()] == [
        "",
        "waiting for the first frame; left live",
        "somebody is tracked; left live",
    ]
    supervision.on_tick(_snapshot(replace(METRICS, tracking=Tracking.LOST), CAMERA))
    lost = replace(CAMERA, state=CaptureState.LOST, reason="unplugged")
    supervision.on_tick(_snapshot(METRICS, lost))
    supervision.on_tick(_snapshot(METRICS, replace(CAMERA, silent_s=2.0)))
    assert [one["STATUS"] for one in manager.waiting()] == [
        "nobody is seen; left live",
        "somebody is tracked; left lost (unplugged)",
        "somebody is tracked; left silent",
    ]
    manager.close()
