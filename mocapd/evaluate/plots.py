"""The plots of the docs, as PNG files."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from mocapd.errors import CannotCreateError
from mocapd.evaluate.compare import BASELINE, FULL, ShoulderAngles
from mocapd.evaluate.reliability import NEAR_CM, TENTHS, Reliability
from mocapd.evaluate.roc import Roc

_DPI = 110
_LINES = {
    "truth": {"color": "0.15", "linewidth": 2.2},
    FULL: {"color": "tab:blue", "linewidth": 1.4},
    BASELINE: {"color": "tab:red", "linewidth": 0.9},
}
_DRAWN_TO = 0.15  # of the false positives: beyond it nothing is usable


def shoulder_plot(captures: Sequence[ShoulderAngles]) -> Figure:
    """The shoulder's angle over time, one panel a capture (paper Fig. 10)."""
    figure = Figure(figsize=(10.0, 2.4 * len(captures)), layout="constrained")
    panels = figure.subplots(len(captures), 1, squeeze=False)[:, 0]
    for panel, shoulder in zip(panels, captures, strict=True):
        for who, angle_deg in shoulder.angle_deg.items():
            panel.plot(shoulder.times_s, angle_deg, label=who, **_LINES[who])
        panel.set_title(shoulder.capture, fontsize=10)
        panel.set_ylabel("left shoulder [°]")
        panel.grid(alpha=0.3)
    panels[0].legend(loc="upper right", ncols=3, fontsize=9)
    panels[-1].set_xlabel("time [s]")
    return figure


def reliability_plot(of: Reliability) -> Figure:
    """RMS error, and share of joints that are near, over the confidence they had."""
    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    middle = (np.arange(TENTHS) + 0.5) / TENTHS
    left.bar(middle, of.rms_cm, width=0.085, color="tab:red")
    left.set_ylabel("RMS error [cm]")
    right.bar(middle, 100.0 * of.near, width=0.085, color="tab:blue")
    right.set_ylabel(f"within {NEAR_CM:g} cm [%]")
    right.axhline(95.0, color="0.4", linewidth=0.9, linestyle="--")
    for panel in (left, right):
        panel.set_xlabel("confidence")
        panel.set_xlim(0.0, 1.0)
        panel.grid(axis="y", alpha=0.3)
    return figure


def roc_plot(captures: Sequence[tuple[str, Roc]]) -> Figure:
    """Correct classification over false positives, one panel a capture (paper Fig. 6)."""
    columns = min(2, len(captures))
    rows = -(-len(captures) // columns)
    size = (5.0 * columns, 3.8 * rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel, (name, roc) in zip(panels, captures, strict=False):
        panel.plot(roc.alone.false, roc.alone.correct, "tab:red", label="step 1: colour alone")
        panel.plot(roc.assisted.false, roc.assisted.correct, "tab:blue", label="step 3: with pose")
        if roc.tracker.shirt > 0:
            panel.plot(roc.tracker.false, roc.tracker.correct, "ko", label="the tracker as it runs")
        panel.set_title(name, fontsize=10)
        panel.set_xlabel("false positives")
        panel.set_ylabel("correct")
        panel.set_xlim(0.0, _DRAWN_TO)
        panel.set_ylim(0.0, 1.0)
        panel.grid(alpha=0.3)
    for panel in panels[len(captures) :]:
        panel.set_axis_off()
    panels[0].legend(loc="lower right", fontsize=9)
    return figure


def save(figure: Figure, path: Path) -> None:
    """Write a PNG; the same data give the same bytes. Raises CannotCreateError."""
    metadata: dict[str, Any] = {"Software": None}
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=_DPI, metadata=metadata)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(picture.getvalue())
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "choose another folder with --out"
        ) from None
