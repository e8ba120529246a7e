"""The pipeline's thread: newest frame set -> tracker -> smoother -> bodies; without frames, bodies of `absence`."""

import threading
from collections.abc import Callable
from dataclasses import replace

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.clock import monotonic_ns, seconds
from mocapd.pipeline.absence import Absence
from mocapd.pipeline.body_hub import BodySample, TakesBodies
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.effort_control import EffortControl
from mocapd.pipeline.idle_collection import IdleCollection
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.pipeline.metrics import Metrics, MetricsRecorder
from mocapd.pipeline.other_programs import OtherPrograms
from mocapd.pipeline.slowness import SlownessWatch
from mocapd.pipeline.smoothing import Smoother
from mocapd.tracking.base import EffortTracker, LearningTracker, Track, Tracker
from mocapd.tracking.tracking_state import lower_confidence
from mocapd.types import BodyState, FrameSet, Tracking

OnDeath = Callable[[BaseException], None]

LOOK_UP_S = 0.5  # interval of checks for `stop` without frames [s]
SETTLE_S = 2.0  # of a track, before its load counts: a search and the first fits take longer than what follows [s]


class PipelineLoop:
    """Runs one tracker on the collector's newest frame sets until stopped, and owns the wearer's shape. It lowers the
    effort of a tracker that is too slow for its frame sets, if the tracker supports it.

    `bodies` gets each body in the pipeline's thread, also while `lost`, and must not block; without frames it gets the
    bodies of `absence`, if given, with an empty frame set. `off_m`: the persistent disagreement of the cameras' views,
    called at each frame set. `idle` is told when no frame set waits. `on_death` is called in that thread with an unexpected
    exception, which is then raised again; not at `stop`.
    """

    def __init__(
        self,
        collector: FrameCollector,
        tracker: Tracker,
        shape: BodyShape,
        smoother: Smoother,
        bodies: TakesBodies,
        on_death: OnDeath,
        absence: Absence | None = None,
        off_m: Callable[[], float] = lambda: 0.0,
        idle: IdleMoments | None = None,
    ) -> None:
        self._collector = collector
        self._tracker = tracker
        self._shape = shape  # the wearer's: outlives the tracker's state
        self._skeleton = skeleton_of(shape)
        self._smoother = smoother
        self._bodies = bodies
        self._on_death = on_death
        self._absence, self._off_m, self._idle = absence, off_m, idle
        self._stopping = threading.Event()
        self._began_ns: int | None = None  # start of the current step, or of learning from it
        self._recorder = MetricsRecorder()
        self._effort = EffortControl()
        self._tracked_since_ns: int | None = None
        self._slowness, self._others = SlownessWatch(), OtherPrograms()
        # A daemon thread: a kernel that hangs must not keep the process from ending.
        self._thread = threading.Thread(target=self._run, name="pipeline", daemon=True)

    def start(self) -> None:
        """Start the thread. Warm up the tracker's kernels before, else the first frames wait."""
        self._thread.start()

    def let_go(self) -> None:
        """First phase of stopping: wakes the thread; never blocks."""
        self._stopping.set()
        self._collector.close()

    def stop(self, timeout_s: float = 1.0) -> bool:
        """Wake and join. False when a step still runs after `timeout_s` [s]."""
        self.let_go()
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    @property
    def step_s(self) -> float:
        """Time of the current step so far [s]; 0 between steps. From any thread."""
        began_ns = self._began_ns
        return 0.0 if began_ns is None else seconds(monotonic_ns() - began_ns)

    def metrics(self) -> Metrics:
        """A snapshot, at any time from any thread."""
        return self._recorder.snapshot(self._collector.counts(), monotonic_ns())

    def _run(self) -> None:
        try:
            with IdleCollection() as garbage:
                self._loop(garbage)
        except BaseException as error:
            self._on_death(error)
            raise

    def _loop(self, garbage: IdleCollection) -> None:
        if self._absence is not None:
            self._absence.begin(monotonic_ns())
        while not self._stopping.is_set() and not self._collector.closed:
            frames = self._collector.get(self._wait_s())
            if frames is not None:
                self._one(frames)
            elif self._absence is not None and not self._collector.closed:
                self._none(self._absence)
            now_ns, is_idle = monotonic_ns(), self._collector.idle
            if is_idle or garbage.is_overdue(now_ns):
                garbage.idle(now_ns)
            if is_idle and self._idle is not None:
                self._idle.begin()
            self._recorder.count_turn()

    def _one(self, frames: FrameSet) -> None:
        number = self._collector.sets
        self._began_ns = start_ns = monotonic_ns()
        track = self._tracker.step(frames, self._shape)
        step_ns, self._began_ns = monotonic_ns() - start_ns, None
        if self._stopping.is_set():
            return  # `stop` may have given up waiting, and another session publishes by now
        if track.shape is not self._shape:
            self._shape = track.shape
            self._skeleton = self._smoother.skeleton = skeleton_of(track.shape)
        body = lower_confidence(self._smoother.step(track.body), self._off_m())
        if self._absence is not None:
            body = self._absence.came(body, monotonic_ns())
        self._bodies.put(BodySample(replace(track, body=body), self._skeleton, frames))
        now_ns = monotonic_ns()
        self._recorder.record_body(frames, body, step_ns, now_ns, track.lost_reason)
        if isinstance(self._tracker, LearningTracker):
            self._began_ns = now_ns
            self._tracker.learn(is_late=not self._collector.idle)
            now_ns, self._began_ns = monotonic_ns(), None
        busy_ns = now_ns - start_ns
        others = self._others.share(now_ns)
        self._recorder.set_slowness(self._slowness.update(number, busy_ns, now_ns, others))
        self._spare(body, number, busy_ns, now_ns)

    def _spare(self, body: BodyState, number: int, busy_ns: int, now_ns: int) -> None:
        """Choose the effort for the next frame set, after the number-th gave this body and took busy_ns."""
        if not isinstance(self._tracker, EffortTracker):
            return
        if body.tracking is Tracking.LOST:
            self._tracked_since_ns = None
            return
        if self._tracked_since_ns is None:
            self._tracked_since_ns = body.t_ns
        if seconds(body.t_ns - self._tracked_since_ns) < SETTLE_S:
            return
        before = self._effort.effort
        now = self._effort.update(body.t_ns, number, busy_ns, now_ns)
        if now is not before:
            self._tracker.set_effort(now)
            self._recorder.effort_changed(now)

    def _none(self, absence: Absence) -> None:
        """Publish a body without frames, if one is due."""
        body = absence.next_body(monotonic_ns())
        if body is not None:
            nothing = FrameSet(body.t_ns, {})
            self._bodies.put(BodySample(Track(body, self._shape), self._skeleton, nothing))
            self._recorder.absent(body)

    def _wait_s(self) -> float:
        """Timeout for the next frames, until another task is due."""
        due_ns = self._absence.due_ns if self._absence is not None else None
        if due_ns is None:
            return LOOK_UP_S
        return min(LOOK_UP_S, max(0.0, seconds(due_ns - monotonic_ns())))
