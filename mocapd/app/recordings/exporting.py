"""Resamples a recording to a constant rate, for `mocapd export`."""

import math
import re
from dataclasses import dataclass

import numpy as np

from mocapd.errors import InputError
from mocapd.exports.sampled_motion import SampledMotion, Samples, resample, usual_rate_hz
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
    frames: list[SkeletonFrame] = []
    lost = 0
    for item in reader.everything():
        if isinstance(item, RestSkeleton) and item.person == person:
            rest = item  # the last one has the best estimate of the body
        elif isinstance(item, SkeletonFrame) and item.person == person:
            if not item.joints:
                lost += 1
            elif not frames or item.capture_unix_ns > frames[-1].capture_unix_ns:
                frames.append(item)
    place = str(reader.path)
    if rest is None:
        raise InputError(f"has no rest skeleton of person {person}", place, "record it again")
    skeleton = _skeleton(rest, place)
    others = len(frames)
    frames = [frame for frame in frames if tuple(frame.joints) == rest.names]
    others -= len(frames)
    if not frames:
        raise InputError(f"person {person} is tracked nowhere in it", place, "record it again")
    samples = _samples(frames)
    try:
        rate_hz = rate_hz if rate_hz is not None else usual_rate_hz(samples.times_ns)
        motion = resample(samples, skeleton, rate_hz)
    except InputError as error:
        raise InputError(error.what, place, error.fix) from None
    return Exported(motion, len(samples.times_ns), lost, others)


def _samples(frames: list[SkeletonFrame]) -> Samples:
    shape = len(frames), -1
    joints = [list(frame.joints.values()) for frame in frames]
    return Samples(
        np.array([frame.capture_unix_ns for frame in frames], dtype=np.int64),
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
