"""The report: one HTML file that needs nothing else, with its plots inside."""

import base64
import html
import math
from collections.abc import Iterable, Sequence
from importlib import resources

from matplotlib.figure import Figure

from mocapd_analysis import plots
from mocapd_analysis.comparison import compared
from mocapd_analysis.measures import Measures
from mocapd_analysis.report_head import ReportHead, head_html
from mocapd_analysis.swings import LEAST_DURATION_S, LEAST_SPEED_M_S, LEAST_WAY_M, Place

# Nothing is fetched, and nothing runs: a report may be sent to anybody.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
_SHOWN_SWINGS = 12
NO_HEAD = ReportHead()


def report_html(sessions: Sequence[Measures], head: ReportHead = NO_HEAD) -> str:
    """Of one session, or of two side by side."""
    names = " and ".join(found.session.name for found in sessions)
    style = resources.files("mocapd_analysis").joinpath("report_style.css").read_text()
    body = [f"<h1>{_text(names)}</h1>", head_html(head, sessions)]
    if len(sessions) > 1:
        body += _comparison(sessions)
    for number, found in enumerate(sessions):
        body += _session(
            found, f"{'AB'[number]}: {found.session.name}" if len(sessions) > 1 else ""
        )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{_text(names)}: motion</title><style>{style}</style></head>"
        f"<body><main>{''.join(body)}{_FOOTER}</main></body></html>\n"
    )


_FOOTER = (
    "<footer>Speeds are derivatives of local polynomials of degree 6 over 0.27 s, accelerations of degree 4 "
    "(Savitzky and Golay). Of clips of real motion, sampled at 30 Hz with the noise of a tracker, half of all "
    "peak speeds come out within about 2 %, nine of ten within about 7 %; see <code>mocapd-analysis accuracy</code>. "
    "Shaded times: nobody was tracked; no figure goes across them. From, to: the first and the last moment that a "
    "figure is of; x is the room's left, y up, z ahead. A figure without them is of the whole session. "
    "Wrist: the joint that the hand hangs on.</footer>"
)


def _session(found: Measures, title: str) -> list[str]:
    session = found.session
    out = [f"<h2>{_text(title)}</h2>"] if title else []
    out.append(
        f'<p class="sub">{session.duration_s:.1f} s, {len(session.times_s)} frames, '
        f"{session.rate_hz:.0f} Hz{_gap_words(found)}</p>"
    )
    out += [f'<p class="note">{_text(note)}</p>' for note in session.notes]
    out += [
        _cards(found),
        "<h2>Speed</h2>",
        _picture(plots.speed_plot(found), "speed of the wrists"),
    ]
    out += [
        _swing_table(found),
        _picture(plots.swing_plot(found), "the fastest swing", narrow=True),
    ]
    out += ["<h3>Acceleration</h3>", _picture(plots.acceleration_plot(found), "acceleration")]
    out += ["<h2>Joints</h2>", _joint_table(found)]
    out += ["<h2>Angles</h2>", _angle_table(found), _picture(plots.angle_plot(found), "angles")]
    out += ["<h2>Reach</h2>", _reach_table(found)]
    out.append(_picture(plots.reach_plot(found), "where the wrists went", narrow=True))
    out += ["<h2>Left and right</h2>", _symmetry_table(found)]
    out += ["<h2>Repetitions</h2>", _repetition_table(found)]
    out.append(_picture(plots.repetition_plot(found), "repetitions"))
    return out


def _gap_words(found: Measures) -> str:
    gaps = found.session.gaps_s
    if not gaps:
        return ""
    lost_s = sum(end_s - start_s for start_s, end_s in gaps)
    return f"; {len(gaps)} time{'s' if len(gaps) > 1 else ''} not tracked, {lost_s:.1f} s in all"


def _cards(found: Measures) -> str:
    cards = []
    swing = found.best_swing
    if swing is not None:
        cards.append(
            (f"{swing.peak_m_s:.1f} m/s", f"peak swing, {swing.side} wrist at {swing.at_s:.2f} s")
        )
    cards.append((str(len(found.swings)), "swings"))
    if found.repetitions is not None:
        repeated = found.repetitions
        cards.append(
            (
                str(len(repeated.each)),
                f"repetitions, every {repeated.rhythm.period_s:.2f} s ({repeated.signal})",
            )
        )
    for side, reach in found.reaches.items():
        cards.append((f"{reach.from_shoulder_m:.2f} m", f"reach, {side} wrist from its shoulder"))
    cards += [
        (f"{pair.index_percent:+.0f} %", "left wrist's way over the right one's")
        for pair in found.pairs
        if pair.measure == "wrist way"
    ]
    return (
        '<div class="cards">'
        + "".join(
            f'<div class="card"><b>{_text(big)}</b><span>{_text(small)}</span></div>'
            for big, small in cards
        )
        + "</div>"
    )


