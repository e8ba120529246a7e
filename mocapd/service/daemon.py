"""The composition root: cameras, pipeline and outputs put together, started, and stopped in two passes."""

import itertools
import threading
import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from types import TracebackType

from mocapd.body.shape import skeleton_of
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.thread import CaptureState, CaptureStatus, CaptureThread
from mocapd.clock import monotonic_ns, unix_from_monotonic_ns
from mocapd.config.sections import Config
from mocapd.errors import MocapdError
from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.osc.osc_sink import OscSink
from mocapd.outputs.zenoh import keys
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from mocapd.pipeline.absence import Absence
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.loop import PipelineLoop
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.size_guard import SizeGuard
from mocapd.pipeline.smoothing import Smoother
from mocapd.service.health import camera_message, health_message
from mocapd.service.mountings import Mountings
from mocapd.session.camera_inputs import bundler_params
from mocapd.session.session import Session
from mocapd.types import BodyState, FrameSet, Skeleton

STOP_S = 1.4  # what all threads together may take to end; a stalled camera takes a second [s]


class ThreadDiedError(RuntimeError):
    """A thread ended by what nobody expected, which is the `__cause__`."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """How everything fares, for the status line."""

    metrics: Metrics
    cameras: dict[str, CaptureStatus]
    outputs: dict[str, SinkStatus]
    mountings: Mapping[str, Mounting] = field(default_factory=dict)


class Daemon:
    """Runs from `__enter__` to `__exit__`; meanwhile its owner waits in `wait`.

    `died` and `end` may be called from any thread, everything else by the owner.
    """

    def __init__(self, config: Config, session: Session) -> None:
        self._zenoh = (
            ZenohSink(replace(config.zenoh, instance=config.instance))
            if config.zenoh.enabled
            else None
        )
        self._sinks: list[Sink] = [self._zenoh] if self._zenoh else []
        if config.osc.enabled:
            self._sinks.append(OscSink(config.osc))
        self.instance = (
            self._zenoh.instance if self._zenoh else config.instance or keys.default_instance()
        )
        self._session = session
        self._inputs = {camera.source.name: camera for camera in session.cameras}
        bundler = bundler_params(config)
        self._collector = FrameCollector(self._inputs, bundler)
        sizes_px = {name: c.size_px for name, c in self._inputs.items() if any(c.size_px)}
        guard = SizeGuard(sizes_px, self._collector)
        # who looks at the pictures joins it
        self.hub = FrameHub(self._inputs, guard, bundler=bundler)
        self._mountings = Mountings(session.rig, self.hub)
        self._captures = [
            CaptureThread(c.source, self.hub, self.died, c.expected_hz) for c in session.cameras
        ]
        smoother = Smoother(config.smoothing.preset, skeleton_of(session.shape))
        self._loop = PipelineLoop(
            self._collector,
            session.tracker,
            session.shape,
            smoother,
            self._publish,
            self.died,
            _absence(config, session),
        )
        self._seq = itertools.count()
        self._ended = threading.Event()
        self._death: BaseException | None = None
        self._opened = ExitStack()
        self._started_unix_ns = 0
        self.newest: tuple[BodyState, Skeleton] | None = None  # published; replaced whole

    def __enter__(self) -> "Daemon":
        """Open the outputs, then start the threads. Raises what opening an output raises."""
        with ExitStack() as opened:
            for sink in self._sinks:
                opened.callback(sink.close)
                sink.open()
            self._opened = opened.pop_all()
        self._started_unix_ns = time.time_ns()
        rig = self._session.rig
        if self._zenoh and rig:
            self._zenoh.set_state(
                calibration_info(rig, instance=self.instance, source=self._session.rig_source)
            )
        self._loop.start()
        for capture in self._captures:
            capture.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """First everything lets go, then everything closes."""
        self._loop.let_go()
        for capture in self._captures:
            capture.let_go()
        until_s = time.monotonic() + STOP_S
        self._loop.stop(max(0.0, until_s - time.monotonic()))
        for capture in self._captures:
            capture.stop(max(0.0, until_s - time.monotonic()))
        self._opened.close()

    def died(self, error: BaseException) -> None:
        """A thread ended unexpectedly: so must the process."""
        self._death = self._death or error
        self._ended.set()

    def end(self) -> None:
        """Make `wait` return; from any thread or a signal handler."""
        self._ended.set()

    def wait(self, timeout_s: float) -> bool:
        """Whether it is over: asked to end, or every recording has ended.

        Raises the MocapdError that killed a thread, ThreadDiedError for anything else.
        """
        ended = self._ended.wait(timeout_s)
        if isinstance(self._death, MocapdError):
            raise self._death
        if self._death is not None:
            raise ThreadDiedError from self._death
        states = [capture.status().state for capture in self._captures]
        return ended or all(state is CaptureState.ENDED for state in states)

    def statuses(self) -> dict[str, CaptureStatus]:
        """How each camera fares, by id; from any thread."""
        return {status.camera: status for status in (c.status() for c in self._captures)}

    def snapshot(self) -> Snapshot:
        """How everything fares now."""
        return Snapshot(
            self._loop.metrics(),
            self.statuses(),
            {sink.name: sink.status() for sink in self._sinks},
            {name: self._mountings.of(name) for name in self._inputs},
        )

    def tell(self, snapshot: Snapshot) -> None:
        """Look after the cameras, then health and camera status to Zenoh; call it about once a second."""
        self._mountings.look()
        if self._zenoh is None:
            return
        self._zenoh.set_state(
            health_message(
                self.instance,
                self._started_unix_ns,
                time.time_ns(),
                snapshot.metrics,
                snapshot.outputs,
            )
        )
        for name, status in snapshot.cameras.items():
            self._zenoh.set_state(
                camera_message(
                    self.instance,
                    self._inputs[name],
                    status,
                    snapshot.metrics.cameras[name],
                    snapshot.mountings[name],
                )
            )

    def _publish(self, body: BodyState, skeleton: Skeleton, _frames: FrameSet) -> None:
        self.newest = body, skeleton
        frame = skeleton_frame(
            body,
            skeleton,
            instance=self.instance,
            seq=next(self._seq),
            publish_monotonic_ns=monotonic_ns(),
            unix_from_monotonic_ns=unix_from_monotonic_ns(),
        )
        for sink in self._sinks:
            sink.send(frame)


def _absence(config: Config, session: Session) -> Absence | None:
    """Who tells that no frames come; nobody where recordings are played, which end."""
    if all(camera.source.recorded for camera in session.cameras):
        return None
    tracker = session.tracker
    return Absence(tracker.name, len(skeleton_of(session.shape).names), config.tracker.coast_s)
