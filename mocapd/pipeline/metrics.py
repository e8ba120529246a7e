"""Metrics of the pipeline, for the status line and the health message."""

import threading
from dataclasses import dataclass, field

from mocapd.clock import NS_PER_S
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.collector import CollectorCounts
from mocapd.pipeline.latency_histogram import LatencyCounts, LatencyHistogram
from mocapd.pipeline.rolling import Percentiles, RollingPercentiles, RollingRate, percentiles
from mocapd.pipeline.slowness import Slowness
from mocapd.tracking.base import LostReason
from mocapd.tracking.effort import Effort
from mocapd.types import BodyState, FrameSet, Tracking


@dataclass(frozen=True, slots=True)
class CameraMetrics:
    """rate_hz: frames that arrive [Hz]."""

    rate_hz: float
    counts: CameraCounts


@dataclass(frozen=True, slots=True)
class Metrics:
    """A snapshot. Percentiles are over the last 300 frame sets (10 s at 30 Hz).

    rate_hz: bodies of frames published per second over the last 2 s; latency_ms: capture (the set's
    `t_ns`) to after the last output; lag_ms: additional delay by smoothing, see BodyState.smoothing_lag_ns (0 without a
    person); step_ms: the tracker alone; spread_ms: of the frames within a set; published: bodies of frames since the
    start; sets_dropped: displaced by newer ones while the tracker was busy; tracking: of the last body, also of one
    without frames; latency_counts: since the start; lost_reason: why no person is tracked, where the tracker reports it;
    turns: iterations of the pipeline's thread, with or without frames; effort: the tracker's effort; slowness: the
    verdict that too many frame sets are skipped, with its cause.
    """

    rate_hz: float
    published: int
    sets_made: int
    sets_dropped: int
    latency_ms: Percentiles
    step_ms: Percentiles
    spread_ms: Percentiles
    tracking: Tracking
    tracker: str
    cameras: dict[str, CameraMetrics]
    latency_counts: LatencyCounts = field(default_factory=LatencyCounts)
    turns: int = 0
    lost_reason: LostReason | None = None
    effort: Effort = Effort.FULL
    lag_ms: Percentiles = field(default_factory=lambda: percentiles(()))
    slowness: Slowness | None = None


class MetricsRecorder:
    """Written by the pipeline's thread, read by any; the lock is held for appends and copies only."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._rate = RollingRate()
        self._latency_ms = RollingPercentiles()
        self._latencies = LatencyHistogram()
        self._step_ms = RollingPercentiles()
        self._lag_ms = RollingPercentiles()
        self._spread_ms = RollingPercentiles()
        self._published = 0
        self._turns = 0
        self._tracking = Tracking.LOST
        self._tracker = ""
        self._lost_reason: LostReason | None = None
        self._effort = Effort.FULL
        self._slowness: Slowness | None = None

    def record_body(
        self,
        frames: FrameSet,
        body: BodyState,
        step_ns: int,
        now_ns: int,
        lost_reason: LostReason | None = None,
    ) -> None:
        """Count a body published at `now_ns`, after a tracker's step of `step_ns`; lost_reason: the tracker's."""
        per_ms = NS_PER_S // 1000
        with self._lock:
            self._rate.add(now_ns)
            latency_ms = (now_ns - frames.t_ns) / per_ms
            self._latency_ms.add(latency_ms)
            self._latencies.add(latency_ms)
            self._step_ms.add(step_ns / per_ms)
            self._lag_ms.add(body.smoothing_lag_ns / per_ms)
            self._spread_ms.add(frames.spread_ns / per_ms)
            self._published += 1
            self._tracking, self._tracker = body.tracking, body.tracker
            self._lost_reason = lost_reason

    def absent(self, body: BodyState) -> None:
        """Count a body published without frames."""
        with self._lock:
            self._tracking, self._lost_reason = body.tracking, None
            self._slowness = None  # without frames nothing is skipped

    def effort_changed(self, effort: Effort) -> None:
        """Set the tracker's effort."""
        with self._lock:
            self._effort = effort

    def set_slowness(self, slowness: Slowness | None) -> None:
        """Set the verdict on slowness; None: the tracker keeps up."""
        with self._lock:
            self._slowness = slowness

    def count_turn(self) -> None:
        """Count an iteration of the pipeline's thread."""
        with self._lock:
            self._turns += 1

    def snapshot(self, collected: CollectorCounts, now_ns: int) -> Metrics:
        """The current metrics, with the collector's counts."""
        with self._lock:
            rate_hz = self._rate.rate_hz(now_ns)
            latency, step = self._latency_ms.samples(), self._step_ms.samples()
            spread, published = self._spread_ms.samples(), self._published
            tracking, tracker, turns = self._tracking, self._tracker, self._turns
            latencies, lost_reason = self._latencies.counts(), self._lost_reason
            effort, lag = self._effort, self._lag_ms.samples()
            slowness = self._slowness
        return Metrics(
            rate_hz=rate_hz,
            published=published,
            sets_made=collected.sets,
            sets_dropped=collected.dropped,
            latency_ms=percentiles(latency),
            step_ms=percentiles(step),
            spread_ms=percentiles(spread),
            tracking=tracking,
            tracker=tracker,
            cameras={
                name: CameraMetrics(collected.rates_hz[name], counts)
                for name, counts in collected.cameras.items()
            },
            latency_counts=latencies,
            turns=turns,
            lost_reason=lost_reason,
            effort=effort,
            lag_ms=percentiles(lag),
            slowness=slowness,
        )
