"""Measures one step of a tracker: time, processor time, memory, and the time of each stage."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import psutil

from mocapd.body.shape import BodyShape
from mocapd.evaluate.bench.bench_input import BenchInput
from mocapd.pipeline.idle_collection import IdleCollection
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.tracking.base import Tracker
from mocapd.types import FrameSet

REST = "rest"  # the part of a step after its last named stage
NS_PER_MS = 1e6
BYTES_PER_MB = 1e6


@dataclass(frozen=True, slots=True)
class StageFigures:
    """median_ms and p95_ms [ms] over the sets in which the stage ran, which are `share` of all.

    mean_ms: over all sets, so that the stages add up to the step's mean [ms].
    """

    median_ms: float
    p95_ms: float
    mean_ms: float
    share: float


@dataclass(frozen=True, slots=True)
class StepFigures:
    """A tracker's step over all `sets` of a recording.

    median_ms, p95_ms, mean_ms: by the clock [ms]; cpu_ms, cpu_mean_ms: of the whole process, all
    threads, median and mean [ms]; rss_mb: resident memory of the process, with the decoded frames
    at hand [MB]; tracked: share of the sets that gave a body.
    """

    sets: int
    median_ms: float
    p95_ms: float
    mean_ms: float
    cpu_ms: float
    cpu_mean_ms: float
    rss_mb: float
    tracked: float
    stages: dict[str, StageFigures]


def bench_tracker(
    ready: ReadyTracker, recording: BenchInput, progress: Callable[[int, int], None]
) -> StepFigures:
    """Track the recording twice and time the second run; `progress` gets the sets done, and of all.

    The first run compiles missing kernels and touches all memory. The tracker is reset in between, so that the second
    run finds the person again.
    """
    tracker, shape = ready.tracker, ready.shape
    done = 0
    for chunk in recording.chunks():
        for frame_set in chunk:
            shape = tracker.step(frame_set, shape).shape
        done += len(chunk)
        progress(done, 2 * recording.count)
    tracker.reset()
    samples = _Samples(ready.shape)
    with IdleCollection() as garbage:
        for chunk in recording.chunks():
            samples.add(tracker, chunk)
            garbage.idle(time.monotonic_ns())
            done += len(chunk)
            progress(done, 2 * recording.count)
    return samples.figures()


class _Samples:
    """Samples of the time and memory of each step."""

    def __init__(self, shape: BodyShape) -> None:
        self._shape = shape
        self._wall_ns: list[int] = []
        self._cpu_ns: list[int] = []
        self._stages: list[dict[str, int]] = []  # of each step, by stage [ns]
        self._marked_ns = 0
        self._tracked = 0
        self._rss_bytes = 0

    def add(self, tracker: Tracker, sets: Iterable[FrameSet]) -> None:
        tracker.probe = self._mark
        for one in sets:
            self._stages.append({})
            cpu_ns = time.process_time_ns()
            start_ns = self._marked_ns = time.perf_counter_ns()
            track = tracker.step(one, self._shape)
            self._mark(REST)
            self._wall_ns.append(self._marked_ns - start_ns)
            self._cpu_ns.append(time.process_time_ns() - cpu_ns)
            self._shape = track.shape
            self._tracked += track.body.pose is not None
        self._rss_bytes = max(self._rss_bytes, psutil.Process().memory_info().rss)

    def _mark(self, stage: str) -> None:
        """End a stage, which began at the end of the one before."""
        stages, now_ns = self._stages[-1], time.perf_counter_ns()
        stages[stage] = stages.get(stage, 0) + now_ns - self._marked_ns
        self._marked_ns = now_ns

    def figures(self) -> StepFigures:
        n = len(self._wall_ns)
        wall_ms, cpu_ms = np.array(self._wall_ns) / NS_PER_MS, np.array(self._cpu_ns) / NS_PER_MS
        names = {name: None for step in self._stages for name in step if name != REST}
        return StepFigures(
            sets=n,
            median_ms=float(np.median(wall_ms)),
            p95_ms=float(np.percentile(wall_ms, 95.0)),
            mean_ms=float(wall_ms.mean()),
            cpu_ms=float(np.median(cpu_ms)),
            cpu_mean_ms=float(cpu_ms.mean()),
            rss_mb=self._rss_bytes / BYTES_PER_MB,
            tracked=self._tracked / n,
            stages={name: self._stage(name) for name in (*names, REST)},
        )

    def _stage(self, name: str) -> StageFigures:
        ran_ms = np.array([step[name] for step in self._stages if name in step]) / NS_PER_MS
        n = len(self._stages)
        return StageFigures(
            float(np.median(ran_ms)),
            float(np.percentile(ran_ms, 95.0)),
            float(ran_ms.sum() / n),
            len(ran_ms) / n,
        )
