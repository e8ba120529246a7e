"""The pipeline's thread: bodies out for frames in, metrics, stopping, and death that is heard of."""

import gc
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from mocapd.body.shape import BodyShape, mean_shape, skeleton_of
from mocapd.clock import monotonic_ns
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.idle_collection import ALL_EVERY_NS, YOUNG_EVERY_NS, IdleCollection
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.pipeline.loop import PipelineLoop
from mocapd.pipeline.smoothing import Smoother
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import LostReason, Probe, Track, Tracker, lost_body, no_probe
from mocapd.tracking.effort import Effort
from mocapd.types import BodyState, Frame, FrameSet, Tracking
from tests.pipeline.free_running import PIXELS

SHAPE = mean_shape(1.7)
MS = 1_000_000


class FailingTracker:
    """Breaks at its third step."""

    name = "failing"

    def __init__(self) -> None:
        self.probe: Probe = no_probe
        self._inner = CannedTracker()
        self._steps = 0

    def reset(self, near: BodyState | None = None) -> None: ...

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self._steps += 1
        if self._steps == 3:
            raise ArithmeticError("singular")
        return self._inner.step(frames, shape)


class WaitingTracker(CannedTracker):
    """Its steps take until they are let go."""

    def __init__(self) -> None:
        super().__init__()
        self.entered, self.let_go = threading.Semaphore(0), threading.Semaphore(0)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self.entered.release()
        self.let_go.acquire()
        return super().step(frames, shape)


class SlowTracker(CannedTracker):
    """At the full effort it takes as long as three frame sets need to come; otherwise it is quick."""

    def __init__(self) -> None:
        super().__init__()
        self.effort, self.lowered = Effort.FULL, threading.Event()
        self.sets: Callable[[], int] = lambda: 0

    def set_effort(self, effort: Effort) -> None:
        self.effort = effort
        self.lowered.set()

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        before = self.sets()
        while self.effort is Effort.FULL and self.sets() < before + 3:
            time.sleep(0.001)
        return super().step(frames, shape)


class StudiousTracker(CannedTracker):
    """Learns until it is let go."""

    def __init__(self) -> None:
        super().__init__()
        self.let_go = threading.Event()

    def learn(self, is_late: bool = False) -> None:
        self.let_go.wait()


class LateTracker(WaitingTracker):
    """Notes whether it was late."""

    def __init__(self) -> None:
        super().__init__()
        self.late: list[bool] = []

    def learn(self, is_late: bool = False) -> None:
        self.late.append(is_late)


