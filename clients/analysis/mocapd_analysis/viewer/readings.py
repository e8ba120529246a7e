"""What the viewer's panel says at a time. Pure."""

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.csv_tables import wrists
from mocapd_analysis.measures import Measures
from mocapd_analysis.viewer.figure import is_gap

PLOT_S = 2.0  # shown before and after now [s]
PLOT_POINTS = 241


def reading(found: Measures, at_s: float) -> str:
    """Speeds and angles now, as a table of Markdown; says when nobody was tracked."""
    session = found.session
    nearest = int(np.abs(session.times_s - at_s).argmin())
    if is_gap(session, at_s):
        return "*nobody was tracked here*"
    rows: list[tuple[str, ...]] = []
    for side in wrists(found):
        hand = session.joint(f"{side}Hand")
        speed = found.wrist_speed_m_s(side)[nearest]
        acceleration = found.speeds.acceleration_m_s2[nearest, hand]
        rows.append(
            (f"{side} wrist", f"{_number(speed, 2)} m/s", f"{_number(acceleration, 0)} m/s²")
        )
    for name in ("Elbow", "Shoulder", "Knee"):
        values = [
            f"{_number(found.angles_deg[side + name][nearest], 0)}°"
            if side + name in found.angles_deg
            else "–"
            for side in ("left", "right")
        ]
        rows.append((f"{name.lower()} left, right", *values))
    return "| | | |\n|---|---|---|\n" + "\n".join("| " + " | ".join(row) + " |" for row in rows)


def summary(found: Measures) -> str:
    """The session in a few lines of Markdown."""
    lines = [f"{found.session.duration_s:.1f} s, {found.session.rate_hz:.0f} Hz"]
    swing = found.best_swing
    if swing is not None:
        lines.append(
            f"peak swing **{swing.peak_m_s:.2f} m/s**, {swing.side}, at {swing.at_s:.2f} s; {len(found.swings)} swings"
        )
    if found.repetitions is not None:
        lines.append(f"**{len(found.repetitions.each)}** repetitions ({found.repetitions.signal})")
    lines += [
        f"reach of the {side} wrist **{reach.from_shoulder_m:.2f} m**"
        for side, reach in found.reaches.items()
    ]
    lines += [f"*{note}*" for note in found.session.notes]
    return "  \n".join(lines)


def speed_window(found: Measures, at_s: float) -> tuple[Floats, ...]:
    """Times about now [s], each wrist's speed there [m/s], 0 where it is not known, and a mark at now."""
    window_s = at_s + np.linspace(-PLOT_S, PLOT_S, PLOT_POINTS)
    lines = []
    for side in ("left", "right"):
        speed = np.zeros(PLOT_POINTS)
        if side in wrists(found):
            known = np.nan_to_num(found.wrist_speed_m_s(side))
            speed = np.interp(window_s, found.session.times_s, known, left=0.0, right=0.0)
        lines.append(speed)
    mark = np.zeros(PLOT_POINTS)
    mark[PLOT_POINTS // 2] = max(1.0, *(float(line.max()) for line in lines))
    return (window_s, *lines, mark)


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if np.isfinite(value) else "–"
