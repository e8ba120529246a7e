"""Controls the tracker's effort by its load: less when frame sets come faster than they are tracked, more when idle.

It lowers the effort quickly, because skipped frame sets are lost. It raises the effort slowly, and after a failed
attempt with exponential backoff, because a slow machine mostly stays slow.
"""

import math
from dataclasses import dataclass

from mocapd.clock import seconds
from mocapd.tracking.effort import Effort

_ORDER = (Effort.FULL, Effort.SAVING, Effort.LEAST)
_LONGEST_PERIOD_S = 0.5  # a longer time between frame sets is a pause, not a rate


@dataclass(frozen=True, slots=True)
class EffortControlParams:
    """Thresholds of the control. Load: the time that a frame set takes, relative to the interval of frame sets.

    late_load: above it the machine is late; it is also late if more than `skipping` of the frame sets are followed by a
    skipped one at skip_load or more (below, the cause is elsewhere). After fall_s of that the effort falls.
    room_load: with a mean load below it the effort rises after rise_s. A step of effort costs a quarter more time: this
    leads to just below late_load. A rise that makes the machine late within fails_s has failed: the next attempt is
    after retry_s, doubled at each failure up to most_retry_s.
    smooth_s, mean_s, skips_s: averaging times of load, of mean load and of skips; hiccup: largest load counted for one
    frame set.
    """

    late_load: float = 0.92
    skipping: float = 0.05
    skip_load: float = 0.6
    fall_s: float = 0.75
    room_load: float = 0.72
    rise_s: float = 5.0
    fails_s: float = 20.0
    retry_s: float = 60.0
    most_retry_s: float = 960.0
    smooth_s: float = 0.5
    mean_s: float = 2.5
    skips_s: float = 2.0
    hiccup: float = 2.5


class EffortControl:
    """Gets every tracked frame set, with times from the caller: it needs no clock."""

    def __init__(self) -> None:
        self._params = p = EffortControlParams()
        self.effort = Effort.FULL
        self._period_s: float | None = None
        self._last: tuple[int, int] | None = None  # the last set's capture time [ns], and number
        self._wait_s = p.rise_s  # time below room_load before a rise
        self._rose_ns: int | None = (
            None  # time of the last rise, until it has proved right or failed
        )
        self._restart()

    def _restart(self) -> None:
        """Reset the load estimate after a change of effort."""
        p = self._params
        self._load, self._mean_load = 0.5 * (p.room_load + p.late_load), p.room_load
        self._skips = 0.0
        self._late_since_ns: int | None = None
        self._room_since_ns: int | None = None

    def update(self, t_ns: int, number: int, busy_ns: int, now_ns: int) -> Effort:
        """The effort for the next frame set. t_ns, number: capture time and number of the last one; busy_ns: its tracking
        time, which ended at now_ns."""
        last, self._last = self._last, (t_ns, number)
        if last is None or number <= last[1]:
            return self.effort
        sets = number - last[1]
        gap_s = seconds(t_ns - last[0]) / sets
        if not 0.0 < gap_s <= _LONGEST_PERIOD_S:
            self._late_since_ns = self._room_since_ns = None
            return self.effort
        self._measure(gap_s, sets > 1, seconds(busy_ns))
        self._decide(now_ns)
        return self.effort

    def _measure(self, gap_s: float, skipped: bool, busy_s: float) -> None:
        p = self._params
        before_s = gap_s if self._period_s is None else self._period_s
        share = _share(gap_s, p.smooth_s)
        self._period_s = before_s + share * (gap_s - before_s)
        load = min(busy_s / self._period_s, p.hiccup)
        self._load += share * (load - self._load)
        self._mean_load += _share(gap_s, p.mean_s) * (load - self._mean_load)
        self._skips += _share(gap_s, p.skips_s) * (float(skipped) - self._skips)

    def _decide(self, now_ns: int) -> None:
        p, at = self._params, _ORDER.index(self.effort)
        skips = self._skips > p.skipping and self._load >= p.skip_load
        is_late, has_room = self._load > p.late_load or skips, self._mean_load < p.room_load
        self._late_since_ns = _since(self._late_since_ns, is_late, now_ns)
        self._room_since_ns = _since(self._room_since_ns, has_room and not skips, now_ns)
        if _lasted_s(self._rose_ns, now_ns) > p.fails_s:
            self._rose_ns = None
            self._wait_s = p.rise_s
        if at + 1 < len(_ORDER) and _lasted_s(self._late_since_ns, now_ns) >= p.fall_s:
            if self._rose_ns is not None:
                self._wait_s = min(max(2.0 * self._wait_s, p.retry_s), p.most_retry_s)
                self._rose_ns = None
            self._change(_ORDER[at + 1])
        elif at > 0 and _lasted_s(self._room_since_ns, now_ns) >= self._wait_s:
            self._rose_ns = now_ns
            self._change(_ORDER[at - 1])

    def _change(self, effort: Effort) -> None:
        self.effort = effort
        self._restart()


def _share(gap_s: float, over_s: float) -> float:
    """Weight of the newest value in an average over so long."""
    return 1.0 - math.exp(-gap_s / over_s)


def _since(before_ns: int | None, holds: bool, now_ns: int) -> int | None:
    """Start of the time that a condition has held without a break; None while it does not hold."""
    if not holds:
        return None
    return now_ns if before_ns is None else before_ns


def _lasted_s(since_ns: int | None, now_ns: int) -> float:
    """Time that a condition has held [s]; 0 while it does not hold."""
    return 0.0 if since_ns is None else seconds(now_ns - since_ns)
