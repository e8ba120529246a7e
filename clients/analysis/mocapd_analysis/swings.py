"""The fast moves of a wrist: strokes, throws, punches. Pure."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from mocapd.types import Floats
from mocapd_analysis.differentiator import peak
from mocapd_analysis.session import Flags, Session, segments_of

LEAST_SPEED_M_S = 1.5
LEAST_SHARE = 0.5  # of the session's fastest
APART_S = 0.25
# Above half of its peak: what is shorter in time or way is a jerk of the tracker. A punch has 0.10 s and 0.4 m there.
LEAST_DURATION_S = 0.07
LEAST_WAY_M = 0.15

Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Swing:
    """One move of one wrist.

    peak_m_s at at_s; start_s, end_s: where it has half that speed (or the run of frames ends), and start_m, end_m: where the
    wrist is then in the world [m]; way_m: how far it went meanwhile.
    """

    side: str
    at_s: float
    peak_m_s: float
    start_s: float
    end_s: float
    start_m: Place
    end_m: Place
    way_m: float


def swings_of(
    session: Session,
    side: str,
    speed_m_s: Floats,
    seen: Flags,
) -> tuple[Swing, ...]:
    """The swings of one wrist in order of time, from its speed (F,). A frame without the wrist parts none: the speed
    goes on from the frame before to the frame after; a longer gap does."""
    known = np.flatnonzero(seen & np.isfinite(speed_m_s))
    if len(known) < 3:
        return ()
    all_s, all_m_s = session.times_s[known], speed_m_s[known]
    way_m = session.positions_m(f"{side}Hand")[known]
    least = max(LEAST_SPEED_M_S, LEAST_SHARE * float(all_m_s.max()))
    found: list[Swing] = []
    for run in segments_of(all_s):
        times_s, speed = all_s[run], all_m_s[run]
        if len(times_s) < 3:
            continue
        apart = max(1, round(APART_S / float(np.median(np.diff(times_s)))))
        # an end is no top: half of a swing before the hand was lost has none that is known
        tops, _ = find_peaks(speed, height=least, prominence=0.3 * least, distance=apart)
        found += [_swing(side, times_s, speed, way_m[run], top) for top in tops.tolist()]
    return tuple(one for one in found if _is_whole(one))


def _is_whole(one: Swing) -> bool:
    return one.end_s - one.start_s >= LEAST_DURATION_S and one.way_m >= LEAST_WAY_M


def _swing(side: str, times_s: Floats, speed: Floats, way_m: Floats, top: int) -> Swing:
    at_s, value = peak(times_s, speed, top)
    slow = np.flatnonzero(speed < 0.5 * value)
    before, after = slow[slow < top], slow[slow > top]
    start_s = (
        _crossing_s(times_s, speed, int(before[-1]), 0.5 * value) if len(before) else times_s[0]
    )
    end_s = (
        _crossing_s(times_s, speed, int(after[0]) - 1, 0.5 * value) if len(after) else times_s[-1]
    )
    inner = (times_s > start_s) & (times_s < end_s)
    at = np.concatenate([[start_s], times_s[inner], [end_s]])
    length_m = float(np.trapezoid(np.interp(at, times_s, speed), at))
    ends = [_at(times_s, way_m, float(when_s)) for when_s in (start_s, end_s)]
    return Swing(side, at_s, value, float(start_s), float(end_s), ends[0], ends[1], length_m)


def _crossing_s(times_s: Floats, speed: Floats, frame: int, level: float) -> float:
    """When the speed passes a level between this frame and the next [s]."""
    a, b = speed[frame], speed[frame + 1]
    share = (level - a) / (b - a) if b != a else 0.0
    return float(times_s[frame] + np.clip(share, 0.0, 1.0) * (times_s[frame + 1] - times_s[frame]))


def _at(times_s: Floats, way_m: Floats, when_s: float) -> Place:
    x, y, z = (float(np.interp(when_s, times_s, way_m[:, axis])) for axis in range(3))
    return x, y, z
