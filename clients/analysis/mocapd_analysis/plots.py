"""The plots of the report, as figures; `as_svg` makes each the text of a picture."""

import io
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from mocapd.types import Floats
from mocapd_analysis.body_frame import in_body_m
from mocapd_analysis.csv_tables import wrists
from mocapd_analysis.joint_angles import SIDES, has_trunk
from mocapd_analysis.measures import Measures
from mocapd_analysis.session import Session

COLOURS = {"left": "#c4541a", "right": "#12505f"}
BY_SESSION = ("#12505f", "#c4541a")
_MOST_POINTS = 1000  # of a line; more than a report's width in pixels
_GREY = "0.45"


def as_svg(figure: Figure) -> str:
    """The same figure gives the same text."""
    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "mocapd", "font.size": 9}):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue()


def speed_plot(found: Measures) -> Figure:
    """Both wrists' speed over time, the swings' tops marked, the gaps grey."""
    figure, panel = _figure(9.0, 2.7)
    for side in wrists(found):
        times_s, speed = thinned(found.session.times_s, found.wrist_speed_m_s(side))
        panel.plot(times_s, speed, color=COLOURS[side], linewidth=1.1, label=f"{side} wrist")
        tops = [swing for swing in found.swings if swing.side == side]
        panel.plot(
            [swing.at_s for swing in tops], [swing.peak_m_s for swing in tops], "o",
            color=COLOURS[side], markersize=4, markeredgecolor="white",
        )  # fmt: skip
    _mark_gaps(panel, found.session)
    panel.set_ylabel("speed [m/s]")
    panel.set_ylim(bottom=0.0)
    _finish_time(panel)
    return figure


def acceleration_plot(found: Measures) -> Figure:
    """Both wrists' acceleration over time."""
    figure, panel = _figure(9.0, 2.2)
    for side in wrists(found):
        at = found.session.joint(f"{side}Hand")
        values = np.where(found.speeds.seen[:, at], found.speeds.acceleration_m_s2[:, at], np.nan)
        panel.plot(
            *thinned(found.session.times_s, values), color=COLOURS[side], linewidth=0.9,
            label=f"{side} wrist",
        )  # fmt: skip
    _mark_gaps(panel, found.session)
    panel.set_ylabel("acceleration [m/s²]")
    panel.set_ylim(bottom=0.0)
    _finish_time(panel)
    return figure


def angle_plot(found: Measures) -> Figure:
    """Each angle that was told, left and right in one panel."""
    kinds = [
        kind
        for kind in ("Elbow", "Shoulder", "Knee", "Hip")
        if any(side + kind in found.angles_deg for side in SIDES)
    ]
    trunk = [name for name in ("lean", "twist") if name in found.angles_deg]
    count = max(1, len(kinds) + bool(trunk))
    figure = Figure(figsize=(9.0, 1.5 * count + 0.3), layout="constrained")
    panels = figure.subplots(count, 1, squeeze=False, sharex=True)[:, 0]
    for panel, kind in zip(panels, kinds, strict=False):
        for side in SIDES:
            if side + kind in found.angles_deg:
                line = thinned(found.session.times_s, found.angles_deg[side + kind])
                panel.plot(*line, color=COLOURS[side], linewidth=1.1, label=side)
        panel.set_ylabel(f"{kind.lower()} [°]")
    for name, colour in zip(trunk, (_GREY, "black"), strict=False):
        line = thinned(found.session.times_s, found.angles_deg[name])
        panels[-1].plot(*line, color=colour, linewidth=1.1, label=name)
        panels[-1].set_ylabel("trunk [°]")
    for panel in panels:
        _mark_gaps(panel, found.session)
        _finish_time(panel, last=panel is panels[-1])
    return figure


def repetition_plot(found: Measures) -> Figure | None:
    """The signal that the repetitions were counted by, each top numbered; None where nothing repeats."""
    repeated = found.repetitions
    if repeated is None:
        return None
    values = (
        found.angles_deg[repeated.signal]
        if repeated.signal in found.angles_deg
        else found.session.positions_m(repeated.signal.removeprefix("height of "))[:, 1]
    )
    figure, panel = _figure(9.0, 2.2)
    panel.plot(*thinned(found.session.times_s, values), color=_GREY, linewidth=1.1)
    for number, one in enumerate(repeated.each, start=1):
        top = float(np.interp(one.top_s, found.session.times_s, values))
        panel.axvspan(one.start_s, one.end_s, color=BY_SESSION[number % 2], alpha=0.08)
        panel.annotate(
            str(number), (one.top_s, top), (0, 3), textcoords="offset points", ha="center"
        )
    panel.margins(y=0.18)
    panel.set_ylabel(f"{repeated.signal} [{'°' if repeated.unit == 'deg' else repeated.unit}]")
    _finish_time(panel, legend=False)
    return figure


