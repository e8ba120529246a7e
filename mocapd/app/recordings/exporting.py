"""Resamples a recording to a constant rate, for `mocapd export`."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.errors import InputError
from mocapd.exports.sampled_motion import SampledMotion, Samples, resample, usual_rate_hz
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import Skeleton

_MOST_JOINTS = 255
_CLOCK_SET_NS = 1_000_000  # difference of both clocks' steps beyond which the Unix clock was set
_NAME = re.compile(r"[!-~]{1,64}")


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """tracked, lost: number of frames with and without this person's pose; other_skeleton: frames that were dropped, as
    their joints differ from the last rest skeleton's."""

    motion: SampledMotion
    tracked: int
    lost: int
    other_skeleton: int


def motion_of(reader: RecordingReader, person: int, rate_hz: float | None) -> Exported:
    """One person's motion; `rate_hz` None takes that of the recording. Raises InputError."""
    rest: RestSkeleton | None = None
    frames: list[SkeletonFrame] = []
    times_ns: list[int] = []
    persons: set[int] = set()
    lost = 0
    for item in reader.everything():
        if isinstance(item, SkeletonFrame):
            persons.add(item.person)
        if isinstance(item, RestSkeleton) and item.person == person:
            rest = item  # the last one has the best estimate of the body
        elif isinstance(item, SkeletonFrame) and item.person == person:
            if not item.joints:
                lost += 1
            elif not frames:
                frames.append(item)
                times_ns.append(item.capture_unix_ns)
            elif (step_ns := _step_ns(frames[-1], item)) > 0:
                frames.append(item)
                times_ns.append(times_ns[-1] + step_ns)
    place = str(reader.path)
    if rest is None:
        others = ", ".join(map(str, sorted(persons - {person})))
        fix = f"choose one of it with --person: {others}" if others else "record it again"
        raise InputError(f"has no rest skeleton of person {person}", place, fix)
    skeleton = _skeleton(rest, place)
    timed = [
        pair for pair in zip(times_ns, frames, strict=True) if tuple(pair[1].joints) == rest.names
    ]
    other_skeleton = len(frames) - len(timed)
    if not timed:
        raise InputError(f"person {person} is tracked nowhere in it", place, "record it again")
    samples = _samples(*zip(*timed, strict=True))
    try:
        rate_hz = rate_hz if rate_hz is not None else usual_rate_hz(samples.times_ns)
        motion = resample(samples, skeleton, rate_hz)
    except InputError as error:
        raise InputError(error.what, place, error.fix) from None
    return Exported(motion, len(samples.times_ns), lost, other_skeleton)


def _step_ns(before: SkeletonFrame, after: SkeletonFrame) -> int:
    """Unix time from one frame to the next [ns], unless that clock was set; 0 if they are out of order.

    The monotonic clock cannot be set, but starts again with the daemon's machine.
    """
    unix_ns = after.capture_unix_ns - before.capture_unix_ns
    monotonic_ns = after.capture_monotonic_ns - before.capture_monotonic_ns
    was_set = abs(unix_ns - monotonic_ns) > _CLOCK_SET_NS
    steps_ns = (unix_ns, monotonic_ns) if was_set else (unix_ns,)
    return min((step_ns for step_ns in steps_ns if step_ns > 0), default=0)


def _samples(times_ns: Sequence[int], frames: Sequence[SkeletonFrame]) -> Samples:
    shape = len(frames), -1
    joints = [list(frame.joints.values()) for frame in frames]
    return Samples(
        np.array(times_ns, dtype=np.int64),
        np.array([[j.p for j in row] for row in joints]).reshape(*shape, 3),
        np.array([[j.r for j in row] for row in joints]).reshape(*shape, 4),
        np.array([[j.c for j in row] for row in joints]).reshape(shape),
        np.array([[math.inf if j.u is None else j.u for j in row] for row in joints]).reshape(
            shape
        ),
    )


def _skeleton(rest: RestSkeleton, place: str) -> Skeleton:
    """Raises InputError for names that no format supports, or without exactly one root."""
    names = rest.names
    if not (
        len(names) <= _MOST_JOINTS
        and len(set(names)) == len(names)
        and all(_NAME.fullmatch(name) for name in names)
        and rest.parents.count(-1) == 1
    ):
        raise InputError("its rest skeleton is none of mocapd", place, "record it again")
    rest_m = np.array(rest.offsets_m)
    for joint, parent in enumerate(rest.parents):
        if parent >= 0:
            rest_m[joint] += rest_m[parent]
    return Skeleton(rest.names, np.array(rest.parents, dtype=np.int64), rest_m)
