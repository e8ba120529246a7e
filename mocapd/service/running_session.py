"""The replaceable part of a service: the threads of one session's cameras and pipeline."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

from mocapd.body.shape import skeleton_of
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.camera_thread.capture_watchdog import CaptureWatchdog
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.webcam.plug_events import PlugEvents
from mocapd.config.sections import Config
from mocapd.pipeline.absence import Absence
from mocapd.pipeline.body_hub import BodyHub
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.pipeline.loop import PipelineLoop
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.size_guard import SizeGuard
from mocapd.pipeline.smoothing import Smoother
from mocapd.service.camera_watch import CameraWatch
from mocapd.service.room_memory import RoomMemory
from mocapd.service.step_watch import StepWatch
from mocapd.session.camera_inputs import bundler_params
from mocapd.session.session import Session

STOP_S = 1.4  # timeout of stopping all threads; a stalled camera takes a second [s]


class RunningSession:
    """Runs from `start` to `stop`, which the owner calls; `statuses` and `metrics` are thread-safe.

    `died` is called in a thread that ends unexpectedly, with its exception.
    """

    def __init__(
        self,
        config: Config,
        session: Session,
        bodies: BodyHub,
        died: Callable[[BaseException], None],
    ) -> None:
        self.config, self.session = config, session
        self.inputs = {camera.source.name: camera for camera in session.cameras}
        bundler = bundler_params(config)
        collector = FrameCollector(self.inputs, bundler)
        sizes_px = {name: c.size_px for name, c in self.inputs.items() if any(c.size_px)}
        guard = SizeGuard(sizes_px, collector)
        sources = [camera.source for camera in session.cameras]
        rooms = RoomMemory(config.state_dir)
        stature_m = session.calibration.wearer.stature_m
        self.idle = IdleMoments()
        self._cameras = CameraWatch(sources, session.rig, guard, rooms, stature_m, self.idle, died)
        # consumers of pictures join it
        self.hub = FrameHub(self.inputs, self._cameras, bundler=bundler)
        self._captures = [
            CaptureThread(
                c.source,
                self.hub,
                died,
                c.expected_hz,
                size_px=c.size_px if any(c.size_px) else None,
                presence=self._cameras,
            )
            for c in session.cameras
        ]
        self._plugs = PlugEvents(self._look_again)
        self._watchdog = CaptureWatchdog(self._captures)
        self._steps = StepWatch(config.tracker.stuck_s)
        smoother = Smoother(config.smoothing.preset, skeleton_of(session.shape))
        self._loop = PipelineLoop(
            collector,
            session.tracker,
            session.shape,
            smoother,
            bodies,
            died,
            _absence(config, session),
            lambda: self._cameras.off_m,
            self.idle,
        )

    def start(self) -> None:
        """Starts all threads; returns at once."""
        self._loop.start()
        self._cameras.start()
        self._plugs.start()
        for capture in self._captures:
            capture.start()

    def stop(self) -> None:
        """Signals all threads, then joins them within STOP_S."""
        self._plugs.stop()
        self._cameras.stop()
        self._loop.let_go()
        for capture in self._captures:
            capture.let_go()
        until_s = time.monotonic() + STOP_S
        self._loop.stop(max(0.0, until_s - time.monotonic()))
        for capture in self._captures:
            capture.stop(max(0.0, until_s - time.monotonic()))

    def _look_again(self) -> None:
        for capture in self._captures:
            capture.look_again()

    @property
    def over(self) -> bool:
        """True once every recording has ended."""
        return all(c.status().state is CaptureState.ENDED for c in self._captures)

    def statuses(self) -> dict[str, CaptureStatus]:
        """The status of each camera, by id."""
        return {
            status.camera: self._with_notice(status)
            for status in (c.status() for c in self._captures)
        }

    def _with_notice(self, status: CaptureStatus) -> CaptureStatus:
        notice = self._cameras.notice(status.camera)
        return replace(status, notice=notice) if notice else status

    def metrics(self) -> Metrics:
        """The pipeline's metrics."""
        return self._loop.metrics()

    def mountings(self) -> Mapping[str, Mounting]:
        """The last result of the mounting check of each camera."""
        return {name: self._cameras.mounting(name) for name in self.inputs}

    @property
    def detail(self) -> str:
        """Trouble of the pipeline, for users; empty without trouble."""
        return self._steps.detail

    def watch(self) -> None:
        """Runs the watchdogs; call at least once a second, from one thread. Raises StuckStepError."""
        self._steps.look(self._loop.step_s)
        self._watchdog.watch()


def _absence(config: Config, session: Session) -> Absence | None:
    """The reporter of missing frames; None for recordings, which end."""
    if all(camera.source.recorded for camera in session.cameras):
        return None
    n_joints = len(skeleton_of(session.shape).names)
    return Absence(session.tracker.name, n_joints, config.tracker.coast_s)
