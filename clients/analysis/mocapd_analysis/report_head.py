"""What stands at the head of a report: who was recorded, when, and what the coach notes."""

import html
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from mocapd_analysis.measures import Measures


@dataclass(frozen=True, slots=True)
class ReportHead:
    """As the user gave them; empty where not. date: in place of that of the recordings."""

    person: str = ""
    date: str = ""
    notes: str = ""


def head_html(head: ReportHead, sessions: Sequence[Measures]) -> str:
    """The lines under the title; every word is text."""
    rows = [
        ("Person", head.person),
        ("Date", head.date or ", ".join(dict.fromkeys(filter(None, map(date_of, sessions))))),
        ("Notes", head.notes),
    ]
    lines = "".join(
        f"<dt>{name}</dt><dd>{html.escape(value)}</dd>" for name, value in rows if value
    )
    return f'<dl class="head">{lines}</dl>' if lines else ""


def date_of(found: Measures) -> str:
    """When it was recorded, in the time of this machine, as 2026-11-26 15:04; empty where the file does not say."""
    recorded_s = found.session.recorded_unix_s
    if recorded_s is None:
        return ""
    try:
        return datetime.fromtimestamp(recorded_s, UTC).astimezone().strftime("%Y-%m-%d %H:%M")
    except (OverflowError, OSError, ValueError):  # beyond any calendar
        return ""
