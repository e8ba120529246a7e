"""How much work the tracker does: less where frame sets come faster than they are tracked, more where there is room again.

Quality falls quickly and comes back slowly: frame sets that are skipped are lost, and a machine that is too slow for more
work stays so. An attempt at more that failed is not repeated soon.
"""

import math
from dataclasses import dataclass

from mocapd.clock import seconds
from mocapd.tracking.effort import Effort

_ORDER = (Effort.FULL, Effort.SAVING, Effort.LEAST)
_LONGEST_PERIOD_S = 0.5  # a longer time between frame sets is a pause, not a rate


@dataclass(frozen=True, slots=True)
class EffortControlParams:
    """When the effort changes. Load is the time that a frame set takes, as a share of the time between two.

    late_load: above it the machine is late, or where more than `skipping` of the frame sets are followed by one that was
    skipped, at skip_load or more (below it something else is at fault); for fall_s, and less is done.
    room_load: below it there is room for more work, which is tried after rise_s; more work that is late within fails_s
    has failed: it is tried again after retry_s, twice that after the next failure, most_retry_s at most.
    smooth_s, skips_s: over which load and skipped sets are averaged; hiccup: most load that one frame set counts with.
    """

    late_load: float = 0.92
    skipping: float = 0.05
    skip_load: float = 0.6
    fall_s: float = 0.75
    room_load: float = 0.55
    rise_s: float = 5.0
    fails_s: float = 20.0
    retry_s: float = 60.0
    most_retry_s: float = 960.0
    smooth_s: float = 0.5
    skips_s: float = 2.0
    hiccup: float = 2.5


class EffortControl:
    """Hears of every frame set that was tracked; its times are the caller's, so that it needs no clock."""

    def __init__(self, params: EffortControlParams | None = None) -> None:
        self._params = p = params if params is not None else EffortControlParams()
        self.effort = Effort.FULL
        self._period_s: float | None = None
        self._last: tuple[int, int] | None = None  # the last set's capture time [ns], and number
        self._wait_s = p.rise_s  # how long there must be room before more is tried
        self._rose_ns: int | None = (
            None  # when more was tried, until that has proved right or failed
        )
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Nothing is known of the load at the present effort."""
        p = self._params
        self._load, self._skips = 0.5 * (p.room_load + p.late_load), 0.0
        self._late_since_ns: int | None = None
        self._room_since_ns: int | None = None

    def tracked(self, t_ns: int, number: int, busy_ns: int, now_ns: int) -> Effort:
        """The effort for the next frame set, after one that was taken at t_ns, was the number-th that was made, and took
        busy_ns until now_ns."""
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
        share = 1.0 - math.exp(-gap_s / p.smooth_s)
        self._period_s = before_s + share * (gap_s - before_s)
        load = min(busy_s / self._period_s, p.hiccup)
        self._load += share * (load - self._load)
        self._skips += (1.0 - math.exp(-gap_s / p.skips_s)) * (float(skipped) - self._skips)

    def _decide(self, now_ns: int) -> None:
        p, at = self._params, _ORDER.index(self.effort)
        skips = self._skips > p.skipping and self._load >= p.skip_load
        is_late, has_room = self._load > p.late_load or skips, self._load < p.room_load
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
        self._begin_anew()


def _since(before_ns: int | None, holds: bool, now_ns: int) -> int | None:
    """Since when something has held without a break; None while it does not."""
    if not holds:
        return None
    return now_ns if before_ns is None else before_ns


def _lasted_s(since_ns: int | None, now_ns: int) -> float:
    """How long it has held [s]; 0 where it does not."""
    return 0.0 if since_ns is None else seconds(now_ns - since_ns)
