"""A person's motion at a constant rate: the input of every format."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mocapd.body.skeleton import local_from_global
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.types import Bytes, Floats, Ints, Skeleton

NS = 1e-9
MOST_FRAMES = 10_000_000  # more than a day at 100 Hz
RATES_HZ = (1.0, 1000.0)
LONGEST_HELD_S = 0.25  # between two poses: longer without a pose is a gap


@dataclass(frozen=True, slots=True, eq=False)
class SampledMotion:
    """F frames of J joints in mocapd's world, rate_hz apart from time 0.

    skeleton: names, parents and T-pose of the recording; joints_m (F,J,3) [m]; global_xyzw (F,J,4): relative to the
    T-pose; confidence (F,J) 0..1; gap (F,): no person was tracked, and the pose is interpolated across the gap;
    uncertainty_m (F,J): one standard deviation of each joint's position [m], inf where unknown; up: the up axis, y unless
    z_up changed it; unmoved: joints without exported motion, of formats that need the joints nevertheless.
    """

    rate_hz: float
    skeleton: Skeleton
    joints_m: Floats
    global_xyzw: Floats
    confidence: Floats
    gap: Bytes
    uncertainty_m: Floats
    up: Literal["y", "z"] = "y"
    unmoved: frozenset[str] = frozenset()

    @property
    def times_s(self) -> Floats:
        """Of each frame (F,) [s]."""
        times: Floats = np.arange(len(self.joints_m)) / self.rate_hz
        return times

    @property
    def offsets_m(self) -> Floats:
        """Of each joint from its parent's in the T-pose (J,3) [m]; of the root from the floor below."""
        parents, rest_m = self.skeleton.parents, self.skeleton.rest_m
        offsets: Floats = rest_m - np.where(parents[:, None] >= 0, rest_m[parents], 0.0)
        return offsets

    @property
    def local_xyzw(self) -> Floats:
        """Rotations (F,J,4) relative to the parent's."""
        return local_from_global(self.skeleton, self.global_xyzw)

    @property
    def local_positions_m(self) -> Floats:
        """Of each joint in its parent's rotated frame (F,J,3) [m]; of the root in the world.

        They differ slightly from the rest offsets: a tracker that learns the body changes bone lengths meanwhile.
        """
        parents = self.skeleton.parents
        above = np.maximum(parents, 0)
        apart_m = self.joints_m - self.joints_m[:, above]
        positions_m = rotations.rotate(rotations.inverse(self.global_xyzw[:, above]), apart_m)
        positions_m[:, parents < 0] = self.joints_m[:, parents < 0]
        return positions_m


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Poses at their own times, in order: times_ns (N,), the rest as in SampledMotion."""

    times_ns: Ints
    joints_m: Floats
    global_xyzw: Floats
    confidence: Floats
    uncertainty_m: Floats


def resample(samples: Samples, skeleton: Skeleton, rate_hz: float) -> SampledMotion:
    """The motion at a constant rate from the first sample on: linear interpolation of positions, slerp of rotations.

    Needs at least one sample. Raises InputError for too many frames.
    """
    times_ns = samples.times_ns
    at_s = (times_ns - times_ns[0]) * NS
    count = int(np.floor(at_s[-1] * rate_hz + 1e-6)) + 1
    if count > MOST_FRAMES:
        raise too_long(count, MOST_FRAMES, rate_hz)
    wanted_s = np.arange(count) / rate_hz
    after = np.clip(np.searchsorted(at_s, wanted_s, side="left"), 1, max(1, len(at_s) - 1))
    before = np.minimum(after - 1, len(at_s) - 1)
    after = np.minimum(after, len(at_s) - 1)
    between_s = at_s[after] - at_s[before]
    share = np.clip((wanted_s - at_s[before]) / np.where(between_s > 0, between_s, 1.0), 0.0, 1.0)
    nearest_s = np.minimum(share, 1.0 - share) * between_s
    is_apart = (between_s > LONGEST_HELD_S) & (nearest_s > 0.5 / rate_hz)

    def lerp(values: Floats) -> Floats:
        weights = share.reshape(-1, *[1] * (values.ndim - 1))
        result: Floats = (1.0 - weights) * values[before] + weights * values[after]
        return result

    global_xyzw = rotations.slerp(
        samples.global_xyzw[before], samples.global_xyzw[after], share[:, None]
    )
    confidence = lerp(samples.confidence)
    confidence[is_apart] = 0.0
    at_worst = np.maximum(samples.uncertainty_m[before], samples.uncertainty_m[after])
    at_worst[is_apart] = np.inf
    return SampledMotion(
        rate_hz,
        skeleton,
        lerp(samples.joints_m),
        global_xyzw,
        confidence,
        is_apart.astype(np.uint8),
        at_worst,
    )


def too_long(
    count: int, most: int, rate_hz: float, name: str = "a file", where: str = ""
) -> InputError:
    """The error for `count` frames where `name` holds `most`; it suggests a rate that fits."""
    fitting_hz = math.floor(100.0 * rate_hz * (most - 1) / count) / 100.0
    return InputError(
        f"{count} frames are too many: {name} holds {most}, {duration_text(most / rate_hz)} at {rate_hz:g} Hz",
        where,
        f"choose a lower rate by --rate: {fitting_hz:g} Hz or less"
        if fitting_hz >= RATES_HZ[0]
        else f"its times span {duration_text(count / rate_hz)}: record it again",
    )


def duration_text(duration_s: float) -> str:
    """Whole hours, minutes and seconds."""
    minutes, seconds = divmod(int(duration_s), 60)
    hours, minutes = divmod(minutes, 60)
    parts = [f"{hours} h"] * (hours > 0) + [f"{minutes} min"] * (hours + minutes > 0)
    return " ".join([*parts, f"{seconds} s"])


def usual_rate_hz(times_ns: Ints) -> float:
    """The rate of samples by their median distance, rounded to a hundredth [Hz]; 30 for too few samples."""
    if len(times_ns) < 2:
        return 30.0
    step_s = float(np.median(np.diff(times_ns))) * NS
    return round(min(RATES_HZ[1], max(RATES_HZ[0], 1.0 / max(step_s, 1e-6))), 2)
