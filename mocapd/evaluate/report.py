"""Scores of captures as tables and as JSON."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.reliability import NEAR_CM, TENTHS, Reliability, near_from
from mocapd.evaluate.tables import number, table

# Key in JSON, title, digits, value.
COLUMNS: tuple[tuple[str, str, int, Callable[[CaptureResult], float | None]], ...] = (
    ("coverage_percent", "coverage [%]", 1, lambda r: 100.0 * r.score.coverage),
    ("ghost_frames", "ghost frames", 0, lambda r: float(r.score.ghost_frames)),
    ("rms_cm", "RMS [cm]", 2, lambda r: r.score.rms_cm),
    ("median_cm", "median [cm]", 2, lambda r: r.score.median_cm),
    ("p95_cm", "p95 [cm]", 2, lambda r: r.score.p95_cm),
    ("jitter_ratio", "jitter ratio", 1, lambda r: r.score.jitter_ratio),
    ("step_error_p99_cm", "step error p99 [cm]", 1, lambda r: r.score.step_error_p99_cm),
    ("step_error_max_cm", "step error max [cm]", 0, lambda r: r.score.step_error_max_cm),
    ("confident_percent", "confident [%]", 0, lambda r: 100.0 * r.score.confident_share),
    ("confident_rms_cm", "confident RMS [cm]", 1, lambda r: r.score.confident_rms_cm),
    ("doubtful_rms_cm", "doubtful RMS [cm]", 1, lambda r: r.score.doubtful_rms_cm),
    ("joint_angle_deg", "angle [°]", 1, lambda r: r.score.joint_angle_deg),
    ("recovery_frames", "recovery [frames]", 0, lambda r: r.recovery_frames),
    ("step_ms", "time per frame set [ms]", 1, lambda r: r.step_ms),
)


def score_table(results: Sequence[CaptureResult]) -> str:
    """One row per capture, and a row of means for each number of cameras."""
    rows = [
        [result.case.name, *(number(value(result), digits) for _, _, digits, value in COLUMNS)]
        for result in results
    ]
    for name, group in groups_by_cameras(results):
        means = [mean_or_nan([value(result) for result in group]) for _, _, _, value in COLUMNS]
        digits = [max(digits, 1) for _, _, digits, _ in COLUMNS]
        rows.append([name, *map(number, means, digits)])
    return table(["capture", *(title for _, title, _, _ in COLUMNS)], rows)


def score_json(results: Sequence[CaptureResult]) -> dict[str, Any]:
    """The same, and the error of each joint; null: not applicable, "never": no recovery."""
    captures = [
        {
            "capture": result.case.name,
            "cameras": len(result.case.folder.cameras),
            "frames": result.score.frames,
            **{key: _plain(value(result)) for key, _, _, value in COLUMNS},
            "per_joint_rms_cm": {
                name: _plain(rms) for name, rms in result.score.per_joint_rms_cm.items()
            },
            "jitter_mm": _plain(result.score.jitter_mm),
        }
        for result in results
    ]
    means = {
        name: {key: _plain(mean_or_nan([value(r) for r in group])) for key, _, _, value in COLUMNS}
        for name, group in groups_by_cameras(results)
    }
    return {"captures": captures, "means": means}


def reliability_table(of: Reliability) -> str:
    """One row a tenth of confidence, highest first; the last column is of all joints from there upwards."""
    rows = []
    for tenth in range(TENTHS - 1, -1, -1):
        row = [
            f"{tenth / TENTHS:.1f} to {(tenth + 1) / TENTHS:.1f}",
            number(100.0 * of.count[tenth] / max(of.count.sum(), 1), 1),
            number(float(of.rms_cm[tenth]), 2),
            number(100.0 * float(of.near[tenth]), 1),
            number(100.0 * near_from(of, tenth), 1),
        ]
        rows.append(row)
    near = f"within {NEAR_CM:g} cm [%]"
    return table(
        ["confidence", "joints [%]", "RMS [cm]", near, "this and higher confidence [%]"], rows
    )


def groups_by_cameras(results: Sequence[CaptureResult]) -> list[tuple[str, list[CaptureResult]]]:
    """Groups of two or more captures with the same number of cameras."""
    out = []
    for cameras in sorted({len(result.case.folder.cameras) for result in results}, reverse=True):
        group = [r for r in results if len(r.case.folder.cameras) == cameras]
        if len(group) > 1:
            out.append((f"mean of {len(group)} with {cameras} camera{'s' * (cameras > 1)}", group))
    return out


def mean_or_nan(values: Sequence[float | None]) -> float:
    """The mean of the values that are not None; NaN if one of them is NaN (not tracked), or all are None."""
    numbers = [value for value in values if value is not None]
    return float(np.mean(numbers)) if numbers else float("nan")


def _plain(value: float | None) -> float | str | None:
    if value is None or math.isnan(value):
        return None
    return "never" if math.isinf(value) else value
