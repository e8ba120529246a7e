"""The composition root: outputs that live from start to stop, and one replaceable session."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mocapd.body.shape import skeleton_of
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.config.sections import Config
from mocapd.latch import EndLatch
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.messages import CalibrationInfo, CameraStatus, Facing
from mocapd.pipeline.body_hub import BodyHub
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.pipeline.metrics import Metrics
from mocapd.service.health import camera_message, gone_message, health_message
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.publisher import Publisher
from mocapd.service.running_session import RunningSession
from mocapd.session.session import Session
from mocapd.types import Rig


@dataclass(frozen=True, slots=True)
class Snapshot:
    """How everything fares, for status line and page. `preparing`: what a first start still prepares, in words."""

    metrics: Metrics
    cameras: dict[str, CaptureStatus]
    outputs: dict[str, SinkStatus]
    mountings: Mapping[str, Mounting] = field(default_factory=dict)
    preparing: str = ""


class Service:
    """Runs from `__enter__` to `__exit__`; its owner waits in `wait` and may `replace` the session.

    `died`, `end`, `recenter` and the queries of the running session are thread-safe; the rest is for the owner.
    """

    def __init__(
        self, config: Config, session: Session, outputs: OpenOutputs | None = None
    ) -> None:
        """outputs: of this configuration, if open already; closed with the service."""
        self._outputs = OpenOutputs(config) if outputs is None else outputs
        self.instance = self._outputs.instance
        self._sinks = self._outputs.sinks
        self._publisher = Publisher(self._sinks, self.instance)
        self.bodies = BodyHub(self._publisher)  # consumers of bodies join it
        self._running = RunningSession(config, session, self.bodies, self.died)
        self._earlier: Metrics | None = None  # of all sessions before
        self._earlier_cameras: dict[str, CaptureStatus] = {}  # of the sessions that had them
        self.preparing = ""  # see Snapshot; its owner knows
        self._ended = EndLatch()
        self._started_unix_ns = 0
        self._published: dict[str, tuple[object, ...]] = {}  # camera troubles

    def __enter__(self) -> "Service":
        """Opens the outputs, then starts the threads. Raises the error of a failing output."""
        self._outputs.open()
        self._started_unix_ns = time.time_ns()
        if self.session.rig:
            self._publish_calibration()
        self._begin()
        return self

    def __exit__(self, *_: object) -> None:
        """Stops the session, then closes the outputs."""
        self._running.stop()
        self._outputs.close()

    def replace(self, config: Config, session: Session) -> None:
        """Replaces the session on the same outputs: frame numbers continue, state is published again.

        With an unchanged rig the tracker starts from the newest body. Blocks until the cameras are released, as a
        webcam opens only once. Consumers of the old session's frames must have left. After `end` no session starts.
        """
        running = RunningSession(config, session, self.bodies, self.died)
        before, world = self._running.inputs, self.session.rig
        self._running.stop()
        earlier, cameras = _sum_counts(self._running.metrics(), self._earlier), self.statuses()
        self._earlier, self._earlier_cameras, self._running = earlier, cameras, running
        if self._ended.is_set():
            return
        newest = self.bodies.newest()
        if newest is not None and _is_same_world(world, session.rig):
            session.tracker.reset(near=newest.body)
        if world or session.rig:
            self._publish_calibration()
        for name, camera in before.items():
            if name not in running.inputs:
                self._publisher.publish_state(gone_message(self.instance, name, camera))
        self._begin()

    def _begin(self) -> None:
        shape = self.session.shape
        self._publisher.begin(skeleton_of(shape), shape.stature_m)
        self._running.start()

    # -- the session that runs -------------------------------------------------------------------

    @property
    def config(self) -> Config:
        return self._running.config

    @property
    def session(self) -> Session:
        return self._running.session

    @property
    def hub(self) -> FrameHub:
        return self._running.hub

    @property
    def idle(self) -> IdleMoments:
        """The idle moments of the running session's pipeline."""
        return self._running.idle

    def statuses(self) -> dict[str, CaptureStatus]:
        """The status of each camera, by id; its counters run as long as the sessions have it."""
        return self._statuses_of(self._running)

    def snapshot(self) -> Snapshot:
        """The current state; counters run since the start of the service."""
        return self._snapshot_of(self._running)

    @property
    def uptime_s(self) -> float:
        """Time since the outputs were opened [s]."""
        return self._outputs.uptime_s

    def _statuses_of(self, running: RunningSession) -> dict[str, CaptureStatus]:
        earlier = self._earlier_cameras
        return {n: s.counting_on(earlier.get(n)) for n, s in running.statuses().items()}

    def _snapshot_of(self, running: RunningSession) -> Snapshot:
        return Snapshot(
            _sum_counts(running.metrics(), self._earlier),
            self._statuses_of(running),
            {sink.name: sink.status() for sink in self._sinks},
            running.mountings(),
            self.preparing,
        )

    # -- its end ---------------------------------------------------------------------------------

    def died(self, error: BaseException) -> None:
        """Ends the service after the unexpected end of a thread."""
        self._ended.died(error)

    def end(self) -> None:
        """Makes `wait` return; thread-safe and signal-safe."""
        self._ended.set()

    def wait(self, timeout_s: float) -> bool:
        """True when the service is over: after `end`, or when every recording has ended.

        Raises the MocapdError that killed a thread, ThreadDiedError for anything else.
        """
        return self._ended.wait(timeout_s) or self._running.over

    def watch(self) -> None:
        """Runs the watchdogs; call several times a second. Raises StuckStepError."""
        self._running.watch()

    # -- state for the outputs -------------------------------------------------------------------

    def has_news(self, snapshot: Snapshot) -> bool:
        """True if a camera's state has changed since the last `publish_status`."""
        return _troubles(snapshot) != self._published

    def publish_status(self, snapshot: Snapshot) -> None:
        """Publishes health and camera status; call it about once a second."""
        running = self._running
        self._published = _troubles(snapshot)
        self._publisher.publish_state(
            health_message(
                self.instance,
                self._started_unix_ns,
                time.time_ns(),
                snapshot.metrics,
                snapshot.outputs,
                running.detail,
            )
        )
        for message in self._camera_messages(running, snapshot):
            self._publisher.publish_state(message)

    def camera_messages(self) -> tuple[CameraStatus, ...]:
        """The status of each camera of the running session."""
        running = self._running
        return self._camera_messages(running, self._snapshot_of(running))

    def _camera_messages(
        self, running: RunningSession, snapshot: Snapshot
    ) -> tuple[CameraStatus, ...]:
        return tuple(
            camera_message(
                self.instance,
                running.inputs[name],
                status,
                snapshot.metrics.cameras[name],
                snapshot.mountings[name],
            )
            for name, status in snapshot.cameras.items()
        )

    def recenter(self) -> Facing:
        """Defines the person's heading as forward, for outputs that use it. Raises UnavailableError without a person in
        view."""
        return self._publisher.recenter()

    def _publish_calibration(self) -> None:
        """Publishes the calibration; an empty one where there is none."""
        session, instance = self.session, self.instance
        self._publisher.publish_state(
            calibration_info(session.rig, instance=instance, source=session.rig_source)
            if session.rig
            else CalibrationInfo(instance, "", ())
        )


