"""The fast moves of a wrist: strokes, throws, punches. Pure."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from mocapd.types import Floats
from mocapd_analysis.differentiator import peak
from mocapd_analysis.session import Flags, Session

LEAST_SPEED_M_S = 1.5
LEAST_SHARE = 0.5  # of the session's fastest
APART_S = 0.25


@dataclass(frozen=True, slots=True)
class Swing:
    """One move of one wrist.

    peak_m_s at at_s; start_s, end_s: where it has half that speed (or the run of frames ends); way_m: how far
    the wrist went meanwhile.
    """

    side: str
    at_s: float
    peak_m_s: float
    start_s: float
    end_s: float
    way_m: float


def swings_of(
    session: Session,
    side: str,
    speed_m_s: Floats,
    seen: Flags,
) -> tuple[Swing, ...]:
    """The swings of one wrist in order of time, from its speed (F,)."""
    usable = np.where(seen, speed_m_s, np.nan)
    if not np.isfinite(usable).any():
        return ()
    least = max(LEAST_SPEED_M_S, LEAST_SHARE * float(np.nanmax(usable)))
    found: list[Swing] = []
    for part in session.segments:
        for run in _known(usable, part):
            times_s, speed = session.times_s[run], speed_m_s[run]
            apart = max(1, round(APART_S / float(np.median(np.diff(times_s)))))
            # an end is no top: half of a swing before the hand was lost has none that is known
            tops, _ = find_peaks(speed, height=least, prominence=0.3 * least, distance=apart)
            found += [_swing(side, times_s, speed, top) for top in tops.tolist()]
    return tuple(found)


def _known(values: Floats, part: slice) -> list[slice]:
    """The runs of three frames and more within `part` whose values (F,) are known."""
    known = np.concatenate([[False], np.isfinite(values[part]), [False]]).astype(int)
    starts, stops = (np.flatnonzero(np.diff(known) == way) + part.start for way in (1, -1))
    return [
        slice(start, stop)
        for start, stop in zip(starts.tolist(), stops.tolist(), strict=True)
        if stop - start >= 3
    ]


def _swing(side: str, times_s: Floats, speed: Floats, top: int) -> Swing:
    at_s, value = peak(times_s, speed, top)
    slow = np.flatnonzero(speed < 0.5 * value)
    before, after = slow[slow < top], slow[slow > top]
    first = int(before[-1]) + 1 if len(before) else 0
    last = int(after[0]) - 1 if len(after) else len(speed) - 1
    way_m = float(np.trapezoid(speed[first : last + 1], times_s[first : last + 1]))
    return Swing(side, at_s, value, float(times_s[first]), float(times_s[last]), way_m)
