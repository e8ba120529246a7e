"""The composition root: outputs that live from start to stop, and under them one session after another."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mocapd.body.shape import skeleton_of
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.config.sections import Config
from mocapd.errors import MocapdError
from mocapd.latch import Latch
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.messages import CalibrationInfo, CameraStatus, Facing
from mocapd.pipeline.body_hub import BodyHub
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.metrics import Metrics
from mocapd.service.health import camera_message, gone_message, health_message
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.publisher import Publisher
from mocapd.service.running_session import RunningSession
from mocapd.session.session import Session
from mocapd.types import Rig


class ThreadDiedError(RuntimeError):
    """A thread ended by what nobody expected, which is the `__cause__`."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """How everything fares, for status line and page. `preparing`: what a first start still prepares, in words."""

    metrics: Metrics
    cameras: dict[str, CaptureStatus]
    outputs: dict[str, SinkStatus]
    mountings: Mapping[str, Mounting] = field(default_factory=dict)
    preparing: str = ""


class Service:
    """Runs from `__enter__` to `__exit__`; meanwhile its owner waits in `wait`, and may `replace` the session.

    `died`, `end`, `recenter` and what tells of the session that runs may be called from any thread,
    everything else by the owner.
    """

    def __init__(
        self, config: Config, session: Session, outputs: OpenOutputs | None = None
    ) -> None:
        """outputs: those of this configuration where they are open already; closed with the service."""
        self._outputs = OpenOutputs(config) if outputs is None else outputs
        self.instance = self._outputs.instance
        self._sinks = self._outputs.sinks
        self._publisher = Publisher(self._sinks, self.instance)
        self.bodies = BodyHub(self._publisher)  # who works with the bodies joins it
        self._running = RunningSession(config, session, self.bodies, self.died)
        self._earlier: Metrics | None = None  # of all sessions before
        self.preparing = ""  # see Snapshot; its owner knows
        self._ended = Latch()
        self._death: BaseException | None = None
        self._started_unix_ns = 0
        self._told: dict[str, tuple[object, ...]] = {}  # the cameras' troubles

    def __enter__(self) -> "Service":
        """Open the outputs, then start the threads. Raises what opening an output raises."""
        self._outputs.open()
        self._started_unix_ns = time.time_ns()
        if self.session.rig:
            self._tell_calibration()
        self._begin()
        return self

    def __exit__(self, *_: object) -> None:
        """First everything lets go, then everything closes."""
        self._running.stop()
        self._outputs.close()

    def replace(self, config: Config, session: Session) -> None:
        """Go on with this session, on the same outputs: frames are numbered on, and state is told anew.

        Where the cameras stand as before, the tracker begins from the newest body. Takes as long as the cameras
        take to let go: a webcam opens only once. Whoever has joined the old session's frames has left them. Once
        the service is told to end, nothing begins any more.
        """
        running = RunningSession(config, session, self.bodies, self.died)
        before, world = self._running.inputs, self.session.rig
        self._running.stop()
        self._earlier = _added(self._running.metrics(), self._earlier)
        self._running = running
        if self._ended.is_set():
            return
        newest = self.bodies.newest()
        if newest is not None and _is_same_world(world, session.rig):
            session.tracker.reset(near=newest.body)
        if world or session.rig:
            self._tell_calibration()
        for name, camera in before.items():
            if name not in running.inputs:
                self._publisher.tell(gone_message(self.instance, name, camera))
        self._begin()

    def _begin(self) -> None:
        shape = self.session.shape
        self._publisher.begin(skeleton_of(shape), shape.stature_m)
        self._running.start()

    # -- the session that runs -------------------------------------------------------------------

    @property
    def config(self) -> Config:
        """What it was made from."""
        return self._running.config

    @property
    def session(self) -> Session:
        """Cameras, rig and tracker."""
        return self._running.session

    @property
    def hub(self) -> FrameHub:
        """Its cameras' pictures."""
        return self._running.hub

    def statuses(self) -> dict[str, CaptureStatus]:
        """How each camera fares, by id."""
        return self._running.statuses()

    def snapshot(self) -> Snapshot:
        """How everything fares now; what is counted is counted since the start of the service."""
        return self._snapshot_of(self._running)

    @property
    def uptime_s(self) -> float:
        """Since its outputs were opened [s]."""
        return self._outputs.uptime_s

    def _snapshot_of(self, running: RunningSession) -> Snapshot:
        return Snapshot(
            _added(running.metrics(), self._earlier),
            running.statuses(),
            {sink.name: sink.status() for sink in self._sinks},
            running.mountings(),
            self.preparing,
        )

    # -- its end ---------------------------------------------------------------------------------

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
        return ended or self._running.over

    def watch(self) -> None:
        """Look after what may hang: call it several times a second. Raises StuckStepError."""
        self._running.watch()

    # -- state for the outputs -------------------------------------------------------------------

    def has_news(self, snapshot: Snapshot) -> bool:
        """Whether something has happened to a camera that was not told yet."""
        return _troubles(snapshot) != self._told

    def tell(self, snapshot: Snapshot) -> None:
        """Look after the cameras, then health and camera status to the outputs; call it about once a second."""
        running = self._running
        self._told = _troubles(snapshot)
        running.look()
        self._publisher.tell(
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
            self._publisher.tell(message)

    def camera_messages(self) -> tuple[CameraStatus, ...]:
        """How each camera of the session that runs fares now."""
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
        """The way the person faces is forward from now on: for the outputs that turn it so. Raises
        UnavailableError when nobody is seen."""
        return self._publisher.recenter()

    def _tell_calibration(self) -> None:
        """Also that there is none any more."""
        session, instance = self.session, self.instance
        self._publisher.tell(
            calibration_info(session.rig, instance=instance, source=session.rig_source)
            if session.rig
            else CalibrationInfo(instance, "", ())
        )


def _troubles(snapshot: Snapshot) -> dict[str, tuple[object, ...]]:
    """What of the cameras' states is news when it changes."""
    return {
        name: (one.state, one.is_silent, one.reason, one.notice)
        for name, one in snapshot.cameras.items()
    }


def _is_same_world(before: Rig | None, after: Rig | None) -> bool:
    """Whether a place is told alike by both: a camera of both has not moved."""
    if before is None or after is None:
        return False
    known = {camera.name: camera for camera in before.cameras}
    return any(
        camera.name in known
        and np.array_equal(camera.R, known[camera.name].R)
        and np.array_equal(camera.t_m, known[camera.name].t_m)
        for camera in after.cameras
    )


def _added(metrics: Metrics, earlier: Metrics | None) -> Metrics:
    """With what was counted before."""
    if earlier is None:
        return metrics
    return replace(
        metrics,
        published=metrics.published + earlier.published,
        sets_made=metrics.sets_made + earlier.sets_made,
        sets_dropped=metrics.sets_dropped + earlier.sets_dropped,
        latency_counts=metrics.latency_counts + earlier.latency_counts,
    )
