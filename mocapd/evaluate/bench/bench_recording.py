"""Measures the cost of recording: megabytes an hour, time a frame, and the loss at a kill. `mocapd bench --recording`."""

import itertools
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from mocapd.boundary.mcap_records import McapFile, McapMessage
from mocapd.child_process import child_command
from mocapd.clock import NS_PER_S, unix_from_monotonic_ns
from mocapd.errors import InputError
from mocapd.outputs.mcap.recording_reader import Recorded, RecordingReader
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton
from mocapd.outputs.wire import SkeletonFrame

HZ = 60.0
HOUR_S = 3600.0
KILLED_AFTER_S = (1.9, 2.35, 2.6)  # at different places between two flushes
_PERIOD_NS = round(NS_PER_S / HZ)


@dataclass(frozen=True, slots=True)
class RecordingCost:
    """mb_an_hour: frames alone, with bones for Foxglove at 10 Hz, and exact as published; frame_ms: median and 99th
    percentile of one frame, with writing of chunks; lost_s: of each kill."""

    mb_an_hour: tuple[float, float, float]
    frame_ms: tuple[float, float]
    lost_s: tuple[float, ...]


def recording_cost(path: Path, hours: float) -> RecordingCost:
    """The cost for the motion in this recording, repeated at HZ. Raises InputError."""
    items = list(RecordingReader(path).everything())
    if not any(isinstance(item, SkeletonFrame) and item.joints for item in items):
        raise InputError("no person is tracked in it", str(path), "record a person")
    sizes: list[float] = []
    usual_ms = [0.0]
    with tempfile.TemporaryDirectory() as folder:
        for params in (
            RecordingParams(foxglove_hz=0.0),
            RecordingParams(),
            RecordingParams(exact=True),
        ):
            target = Path(folder) / f"{len(sizes)}.mcap"
            took_ms = _write(target, items, params, round(hours * HOUR_S * HZ))
            sizes.append(target.stat().st_size / 1e6 / hours)
            target.unlink()
            if params == RecordingParams():
                usual_ms = took_ms
        lost_s = tuple(_loss_after_kill(path, Path(folder), after_s) for after_s in KILLED_AFTER_S)
    median, p99 = np.percentile(usual_ms, [50, 99])
    return RecordingCost((sizes[0], sizes[1], sizes[2]), (float(median), float(p99)), lost_s)


def as_lines(cost: RecordingCost) -> list[str]:
    """The figures as text."""
    alone, usual, exact = cost.mb_an_hour
    return [
        f"{usual:.1f} MB an hour at {HZ:g} Hz ({alone:.1f} without bones for Foxglove, {exact:.1f} with --exact)",
        f"{cost.frame_ms[0]:.3f} ms a frame, median (p99 {cost.frame_ms[1]:.3f} ms)",
        "killed with -9: " + ", ".join(f"{lost_s:.2f} s lost" for lost_s in cost.lost_s),
    ]


def _write(path: Path, items: list[Recorded], params: RecordingParams, count: int) -> list[float]:
    """Write so many frames as fast as possible, with their own times; returns the duration of each [ms]."""
    took_ms = []
    with RecordingWriter(path, params, 0) as writer:
        for item in itertools.islice(_endless(writer, items), count):
            began_s = time.perf_counter()
            writer.frame(item)
            writer.flush_if_due(item.capture_monotonic_ns)
            took_ms.append(1e3 * (time.perf_counter() - began_s))
    return took_ms


def _endless(writer: RecordingWriter, items: list[Recorded]) -> Iterator[SkeletonFrame]:
    """Its frames at HZ, repeated for ever; states are written first."""
    unix_ns = unix_from_monotonic_ns()
    for item in items:
        if isinstance(item, RestSkeleton | CalibrationInfo):
            writer.add_state(item, unix_ns)
    frames = itertools.cycle(item for item in items if isinstance(item, SkeletonFrame))
    for number, frame in enumerate(frames):
        t_ns = number * _PERIOD_NS
        yield msgspec.structs.replace(
            frame,
            seq=number,
            capture_monotonic_ns=t_ns,
            capture_unix_ns=t_ns + unix_ns,
            publish_monotonic_ns=t_ns + frame.publish_monotonic_ns - frame.capture_monotonic_ns,
        )


def _loss_after_kill(source: Path, folder: Path, after_s: float) -> float:
    """The recorded time that a killed process lost [s]."""
    target = folder / "killed.mcap"
    name = write_in_real_time.__name__
    program = f"from {__name__} import {name}; {name}(*sys.argv[1:])"
    with subprocess.Popen(
        child_command(program, str(source), str(target)),
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        written = process.stdout.readline()  # it has begun
        time.sleep(after_s)
        process.kill()
        written = (process.stdout.read().split() or [written])[-1]
    # not by the RecordingReader, which warns the user of the kill
    *_, last = McapFile(target).items(lambda topic, _: topic.startswith("/mocapd/skeleton/"))
    assert isinstance(last, McapMessage)
    target.unlink()
    return (int(written) - last.sequence) / HZ


def write_in_real_time(source: str, target: str) -> None:
    """Write until killed; prints the number of each written frame to stdout."""
    items = list(RecordingReader(Path(source)).everything())
    with RecordingWriter(Path(target), RecordingParams(), time.monotonic_ns()) as writer:
        began_ns = time.monotonic_ns()
        for frame in _endless(writer, items):
            due_ns = began_ns + frame.capture_monotonic_ns
            time.sleep(max(0, due_ns - time.monotonic_ns()) / NS_PER_S)
            writer.frame(frame)
            sys.stdout.write(f"{frame.seq}\n")
            sys.stdout.flush()
            writer.flush_if_due(time.monotonic_ns())
