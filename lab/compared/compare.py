"""The full method against others, and for the shirt against the paper's baseline (paper Fig. 9 and 10)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.score import interior_angle_deg, match
from mocapd.types import Floats

FULL, BASELINE = "full", "baseline"
SHOULDER = ("neck", "leftUpperArm", "leftLowerArm")


# Per method, FULL first, its results, one per capture, in one order.
Comparison = Mapping[str, Sequence[CaptureResult]]


@dataclass(frozen=True, slots=True, eq=False)
class ShoulderAngles:
    """The interior angle at the left shoulder over time: times_s (N,), and by whom it is told,
    `truth` or a method, angles (N,) [degrees], NaN where nothing was tracked."""

    capture: str
    times_s: Floats
    angle_deg: Mapping[str, Floats]


def shoulder_angles(comparison: Comparison) -> list[ShoulderAngles]:
    """Truth, full method and baseline over the scored frames of each capture."""
    out = []
    for i, full in enumerate(comparison[FULL]):
        truth = full.case.truth
        rows = match(truth, full.track).rows
        angles = {"truth": interior_angle_deg(truth.joints_m, truth.names, SHOULDER)[rows]}
        for method in (FULL, BASELINE):
            track = comparison[method][i].track
            matches = match(truth, track)
            told = np.full(len(truth.times_s), np.nan)
            told[matches.truth_rows] = interior_angle_deg(
                track.joints_m[matches.track_rows], track.joint_names, SHOULDER
            )
            angles[method] = told[rows]
        out.append(ShoulderAngles(full.case.name, truth.times_s[rows], angles))
    return out
