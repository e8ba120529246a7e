"""What the daemon's own smoothing takes off a swing before it is published, and so recorded."""

from collections.abc import Iterator, Sequence

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.pipeline.smoothing import PRESETS, Smoother
from mocapd.types import BodyState, Floats, Pose, Skeleton, Tracking
from mocapd_analysis.accuracy.clips import BAND_HZ, END_S, WRISTS, Clip, courses
from mocapd_analysis.differentiator import SPEED, derivatives
from mocapd_analysis.joint_speeds import highest

_EVERY = 2  # frames of the clip: 30 Hz of its 60


def smoothing_lines(clips: Sequence[Clip], least_m_s: float) -> Iterator[str]:
    """A line for each preset of `smoothing.preset`: errors of the wrists' peak speeds, of exact poses at half the rate."""
    yield f"{'smoothing.preset':24}|   mean  median |.|   [percent], exact poses"
    for preset in PRESETS:
        errors = []
        for clip in clips:
            truth = {one.joint: one.peak_m_s for one in courses([clip], BAND_HZ, least_m_s)}
            if truth:
                joints_m = _smoothed_m(clip, preset)
                times_s = np.arange(len(joints_m)) * _EVERY / clip.rate_hz
                inner = (times_s >= END_S) & (times_s <= times_s[-1] - END_S)
                for joint in (one for one in WRISTS if one in truth):
                    way_m = joints_m[:, clip.names.index(joint)]
                    speed = np.linalg.norm(derivatives(times_s, way_m, SPEED, 1)[1], axis=1)
                    errors.append(100.0 * (highest(times_s, speed, inner).value / truth[joint] - 1))
        yield f"{preset:24}| {np.mean(errors):+6.1f} {np.median(np.abs(errors)):11.1f}"


def _smoothed_m(clip: Clip, preset: str) -> Floats:
    """Every second frame's joints (F,J,3) [m] as the daemon would publish them."""
    rest_m = clip.rest_offsets_m.copy()
    for joint, parent in enumerate(clip.parents):
        if parent >= 0:
            rest_m[joint] += rest_m[parent]
    smoother = Smoother(preset, Skeleton(clip.names, np.array(clip.parents), rest_m))
    whole_m, confidence = clip.joints_m(), np.ones(len(clip.names))
    out = []
    for frame in range(0, len(whole_m), _EVERY):
        body = BodyState(
            nanoseconds(frame / clip.rate_hz),
            Tracking.LIVE,
            "clip",
            Pose(clip.hips_m[frame], clip.global_xyzw[frame]),
            whole_m[frame],
            confidence,
        )
        joints_m = smoother.step(body).joints_m
        assert joints_m is not None  # it is never lost
        out.append(joints_m)
    return np.stack(out)
