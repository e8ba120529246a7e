"""Counting what somebody does again and again: squats, jumping jacks, strokes at the wall. Pure."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from mocapd.types import Floats
from mocapd_analysis.session import Session, segments_of

PERIODS_S = (0.3, 12.0)  # of one repetition
LEAST_ALIKE = 0.5  # correlation of the motion with itself one period later
LEAST_COUNT = 3  # two alike moves are no exercise yet
_STEP_S = 1.0 / 30.0
_NEARLY = 0.15  # as alike
_LEAST_SHARE = 0.4  # of the usual range of the signal, that a repetition rises and falls by


@dataclass(frozen=True, slots=True)
class Rhythm:
    """What repeats in a signal. period_s: from one to the next; alike: correlation one period later, -1..1."""

    period_s: float
    alike: float


@dataclass(frozen=True, slots=True)
class Repetition:
    """One of them: from the low before its top to the low after it; range: how far the signal rose."""

    start_s: float
    top_s: float
    end_s: float
    range: float


@dataclass(frozen=True, slots=True)
class Repetitions:
    """signal: by which they were counted, in `unit`."""

    signal: str
    unit: str
    rhythm: Rhythm
    each: tuple[Repetition, ...]


def rhythm_of(times_s: Floats, values: Floats) -> Rhythm | None:
    """The period at which a signal (F,) repeats, in its longest run; None where it does not."""
    best: Rhythm | None = None
    longest = 0
    for part in segments_of(times_s):
        known = np.isfinite(values[part])
        if known.sum() < 10 or known.sum() <= longest:
            continue
        longest = int(known.sum())
        best = _rhythm(times_s[part][known], values[part][known])
    return best


def _rhythm(times_s: Floats, values: Floats) -> Rhythm | None:
    at_s = np.arange(times_s[0], times_s[-1], _STEP_S)
    most = min(round(PERIODS_S[1] / _STEP_S), len(at_s) // 2)
    least = round(PERIODS_S[0] / _STEP_S)
    if most <= least + 2:
        return None
    signal = np.interp(at_s, times_s, values)
    signal -= signal.mean()
    if signal.std() < 1e-9:
        return None
    alike = np.array([_alike(signal, lag) for lag in range(most + 1)])
    tops, _ = find_peaks(alike, height=LEAST_ALIKE)
    tops = tops[tops >= least]
    if len(tops) == 0:
        return None
    # two periods are alike too: the first that is nearly as alike as any
    first = tops[alike[tops] >= alike[tops].max() - _NEARLY][0]
    return Rhythm(float(first) * _STEP_S, float(alike[first]))


def _alike(signal: Floats, lag: int) -> float:
    a, b = signal[: len(signal) - lag], signal[lag:]
    norm = float(np.sqrt((a * a).sum() * (b * b).sum()))
    return float((a * b).sum()) / norm if norm > 0.0 else 0.0


def counted(times_s: Floats, values: Floats, rhythm: Rhythm) -> tuple[Repetition, ...]:
    """The repetitions of a signal (F,) of this rhythm; none goes across a gap."""
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return ()
    usual = float(np.quantile(known, 0.95) - np.quantile(known, 0.05))
    found: list[Repetition] = []
    for part in segments_of(times_s):
        is_known = np.isfinite(values[part])
        at_s, signal = times_s[part][is_known], values[part][is_known]
        if len(signal) < 5:
            continue
        apart = max(1, round(0.5 * rhythm.period_s / float(np.median(np.diff(at_s)))))
        # padded, as a repetition may begin or end with the run
        padded = np.concatenate([[signal.min()], signal, [signal.min()]])
        tops, _ = find_peaks(padded, prominence=_LEAST_SHARE * usual, distance=apart)
        found += _between_lows(at_s, signal, (tops - 1).tolist(), rhythm.period_s)
    return tuple(found)


def _between_lows(
    at_s: Floats, signal: Floats, tops: list[int], period_s: float
) -> list[Repetition]:
    """Each top with the lows about it; before the first and after the last, within a period."""
    out: list[Repetition] = []
    for number, top in enumerate(tops):
        earliest = tops[number - 1] if number else int(np.searchsorted(at_s, at_s[top] - period_s))
        latest = (
            tops[number + 1]
            if number + 1 < len(tops)
            else int(np.searchsorted(at_s, at_s[top] + period_s, side="right")) - 1
        )
        start = earliest + int(signal[earliest : top + 1].argmin())
        end = top + int(signal[top : latest + 1].argmin())
        low = max(float(signal[start]), float(signal[end]))
        out.append(
            Repetition(
                float(at_s[start]), float(at_s[top]), float(at_s[end]), float(signal[top]) - low
            )
        )
    return out


def repetitions_of(session: Session, signals: dict[str, tuple[str, Floats]]) -> Repetitions | None:
    """Counted by the signal that repeats most clearly; None where nothing does.

    signals: name to unit and values (F,). Nobody has to say what the exercise was: of the signals that repeat
    nearly as clearly as any, those of the longest period tell the whole of a movement (the hips rise twice in a
    jumping jack, and the arms once), and of these the clearest counts.
    """
    rhythms = {
        name: rhythm
        for name, (_, values) in signals.items()
        if (rhythm := rhythm_of(session.times_s, values)) is not None
    }
    if not rhythms:
        return None
    clearest = max(rhythm.alike for rhythm in rhythms.values())
    clear = {name: one for name, one in rhythms.items() if one.alike >= clearest - _NEARLY}
    longest_s = max(rhythm.period_s for rhythm in clear.values())
    whole = [name for name, one in clear.items() if one.period_s >= 0.8 * longest_s]
    name = max(whole, key=lambda one: clear[one].alike)
    unit, values = signals[name]
    each = counted(session.times_s, values, clear[name])
    return Repetitions(name, unit, clear[name], each) if len(each) >= LEAST_COUNT else None
