"""Measures a tracker's step time and memory over a long run."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import psutil

from mocapd.clock import nanoseconds
from mocapd.evaluate.bench.bench_input import BenchInput
from mocapd.evaluate.bench.bench_step import BYTES_PER_MB, NS_PER_MS
from mocapd.pipeline.idle_collection import IdleCollection
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.types import Floats, FrameSet

_SEAM_NS = nanoseconds(1.0 / 30.0)  # between the last set of a round and the first of the next


@dataclass(frozen=True, slots=True)
class EnduranceFigures:
    """minutes: how long it ran [min]; sets: frame sets tracked in this time.

    median_ms, p95_ms, cpu_ms: of a step, in each quarter of the run, by the clock, and the median of
    the process's processor time, which other programs disturb less [ms]; rss_mb: resident memory in the
    middle of each quarter [MB]; rss_slope_mb_per_min: its trend over the second half [MB/min].
    """

    minutes: float
    sets: int
    median_ms: tuple[float, ...]
    p95_ms: tuple[float, ...]
    cpu_ms: tuple[float, ...]
    rss_mb: tuple[float, ...]
    rss_slope_mb_per_min: float


def endure(
    ready: ReadyTracker, recording: BenchInput, minutes: float, progress: Callable[[int, int], None]
) -> EnduranceFigures:
    """Track the recording repeatedly for so many minutes by the clock, as fast as possible.

    Capture times continue over the repetitions. `progress` gets the seconds passed, and of all.
    """
    tracker, shape = ready.tracker, ready.shape
    step_ns: list[tuple[int, int]] = []  # by the clock, of the processor
    rss: list[tuple[float, float]] = []  # minute, bytes
    process = psutil.Process()
    started_s = time.monotonic()
    with IdleCollection() as garbage:
        for chunk in _rounds(recording):
            for frame_set in chunk:
                cpu_ns, start_ns = time.process_time_ns(), time.perf_counter_ns()
                shape = tracker.step(frame_set, shape).shape
                wall_ns = time.perf_counter_ns() - start_ns
                step_ns.append((wall_ns, time.process_time_ns() - cpu_ns))
            garbage.idle(time.monotonic_ns())
            minute = (time.monotonic() - started_s) / 60.0
            rss.append((minute, process.memory_info().rss / BYTES_PER_MB))
            progress(round(60.0 * min(minute, minutes)), round(60.0 * minutes))
            if minute >= minutes:
                break
    return _figures(np.array(step_ns) / NS_PER_MS, np.array(rss))


def _figures(step_ms: Floats, rss: Floats) -> EnduranceFigures:
    quarters = [part for part in np.array_split(step_ms, 4) if len(part)]
    middles = rss[-1, 0] * (np.arange(4) + 0.5) / 4
    settled = rss[len(rss) // 2 :]
    slope = float(np.polyfit(settled[:, 0], settled[:, 1], 1)[0]) if len(settled) > 1 else 0.0
    return EnduranceFigures(
        minutes=float(rss[-1, 0]),
        sets=len(step_ms),
        median_ms=tuple(float(np.median(part[:, 0])) for part in quarters),
        p95_ms=tuple(float(np.percentile(part[:, 0], 95.0)) for part in quarters),
        cpu_ms=tuple(float(np.median(part[:, 1])) for part in quarters),
        rss_mb=tuple(np.interp(middles, rss[:, 0], rss[:, 1]).tolist()),
        rss_slope_mb_per_min=slope,
    )


def _rounds(recording: BenchInput) -> Iterator[list[FrameSet]]:
    """The chunks of a recording, repeated for ever with increasing times."""
    offset_ns = 0
    while True:
        end_ns = offset_ns
        for chunk in recording.chunks():
            later = [_later(one, offset_ns) for one in chunk]
            end_ns = later[-1].t_ns
            yield later
        offset_ns = end_ns + _SEAM_NS


def _later(one: FrameSet, by_ns: int) -> FrameSet:
    frames = {name: replace(frame, t_ns=frame.t_ns + by_ns) for name, frame in one.frames.items()}
    return FrameSet(one.t_ns + by_ns, frames, one.spread_ns)
