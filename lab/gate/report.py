"""The gate's tables as Markdown: the sets, what changed by more than chance in single recordings, and the verdict."""

from collections.abc import Sequence

import numpy as np

from lab.gate.figures import NAMES
from lab.gate.gate_file import GateFile
from lab.gate.verdict import Change, failures, row_changes, set_changes
from mocapd.evaluate.tables import table


def report(old: GateFile | None, new: GateFile) -> str:
    """The figures of `new`, beside those of `old` where there are some."""
    if old is None:
        return _figures(new)
    sets, rows = set_changes(old, new), row_changes(old, new)
    apart = [one for one in rows if one.word != "noise"]
    parts = [
        f"{old.commit} ({old.tracker}) -> {new.commit} ({new.tracker}); times are scaled by {old.loop_ms / new.loop_ms:.2f}, "
        "the ratio of a fixed loop",
        _changes(sets),
        f"Single recordings: {len(rows) - len(apart)} of {len(rows)} figures changed within noise; the others:",
        _changes(apart) if apart else "none",
    ]
    lines = failures(old, new)
    parts.append("Does not pass:\n" + "\n".join(lines) if lines else "The gate passes.")
    return "\n\n".join(parts)


def _changes(changes: Sequence[Change]) -> str:
    rows = [
        [
            one.where,
            one.figure,
            f"{one.old:.3g}",
            f"{one.new:.3g}",
            f"{one.new - one.old:+.2g}",
            f"{one.noise:.2g}",
            one.word,
        ]
        for one in changes
    ]
    return table(["of", "figure", "old", "new", "change", "noise", ""], rows)


def _figures(new: GateFile) -> str:
    shown = [name for name in NAMES if any(name in row.runs for row in new.rows)]
    rows = [
        [
            f"{row.set_name}/{row.name}",
            *(f"{np.mean(row.runs[name]):.3g}" if name in row.runs else "" for name in shown),
        ]
        for row in new.rows
    ]
    return table(["of", *shown], rows)
