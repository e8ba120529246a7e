"""The plots of the docs, as PNG files."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from lab.compared.compare import BASELINE, FULL, ShoulderAngles
from lab.compared.roc import Roc
from lab.studies.cue_changes import Interruptions
from mocapd.types import Floats

Spans = Sequence[tuple[float, float]]  # from, to [s]

_LINES = {
    "truth": {"color": "0.15", "linewidth": 2.2},
    FULL: {"color": "tab:blue", "linewidth": 1.4},
    BASELINE: {"color": "tab:red", "linewidth": 0.9},
}
_SPANS = ("tab:orange", "black", "tab:green", "tab:purple")  # of what happened
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


def cues_plot(of: Interruptions, limit_cm: float, spans: Mapping[str, Spans]) -> Figure:
    """The cues over time, and below them the farthest that a joint went in a frame; spans: by what happened, when [s]."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    cues, steps = figure.subplots(2, 1, sharex=True, height_ratios=(1.0, 1.3))
    times_s, carrier = of.bodies.times_s, of.bodies.carrier
    rows = [*dict.fromkeys(str(name) for name in carrier if name), "nobody"]
    at = np.array([rows.index(str(name) or "nobody") for name in carrier])
    cues.plot(times_s, np.where(of.in_view, at, np.nan), ".", color="tab:blue", markersize=5)
    cues.plot(times_s, np.where(of.in_view, np.nan, at), ".", color="0.75", markersize=5)
    cues.set_yticks(range(len(rows)), rows)
    cues.set_ylim(len(rows) - 0.5, -0.5)
    cues.set_title("which cues carry the body (grey: nobody is in view)", fontsize=10)
    steps.plot(times_s, of.step_cm, color="tab:red", linewidth=0.9)
    steps.axhline(limit_cm, color="0.4", linewidth=0.9, linestyle="--")
    steps.set_title("farthest step of a joint beyond its true motion", fontsize=10)
    steps.set_ylabel("[cm]")
    steps.set_xlabel("time [s]")
    for panel in (cues, steps):
        panel.grid(axis="x", alpha=0.3)
        for colour, (what, when) in zip(_SPANS, spans.items(), strict=False):
            for number, (from_s, to_s) in enumerate(when):
                label = what if number == 0 and panel is steps else None
                panel.axvspan(from_s, to_s, color=colour, alpha=0.18, linewidth=0, label=label)
    steps.legend(loc="upper right", ncols=4, fontsize=9)
    return figure


def recovery_plot(
    scenes: Mapping[str, Sequence[tuple[str, Floats, Floats]]],
    clear_s: Mapping[str, float],
    wanted_s: float,
    limit_cm: float,
) -> Figure:
    """RMS error over time, one panel a scene, one line (label, times [s], errors [cm]) a rig; clear_s: from when on the
    person is in the open, wanted_s: how long it may take until the error is below the limit."""
    figure = Figure(figsize=(10.0, 1.7 * len(scenes)), layout="constrained")
    panels = figure.subplots(len(scenes), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (scene, lines) in zip(panels, scenes.items(), strict=True):
        for label, times_s, errors_cm in lines:
            told = np.where(np.isfinite(errors_cm), errors_cm, np.nan)
            panel.plot(times_s, told, label=label, linewidth=1.2)
        panel.axvspan(clear_s[scene], clear_s[scene] + wanted_s, color="0.88", linewidth=0)
        panel.axhline(limit_cm, color="0.4", linewidth=0.9, linestyle="--")
        panel.set_title(scene.replace("_", " "), fontsize=10)
        panel.set_ylabel("RMS [cm]")
        panel.set_ylim(bottom=0.0)
        panel.grid(alpha=0.3)
    panels[0].legend(loc="upper right", ncols=2, fontsize=9)
    panels[-1].set_xlabel("time [s]")
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
