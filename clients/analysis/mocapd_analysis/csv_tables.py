"""The figures for a spreadsheet: one table of measures, one of every frame. Pure."""

import csv
import io
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from mocapd_analysis.joint_angles import SIDES
from mocapd_analysis.measures import Measures

NEVER = float("nan")


@dataclass(frozen=True, slots=True)
class MeasureRow:
    """One figure: of what, its unit, when it was reached [s], and of which time it is, from from_s to to_s [s]."""

    measure: str
    of: str
    unit: str
    value: float
    from_s: float
    to_s: float
    at_s: float = NEVER


def measure_rows(found: Measures) -> list[MeasureRow]:
    """Every measure of a session."""
    session = float(found.session.times_s[0]), float(found.session.times_s[-1])
    rows = [*_joint_rows(found), *_angle_rows(found), *_swing_rows(found)]
    for side, reach in found.reaches.items():
        rows += [
            MeasureRow(measure, side, unit, value, *session)
            for measure, unit, value in (
                ("reach from the shoulder", "m", reach.from_shoulder_m),
                ("highest", "m", reach.highest_m),
                ("reach forward", "m", reach.forward_m),
                ("reach outward", "m", reach.outward_m),
                ("reach across", "m", reach.across_m),
                ("reach up", "m", reach.up_m),
                ("space reached", "l", reach.volume_l),
            )
        ]
    rows += [
        MeasureRow("left over right", pair.measure, "percent", pair.index_percent, *session)
        for pair in found.pairs
    ]
    if found.together is not None:
        both = found.together
        rows += [
            MeasureRow("wrists together", "correlation", "", both.correlation, *session),
            MeasureRow(
                "wrists together", "right follows left", "s", both.right_follows_s, *session
            ),
        ]
    if found.repetitions is not None:
        signal, unit = found.repetitions.signal, found.repetitions.unit
        each, period_s = found.repetitions.each, found.repetitions.rhythm.period_s
        rows.append(MeasureRow("repetitions", signal, "count", float(len(each)), *session))
        rows.append(MeasureRow("period", signal, "s", period_s, *session))
        rows += [
            MeasureRow(
                "range", f"repetition {n}", unit, one.range, one.start_s, one.end_s, one.top_s
            )
            for n, one in enumerate(each, start=1)
        ]
    return rows


def _joint_rows(found: Measures) -> Iterator[MeasureRow]:
    for name, joint in found.joints.items():
        span = joint.from_s, joint.to_s
        speed, acceleration = joint.peak_speed, joint.peak_acceleration
        yield MeasureRow("peak speed", name, "m/s", speed.value, *span, speed.at_s)
        yield MeasureRow("mean speed", name, "m/s", joint.mean_speed_m_s, *span)
        yield MeasureRow(
            "peak acceleration", name, "m/s2", acceleration.value, *span, acceleration.at_s
        )
        yield MeasureRow("way", name, "m", joint.way_m, *span)
        yield MeasureRow("seen", name, "share", joint.seen, *span)


def _angle_rows(found: Measures) -> Iterator[MeasureRow]:
    for name, angle in found.angles.items():
        span = angle.from_s, angle.to_s
        yield MeasureRow("least angle", name, "deg", angle.least_deg, *span)
        yield MeasureRow("most angle", name, "deg", angle.most_deg, *span)
        yield MeasureRow("mean angle", name, "deg", angle.mean_deg, *span)
        yield MeasureRow(
            "peak rate", name, "deg/s", angle.peak_rate.value, *span, angle.peak_rate.at_s
        )


def _swing_rows(found: Measures) -> Iterator[MeasureRow]:
    for number, swing in enumerate(found.swings, start=1):
        of, span = f"swing {number} {swing.side}", (swing.start_s, swing.end_s)
        yield MeasureRow("peak speed", of, "m/s", swing.peak_m_s, *span, swing.at_s)
        yield MeasureRow("way", of, "m", swing.way_m, *span)
        yield MeasureRow("duration", of, "s", swing.end_s - swing.start_s, *span)
        for end, place in (("start", swing.start_m), ("end", swing.end_m)):
            for axis, value in zip("xyz", place, strict=True):
                yield MeasureRow(f"{end} {axis}", of, "m", value, *span)


def measures_csv(sessions: Iterable[Measures]) -> str:
    """All measures, a line each: session, measure, of, unit, value, at_s, from_s, to_s."""
    rows = [
        (
            found.session.name,
            *(row.measure, row.of, row.unit),
            *map(_number, (row.value, row.at_s, row.from_s, row.to_s)),
        )
        for found in sessions
        for row in measure_rows(found)
    ]
    return _text(("session", "measure", "of", "unit", "value", "at_s", "from_s", "to_s"), rows)


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
