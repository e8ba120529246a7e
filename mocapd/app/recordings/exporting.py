"""Resamples a recording to a constant rate, for `mocapd export`."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.errors import InputError
from mocapd.exports.sampled_motion import SampledMotion, Samples, resample, usual_rate_hz
from mocapd.outputs.frame_times import frame_times_ns
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import Skeleton

_MOST_JOINTS = 255
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
    tracked: list[SkeletonFrame] = []
    persons: set[int] = set()
    lost = 0
    for item in reader.everything():
        if isinstance(item, SkeletonFrame):
            persons.add(item.person)
        if isinstance(item, RestSkeleton) and item.person == person:
            rest = item  # the last one has the best estimate of the body
        elif isinstance(item, SkeletonFrame) and item.person == person:
            if item.joints:
                tracked.append(item)
            else:
                lost += 1
    place = str(reader.path)
    if rest is None:
        others = ", ".join(map(str, sorted(persons - {person})))
        fix = f"choose one of it with --person: {others}" if others else "record it again"
        raise InputError(f"has no rest skeleton of person {person}", place, fix)
    skeleton = _skeleton(rest, place)
    times_ns = frame_times_ns(tracked)
    in_order = [
        (t_ns, frame)
        for t_ns, frame, last_ns in zip(times_ns, tracked, [-1, *times_ns], strict=False)
        if t_ns > last_ns
    ]
    timed = [pair for pair in in_order if tuple(pair[1].joints) == rest.names]
    other_skeleton = len(in_order) - len(timed)
    if not timed:
        raise InputError(f"person {person} is tracked nowhere in it", place, "record it again")
    samples = _samples(*zip(*timed, strict=True))
    try:
        rate_hz = rate_hz if rate_hz is not None else usual_rate_hz(samples.times_ns)
        motion = resample(samples, skeleton, rate_hz)
    except InputError as error:
        raise InputError(error.what, place, error.fix) from None
    return Exported(motion, len(samples.times_ns), lost, other_skeleton)


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