class UnseeingTracker(CannedTracker):
    """Finds nobody though somebody moves."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        reason = LostReason.UNRECOGNISED
        return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=reason)


class CountedMoments(IdleMoments):
    """Counts them."""

    begun = 0

    def begin(self) -> None:
        self.begun += 1


class Run:
    """A loop on two cameras, fed by hand, with what came out of it."""

    def __init__(self, tracker: Tracker, idle: IdleMoments | None = None) -> None:
        self.collector = FrameCollector(("a", "b"))
        self.out: list[BodySample] = []
        self.deaths: list[BaseException] = []
        self.news = threading.Condition()
        self.loop = PipelineLoop(
            self.collector,
            tracker,
            SHAPE,
            Smoother("balanced", skeleton_of(SHAPE)),
            BodyHub(self),
            self._die,
            idle=idle,
        )
        self._seq = 0

    def put(self, sample: BodySample) -> None:
        with self.news:
            self.out.append(sample)
            self.news.notify_all()

    def _die(self, error: BaseException) -> None:
        with self.news:
            self.deaths.append(error)
            self.news.notify_all()

    def feed(self) -> None:
        t_ns = monotonic_ns() - 5 * MS
        for name in ("a", "b"):
            self.collector.put(Frame(name, self._seq, t_ns, PIXELS))
        self._seq += 1

    def wait_for(self, condition: Callable[[], bool]) -> None:
        with self.news:
            assert self.news.wait_for(condition, 120.0)

    def feed_until_out(self, n: int) -> None:
        for k in range(n):
            self.feed()
            self.wait_for(lambda k=k: len(self.out) > k)  # type: ignore[misc]


def test_a_body_is_published_before_the_tracker_learns_from_it() -> None:
    tracker = StudiousTracker()
    run = Run(tracker)
    run.loop.start()
    run.feed_until_out(1)
    run.feed()
    assert not run.loop.stop(0.05)  # it still learns from the first
    tracker.let_go.set()
    assert run.loop.stop(120.0)


def test_a_tracker_is_told_that_a_frame_set_waits() -> None:
    tracker = LateTracker()
    run = Run(tracker)
    run.loop.start()
    run.feed()
    assert tracker.entered.acquire(timeout=60.0)
    run.feed()
    tracker.let_go.release(2)
    run.wait_for(lambda: len(run.out) == 2)
    assert run.loop.stop(20.0)
    assert tracker.late == [True, False]


def test_each_pair_gives_a_body_in_order_and_metrics_tell_of_it() -> None:
    run = Run(CannedTracker())
    run.loop.start()
    run.feed_until_out(12)
    assert run.loop.stop(20.0)
    times = [one.body.t_ns for one in run.out]
    assert times == sorted(set(times))
    assert all(one.body.t_ns == one.frames.t_ns for one in run.out)
    assert all(one.body.tracking is Tracking.LIVE for one in run.out)
    metrics = run.loop.metrics()
    assert metrics.published >= 11  # the last is recorded after it is out
    assert metrics.sets_made == 12
    assert metrics.sets_dropped == 0
    assert metrics.latency_ms.median >= 5.0
    assert metrics.latency_ms.p95 >= metrics.latency_ms.median
    assert metrics.step_ms.median < metrics.latency_ms.median
    assert metrics.tracker == "canned"
    assert metrics.tracking is Tracking.LIVE
    assert metrics.cameras["a"].counts.received == 12
    assert not run.deaths


def test_a_moment_without_a_waiting_frame_set_is_told_to_other_work() -> None:
    idle = CountedMoments()
    run = Run(CannedTracker(), idle)
    run.loop.start()
    run.feed_until_out(3)
    assert run.loop.stop(20.0)
    assert idle.begun


def test_metrics_tell_why_nobody_is_tracked() -> None:
    run = Run(UnseeingTracker())
    assert run.loop.metrics().lost_reason is None
    run.loop.start()
    run.feed_until_out(2)
    assert run.loop.stop(20.0)
    assert run.loop.metrics().lost_reason is LostReason.UNRECOGNISED


def test_while_a_step_takes_long_the_newest_waits_and_what_is_older_is_dropped() -> None:
    tracker = WaitingTracker()
    run = Run(tracker)
    run.loop.start()
    assert run.loop.step_s == 0.0
    run.feed()
    assert tracker.entered.acquire(timeout=60.0)
    for _ in range(200):
        run.feed()
    assert run.loop.step_s > 0.0
    tracker.let_go.release(2)
    assert tracker.entered.acquire(timeout=60.0)
    run.wait_for(lambda: len(run.out) == 2)
    seqs = [{frame.seq for frame in one.frames.frames.values()} for one in run.out]
    assert seqs == [{0}, {200}]
    assert run.loop.metrics().sets_dropped == 199
    assert run.loop.stop(20.0)


def test_a_tracker_that_is_too_slow_is_stepped_with_less_effort_which_metrics_tell() -> None:
    tracker = SlowTracker()
    run = Run(tracker)
    tracker.sets = lambda: run.collector.sets
    assert run.loop.metrics().effort is Effort.FULL
    run.loop.start()
    until_s = time.monotonic() + 120.0
    while not tracker.lowered.wait(0.002):
        run.feed()
        assert time.monotonic() < until_s
    run.feed_until_out(len(run.out) + 2)
    assert run.loop.stop(20.0)
    assert run.loop.metrics().effort is tracker.effort is Effort.SAVING


def test_a_search_that_takes_long_lowers_no_effort(monkeypatch: pytest.MonkeyPatch) -> None:
    class Searching(SlowTracker):
        def step(self, frames: FrameSet, shape: BodyShape) -> Track:
            super().step(frames, shape)
            return Track(lost_body(frames.t_ns, self.name), shape)

    monkeypatch.setattr("mocapd.pipeline.loop.SETTLE_S", 0.0)
    tracker = Searching()
    run = Run(tracker)
    tracker.sets = lambda: run.collector.sets
    run.loop.start()
    until_s = time.monotonic() + 2.0  # with a body it falls after less
    while time.monotonic() < until_s:
        run.feed()
        time.sleep(0.002)
    assert run.out
    assert not tracker.lowered.is_set()
    tracker.effort = Effort.LEAST  # lets the last step end
    assert run.loop.stop(20.0)


def test_metrics_tell_that_most_frame_sets_are_skipped() -> None:
    tracker = WaitingTracker()
    run = Run(tracker)
    run.loop.start()
    for step in range(6):
        for _ in range(10):
            run.feed()
        assert tracker.entered.acquire(timeout=60.0)
        tracker.let_go.release()
        run.wait_for(lambda step=step: len(run.out) > step)  # type: ignore[misc]
    tracker.let_go.release(10)
    assert run.loop.stop(20.0)
    slowness = run.loop.metrics().slowness
    assert slowness is not None
    assert slowness.skipped > 0.8


def test_metrics_before_the_first_frame_are_there_and_empty() -> None:
    run = Run(CannedTracker())
    metrics = run.loop.metrics()
    assert metrics.published == 0
    assert metrics.rate_hz == 0.0
    assert metrics.tracking is Tracking.LOST
    assert np.isnan(metrics.latency_ms.median)
    assert run.loop.stop()  # never started: nothing to wait for


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_death_is_heard_of_with_its_cause() -> None:
    run = Run(FailingTracker())
    run.loop.start()
    run.feed_until_out(2)
    run.feed()
    run.wait_for(lambda: bool(run.deaths))
    assert isinstance(run.deaths[0], ArithmeticError)
    assert run.loop.stop(20.0)
    assert gc.isenabled()


def test_stopping_wakes_a_loop_without_frames_and_is_no_death() -> None:
    run = Run(CannedTracker())
    run.loop.start()
    assert run.loop.stop(20.0)
    assert run.loop.stop(20.0)
    assert not run.deaths
    assert gc.isenabled()


def test_of_two_that_keep_garbage_away_the_last_lets_it_come_back() -> None:
    with IdleCollection():
        with IdleCollection():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()


def test_garbage_is_collected_when_idle_and_only_then() -> None:
    class Node:
        def __init__(self) -> None:
            self.me = self
            freed.append(0)

        def __del__(self) -> None:
            freed.pop()

    freed: list[int] = []
    with IdleCollection() as garbage:
        garbage.idle(0)
        for _ in range(5_000):
            Node()
        assert len(freed) == 5_000
        garbage.idle(YOUNG_EVERY_NS // 2)
        assert len(freed) == 5_000
        garbage.idle(YOUNG_EVERY_NS)
        assert not freed
        Node()
        garbage.idle(YOUNG_EVERY_NS + ALL_EVERY_NS)
        assert not freed
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0