def reach_plot(found: Measures) -> Figure | None:
    """Where the wrists went, seen from the front and from above, from the middle of the shoulders."""
    sides = wrists(found)
    if not sides or not has_trunk(found.session):
        return None
    figure = Figure(figsize=(7.6, 3.6), layout="constrained")
    front, above = figure.subplots(1, 2)
    for side in sides:
        seen = found.session.is_seen(f"{side}Hand")
        own = in_body_m(found.session, (f"{side}Hand",))[seen, 0]
        own = own[:: max(1, len(own) // 500)]
        # as one sees the person: its left is on the right
        for panel, vertical in ((front, 1), (above, 2)):
            panel.plot(
                own[:, 0], own[:, vertical], ".", color=COLOURS[side], markersize=2, alpha=0.5,
                label=f"{side} wrist",
            )  # fmt: skip
    for panel, title, upward in (
        (front, "from the front", "above the shoulders [m]"),
        (above, "from above", "forward [m]"),
    ):
        panel.plot(0.0, 0.0, "+", color="black", markersize=9)
        panel.set_aspect("equal", adjustable="datalim")
        panel.set_title(title, fontsize=9)
        panel.set_xlabel("to the person's left [m]")
        panel.set_ylabel(upward)
        panel.grid(alpha=0.3)
    front.legend(loc="lower right", fontsize=8, markerscale=4)
    return figure


def swing_plot(found: Measures) -> Figure | None:
    """The fastest swing as pictures of the whole person on top of each other, from the front and from the side."""
    swing = found.best_swing
    if swing is None:
        return None
    session = found.session
    within = np.flatnonzero(
        (session.times_s >= swing.start_s - 0.1) & (session.times_s <= swing.end_s + 0.1)
    )
    shown = within[np.unique(np.linspace(0, len(within) - 1, 7).round().astype(int))]
    hand = session.joint(f"{swing.side}Hand")
    child = np.flatnonzero(session.parents >= 0)
    ends = np.stack([session.parents[child], child], axis=1)
    bones_m = session.joints_m[shown][:, ends]  # (frames, bones, 2, 3)
    strength = 0.15 + 0.75 * np.arange(1, len(shown) + 1) / len(shown)
    figure = Figure(figsize=(7.6, 3.8), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for panel, axis, title in (
        (panels[0], 0, "along Z (from the front)"),
        (panels[1], 2, "along X (from the side)"),
    ):
        panel.add_collection(
            LineCollection(
                bones_m[..., [axis, 1]].reshape(-1, 2, 2),
                colors=[(0.0, 0.0, 0.0, one) for one in strength.repeat(len(child))],
                linewidths=1.2,
            )
        )
        trail = session.joints_m[within, hand]
        panel.plot(trail[:, axis], trail[:, 1], color=COLOURS[swing.side], lw=2.2)
        panel.set_aspect("equal", adjustable="datalim")
        panel.set_title(title, fontsize=9)
        panel.xaxis.set_major_locator(MaxNLocator(5))
        panel.set_xlabel(f"{'xyz'[axis]} [m]")
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("height [m]")
    return figure


def aligned_plot(sessions: Sequence[Measures]) -> Figure | None:
    """The fastest swings of several sessions over each other, their tops at time 0."""
    figure, panel = _figure(9.0, 2.7)
    for number, found in enumerate(sessions):
        swing = found.best_swing
        if swing is None:
            return None
        since_s = found.session.times_s - swing.at_s
        near = np.abs(since_s) <= 1.0
        panel.plot(
            since_s[near], found.wrist_speed_m_s(swing.side)[near],
            color=BY_SESSION[number % 2], linewidth=1.6,
            label=f"{'AB'[number % 2]}: {swing.side} wrist",
        )  # fmt: skip
    panel.set_ylabel("speed [m/s]")
    _finish_time(panel)
    panel.set_xlabel("time about the top [s]")
    return figure


def thinned(times_s: Floats, values: Floats) -> tuple[Floats, Floats]:
    """At most some thousand points of a line (F,), the least and the most of each piece: no top is lost."""
    if len(values) <= _MOST_POINTS:
        return times_s, values
    size = -(-2 * len(values) // _MOST_POINTS)
    keep: list[int] = []
    for start in range(0, len(values), size):
        piece = values[start : start + size]
        if np.isfinite(piece).any():
            keep += sorted({start + int(np.nanargmin(piece)), start + int(np.nanargmax(piece))})
        else:
            keep.append(start)
    return times_s[keep], values[keep]


def _figure(width: float, height: float) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots()


def _mark_gaps(panel: Any, session: Session) -> None:
    for start_s, end_s in session.gaps_s:
        panel.axvspan(start_s, end_s, color="0.85", zorder=0)


def _finish_time(panel: Any, last: bool = True, legend: bool = True) -> None:
    panel.grid(alpha=0.3)
    panel.margins(x=0.01)
    if last:
        panel.set_xlabel("time [s]")
    if legend and panel.get_legend_handles_labels()[0]:
        panel.legend(loc="upper right", fontsize=8, ncols=2)