def _swing_table(found: Measures) -> str:
    if not found.swings:
        return (
            f"<p>No swing: no wrist was faster than {LEAST_SPEED_M_S:g} m/s over {100 * LEAST_WAY_M:.0f} cm and "
            f"{LEAST_DURATION_S:g} s, or none was seen.</p>"
        )
    fastest = sorted(found.swings, key=lambda swing: -swing.peak_m_s)[:_SHOWN_SWINGS]
    more = len(found.swings) - len(fastest)
    return _table(
        ("swing", "at [s]", "peak [m/s]", "above half of it from [s]", "to [s]", "for [s]", "way meanwhile [m]",
         "from x, y, z [m]", "to x, y, z [m]"),
        (
            (swing.side, f"{swing.at_s:.2f}", f"{swing.peak_m_s:.2f}", f"{swing.start_s:.2f}", f"{swing.end_s:.2f}",
             f"{swing.end_s - swing.start_s:.2f}", f"{swing.way_m:.2f}", _place(swing.start_m), _place(swing.end_m))
            for swing in fastest
        ),
    ) + (f"<p>and {more} slower ones.</p>" if more else "")  # fmt: skip


def _joint_table(found: Measures) -> str:
    return _table(
        ("joint", "peak speed [m/s]", "at [s]", "mean speed [m/s]", "peak acceleration [m/s²]", "way [m]", "seen [%]",
         "from [s]", "to [s]"),
        (
            (name, _number(one.peak_speed.value), _number(one.peak_speed.at_s), _number(one.mean_speed_m_s),
             _number(one.peak_acceleration.value, 0), _number(one.way_m, 1), _number(100 * one.seen, 0),
             _number(one.from_s), _number(one.to_s))
            for name, one in found.joints.items()
        ),
    )  # fmt: skip


def _angle_table(found: Measures) -> str:
    return _table(
        ("angle", "least [°]", "most [°]", "range [°]", "mean [°]", "fastest [°/s]", "at [s]", "from [s]", "to [s]"),
        (
            (name, _number(one.least_deg, 0), _number(one.most_deg, 0), _number(one.range_deg, 0),
             _number(one.mean_deg, 0), _number(one.peak_rate.value, 0), _number(one.peak_rate.at_s),
             _number(one.from_s), _number(one.to_s))
            for name, one in found.angles.items()
        ),
    )  # fmt: skip


def _reach_table(found: Measures) -> str:
    if not found.reaches:
        return "<p>No wrist was seen.</p>"
    return _table(
        ("wrist", "from its shoulder [m]", "highest [m]", "forward [m]", "outward [m]", "across [m]", "up [m]",
         "space [l]"),
        (
            (side, *(_number(value) for value in (
                one.from_shoulder_m, one.highest_m, one.forward_m, one.outward_m, one.across_m, one.up_m)),
             _number(one.volume_l, 0))
            for side, one in found.reaches.items()
        ),
    )  # fmt: skip


def _symmetry_table(found: Measures) -> str:
    if not found.pairs:
        return "<p>Not both sides were seen.</p>"
    told = ""
    if found.together is not None:
        both = found.together
        told = (
            f"<p>The wrists' speeds correlate by {both.correlation:+.2f}; best by {both.best_correlation:+.2f} with "
            f"the right one {abs(both.right_follows_s):.2f} s {'after' if both.right_follows_s >= 0 else 'before'} "
            "the left one.</p>"
        )
    return told + _table(
        ("measure", "left", "right", "unit", "left over right [%]"),
        (
            (
                pair.measure,
                _number(pair.left),
                _number(pair.right),
                pair.unit,
                f"{pair.index_percent:+.0f}",
            )
            for pair in found.pairs
        ),
    )


def _repetition_table(found: Measures) -> str:
    repeated = found.repetitions
    if repeated is None:
        return "<p>Nothing repeats three times and more.</p>"
    return _table(
        ("repetition", "from [s]", "top at [s]", "to [s]", "takes [s]", f"range [{repeated.unit}]"),
        (
            (str(number), f"{one.start_s:.2f}", f"{one.top_s:.2f}", f"{one.end_s:.2f}",
             f"{one.end_s - one.start_s:.2f}", _number(one.range))
            for number, one in enumerate(repeated.each, start=1)
        ),
    )  # fmt: skip


def _comparison(sessions: Sequence[Measures]) -> list[str]:
    table = _table(
        ("measure", "A", "B", "unit", "B over A [%]"),
        (
            (
                one.measure,
                _number(one.a),
                _number(one.b),
                one.unit,
                _number(one.change_percent, 0, signed=True),
            )
            for one in compared(sessions[0], sessions[1])
        ),
    )
    picture = _picture(plots.aligned_plot(sessions), "the fastest swings over each other")
    return ["<h2>Side by side</h2>", table, picture]


def _picture(figure: Figure | None, words: str, narrow: bool = False) -> str:
    if figure is None:
        return ""
    data = base64.b64encode(plots.as_svg(figure).encode()).decode()
    kind = ' class="narrow"' if narrow else ""
    return f'<img{kind} alt="{_text(words)}" src="data:image/svg+xml;base64,{data}">'


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f"<th>{_text(cell)}</th>" for cell in header)
    body = "".join(
        "<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _number(value: float, digits: int = 2, signed: bool = False) -> str:
    if not math.isfinite(value):
        return "–"
    return f"{value:{'+' if signed else ''}.{digits}f}"


def _place(at_m: Place) -> str:
    return ", ".join(f"{value:.2f}" for value in at_m)


def _text(words: str) -> str:
    return html.escape(words)
