"""The figures for a spreadsheet: one table of measures, one of every frame. Pure."""

import csv
import io
import math
from collections.abc import Iterable

import numpy as np

from mocapd_analysis.joint_angles import SIDES
from mocapd_analysis.measures import Measures

Row = tuple[str, str, str, float, float]  # measure, of what, unit, value, when [s]
NEVER = float("nan")


def measure_rows(found: Measures) -> list[Row]:
    """Every measure of a session."""
    rows: list[Row] = []
    for name, joint in found.joints.items():
        rows += [
            ("peak speed", name, "m/s", joint.peak_speed.value, joint.peak_speed.at_s),
            ("mean speed", name, "m/s", joint.mean_speed_m_s, NEVER),
            (
                "peak acceleration",
                name,
                "m/s2",
                joint.peak_acceleration.value,
                joint.peak_acceleration.at_s,
            ),
            ("way", name, "m", joint.way_m, NEVER),
            ("seen", name, "share", joint.seen, NEVER),
        ]
    for name, angle in found.angles.items():
        rows += [
            ("least angle", name, "deg", angle.least_deg, NEVER),
            ("most angle", name, "deg", angle.most_deg, NEVER),
            ("mean angle", name, "deg", angle.mean_deg, NEVER),
            ("peak rate", name, "deg/s", angle.peak_rate.value, angle.peak_rate.at_s),
        ]
    for number, swing in enumerate(found.swings, start=1):
        of = f"swing {number} {swing.side}"
        rows += [
            ("peak speed", of, "m/s", swing.peak_m_s, swing.at_s),
            ("way", of, "m", swing.way_m, swing.start_s),
            ("duration", of, "s", swing.end_s - swing.start_s, swing.start_s),
        ]
    for side, reach in found.reaches.items():
        rows += [
            ("reach from the shoulder", side, "m", reach.from_shoulder_m, NEVER),
            ("highest", side, "m", reach.highest_m, NEVER),
            ("reach forward", side, "m", reach.forward_m, NEVER),
            ("reach outward", side, "m", reach.outward_m, NEVER),
            ("reach across", side, "m", reach.across_m, NEVER),
            ("reach up", side, "m", reach.up_m, NEVER),
            ("space reached", side, "l", reach.volume_l, NEVER),
        ]
    rows += [
        ("left over right", pair.measure, "percent", pair.index_percent, NEVER)
        for pair in found.pairs
    ]
    if found.together is not None:
        rows += [
            ("wrists together", "correlation", "", found.together.correlation, NEVER),
            ("wrists together", "right follows left", "s", found.together.right_follows_s, NEVER),
        ]
    if found.repetitions is not None:
        signal, unit = found.repetitions.signal, found.repetitions.unit
        rows.append(("repetitions", signal, "count", float(len(found.repetitions.each)), NEVER))
        rows.append(("period", signal, "s", found.repetitions.rhythm.period_s, NEVER))
        rows += [
            ("range", f"repetition {number}", unit, one.range, one.top_s)
            for number, one in enumerate(found.repetitions.each, start=1)
        ]
    return rows


def measures_csv(sessions: Iterable[Measures]) -> str:
    """All measures, a line each: session, measure, of, unit, value, at_s."""
    rows = [
        (found.session.name, measure, of, unit, _number(value), _number(at_s))
        for found in sessions
        for measure, of, unit, value, at_s in measure_rows(found)
    ]
    return _text(("session", "measure", "of", "unit", "value", "at_s"), rows)


def frames_csv(found: Measures) -> str:
    """Every frame: time, place, speed and acceleration of each joint, and every angle; what is not known is empty."""
    session, speeds = found.session, found.speeds
    header, columns = ["time_s"], [session.times_s]
    for at, name in enumerate(session.joint_names):
        header += [f"{name}_{axis}_m" for axis in "xyz"]
        columns += list(session.joints_m[:, at].T)
        header += [f"{name}_speed_m_s", f"{name}_acceleration_m_s2", f"{name}_confidence"]
        columns += [
            speeds.speed_m_s[:, at], speeds.acceleration_m_s2[:, at], session.confidence[:, at],
        ]  # fmt: skip
    for name, values in found.angles_deg.items():
        header += [f"{name}_deg", f"{name}_deg_s"]
        columns += [values, found.angle_rates_deg_s[name]]
    table = np.stack(columns, axis=1).tolist()
    return _text(header, ([_number(value) for value in row] for row in table))


def wrists(found: Measures) -> tuple[str, ...]:
    """The sides whose wrist was seen."""
    return tuple(side for side in SIDES if f"{side}Hand" in found.joints)


def _number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def _text(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return out.getvalue()
