"""Old figures against new: what changed by more than chance, for single recordings and for whole sets."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from lab.gate.figures import BETTER_HIGH, NAMES
from lab.gate.gate_file import GateFile, GateRow

Word = Literal["better", "worse", "noise"]

SET_SHARE = 0.03  # of a set's figure
ONE_CM = 0.5  # of one recording's error
_DEVIATIONS = 2.0  # standard deviations of the difference that chance explains
# What chance does to one run where too few runs tell: a share of the figure.
_FEW_RUNS_SHARE = 0.05
TIMES = frozenset({"step_ms", "cpu_ms"})
_FINE = 1e-6


@dataclass(frozen=True, slots=True)
class Change:
    """One figure of a recording or of a set. noise: what the difference may be by chance."""

    where: str
    figure: str
    old: float
    new: float
    noise: float

    @property
    def word(self) -> Word:
        """Whether the difference is more than chance."""
        difference = self.new - self.old
        if abs(difference) <= self.noise + _FINE:
            return "noise"
        return "better" if (difference > 0.0) is (self.figure in BETTER_HIGH) else "worse"


def row_changes(old: GateFile, new: GateFile) -> list[Change]:
    """Of every recording that both hold, figure by figure."""
    return [
        Change(f"{a.set_name}/{a.name}", figure, *_compared(a, b, figure, _time_scale(old, new)))
        for a, b in _pairs(old, new)
        for figure in NAMES
        if figure in a.runs and figure in b.runs
    ]


def set_changes(old: GateFile, new: GateFile) -> list[Change]:
    """Of every set: the means over its recordings, and what chance does to them."""
    scale = _time_scale(old, new)
    by_set: dict[str, list[tuple[GateRow, GateRow]]] = {}
    for a, b in _pairs(old, new):
        by_set.setdefault(a.set_name, []).append((a, b))
    changes = []
    for name, pairs in by_set.items():
        for figure in NAMES:
            compared = [
                _compared(a, b, figure, scale)
                for a, b in pairs
                if figure in a.runs and figure in b.runs
            ]
            if compared:
                olds, news, noises = map(np.array, zip(*compared, strict=True))
                noise = float(np.sqrt((noises**2).sum())) / len(compared)
                changes.append(Change(name, figure, float(olds.mean()), float(news.mean()), noise))
    return changes


def failures(old: GateFile, new: GateFile) -> list[str]:
    """Why the gate does not pass, a line each: a set worse by more than 3 % and chance, a recording worse by more than half
    a centimetre and chance, any ghost or recording that is gone. Times are shown and never fail."""
    lines = [
        f"{one.where}: {one.figure} {one.old:.2f} -> {one.new:.2f}"
        for one in set_changes(old, new)
        if one.figure not in TIMES
        and one.word == "worse"
        and abs(one.new - one.old) > SET_SHARE * abs(one.old)
    ]
    lines += [
        f"{one.where}: {one.figure} {one.old:.2f} -> {one.new:.2f}"
        for one in row_changes(old, new)
        if one.word == "worse"
        and (one.figure == "ghosts" or (one.figure == "rms_cm" and one.new - one.old > ONE_CM))
    ]
    there = {row.key for row in new.rows}
    measured = {row.set_name for row in new.rows}
    lines += [
        f"{row.set_name}/{row.name}: not measured"
        for row in old.rows
        if row.set_name in measured and row.key not in there
    ]
    return lines


def _time_scale(old: GateFile, new: GateFile) -> float:
    """By which times of the new file are multiplied to be those of the old one's machine."""
    return old.loop_ms / new.loop_ms if new.loop_ms > 0.0 else 1.0


def _pairs(old: GateFile, new: GateFile) -> Iterable[tuple[GateRow, GateRow]]:
    known: Mapping[tuple[str, str], GateRow] = {row.key: row for row in new.rows}
    return [
        (row, known[row.key])
        for row in old.rows
        if row.key in known and known[row.key].joints == row.joints
    ]


def _compared(
    old: GateRow, new: GateRow, figure: str, time_scale: float
) -> tuple[float, float, float]:
    """Old mean, new mean, and what chance explains of their difference."""
    scale = time_scale if figure in TIMES else 1.0
    a, b = old.runs[figure], [scale * value for value in new.runs[figure]]
    return float(np.mean(a)), float(np.mean(b)), _noise(a, b)


def _noise(a: Sequence[float], b: Sequence[float]) -> float:
    """Two standard deviations of the difference of two means, the runs' scatter pooled; a share of the figure where
    nothing was tracked twice."""
    more = len(a) + len(b) - 2
    if more < 1:
        return _FEW_RUNS_SHARE * abs(float(np.mean(a)))
    squares = ((np.array(a) - np.mean(a)) ** 2).sum() + ((np.array(b) - np.mean(b)) ** 2).sum()
    return _DEVIATIONS * math.sqrt(squares / more * (1.0 / len(a) + 1.0 / len(b)))