def _troubles(snapshot: Snapshot) -> dict[str, tuple[object, ...]]:
    """The part of the cameras' states whose changes are published at once."""
    return {
        name: (status.state, status.is_silent, status.reason, status.notice)
        for name, status in snapshot.cameras.items()
    }


def _is_same_world(before: Rig | None, after: Rig | None) -> bool:
    """True if both rigs have the same world frame: a common camera has not moved."""
    if before is None or after is None:
        return False
    earlier = {camera.name: camera for camera in before.cameras}
    return any(
        camera.name in earlier
        and np.array_equal(camera.R, earlier[camera.name].R)
        and np.array_equal(camera.t_m, earlier[camera.name].t_m)
        for camera in after.cameras
    )


def _sum_counts(metrics: Metrics, earlier: Metrics | None) -> Metrics:
    """Adds the counters of earlier sessions."""
    if earlier is None:
        return metrics
    cameras = {
        name: replace(camera, counts=camera.counts + earlier.cameras[name].counts)
        if name in earlier.cameras
        else camera
        for name, camera in metrics.cameras.items()
    }
    return replace(
        metrics,
        cameras=cameras,
        published=metrics.published + earlier.published,
        sets_made=metrics.sets_made + earlier.sets_made,
        sets_dropped=metrics.sets_dropped + earlier.sets_dropped,
        latency_counts=metrics.latency_counts + earlier.latency_counts,
    )
