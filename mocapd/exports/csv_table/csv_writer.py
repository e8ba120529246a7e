"""Motion as a table: one line a frame, one column a number, in metres and in mocapd's axes.

The columns are the time [s] since the first frame; gap, 1 where no person was tracked; and the PARTS of each bone, as
BONE_PART: its joint in the world [m], its rotation relative to the T-pose, its confidence 0..1, and one standard deviation
of its position [m], empty where unknown. +Y up, a person at rest faces +Z.
"""

import csv
import io
import math
from pathlib import Path

import numpy as np

from mocapd.exports.sampled_motion import SampledMotion

PARTS = ("x", "y", "z", "qx", "qy", "qz", "qw", "confidence", "uncertainty_m")


def csv_text(motion: SampledMotion) -> str:
    """The whole file."""
    names = motion.skeleton.names
    numbers = np.concatenate(
        [
            motion.joints_m,
            motion.global_xyzw,
            motion.confidence[..., None],
            motion.uncertainty_m[..., None],
        ],
        axis=2,
    ).reshape(len(motion.joints_m), -1)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["time_s", "gap", *(f"{name}_{part}" for name in names for part in PARTS)])
    for time_s, gap, row in zip(
        motion.times_s.tolist(), motion.gap.tolist(), numbers.tolist(), strict=True
    ):
        table.writerow([f"{time_s:.6f}", gap, *(_cell(number) for number in row)])
    return text.getvalue()


def _cell(number: float) -> str:
    return f"{number:.6f}" if math.isfinite(number) else ""


def frames_in_csv(path: Path) -> int:
    """The number of frames in a file of ours."""
    with path.open(encoding="utf-8") as file:
        return sum(1 for _ in file) - 1
