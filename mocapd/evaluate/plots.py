"""The plot of the evaluation's page, as a PNG file."""

import io
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from mocapd.evaluate.reliability import NEAR_CM, TENTHS, Reliability
from mocapd.evaluate.write_out import write_out

_DPI = 110


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


def save(figure: Figure, path: Path, force: bool = False) -> None:
    """Write a PNG; the same data give the same bytes. Raises CannotCreateError."""
    metadata: dict[str, Any] = {"Software": None}
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=_DPI, metadata=metadata)
    write_out(path, picture.getvalue(), force)
