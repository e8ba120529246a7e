"""Detects that the tracker skips a large share of the frame sets, and names the cause and the remedy."""

import math
from collections import deque
from dataclasses import dataclass
from itertools import pairwise

from mocapd.clock import nanoseconds, seconds

OTHERS_SHARE = 0.25  # of the processors, from which other programs count as the cause
_LESS = "lower fps_hz of the cameras, take smaller pictures or fewer cameras"


def remedy(others: float) -> str:
    """Of a machine that is too slow, for display. others: see Slowness."""
    if others >= OTHERS_SHARE:
        return f"close other programs, or {_LESS}"
    return f"{_LESS}, or use a faster machine"


@dataclass(frozen=True, slots=True)
class SlownessParams:
    """window_s: averaging window; fewest: tracked frame sets needed for a verdict, if need be from before the window;
    begin, end: share of skipped frame sets at which the verdict begins and ends (hysteresis)."""

    window_s: float = 6.0
    fewest: int = 4
    begin: float = 0.34
    end: float = 0.2


@dataclass(frozen=True, slots=True)
class Slowness:
    """skipped: share of the frame sets, 0..1; tracked_hz, made_hz: frame sets a second; busy_ms: time a frame set takes,
    median; others: share of the machine's processors that other programs use, NaN where unknown."""

    skipped: float
    tracked_hz: float
    made_hz: float
    busy_ms: float
    others: float = math.nan

    @property
    def what(self) -> str:
        """The verdict and its cause, for display."""
        verdict = (
            f"too slow: {100.0 * self.skipped:.0f} % of the frame sets are skipped "
            f"({self.tracked_hz:.1f} of {self.made_hz:.0f} a second are tracked)"
        )
        if self.others >= OTHERS_SHARE:
            return f"{verdict}, other programs use {100.0 * self.others:.0f} % of this machine"
        return f"{verdict}, a frame set takes {self.busy_ms:.0f} ms"

    @property
    def fix(self) -> str:
        """The remedy, for display."""
        return remedy(self.others)


class SlownessWatch:
    """Judges the last seconds after each frame set, with times from the caller: it needs no clock."""

    def __init__(self) -> None:
        self._params = SlownessParams()
        self._sets: deque[tuple[int, int, int]] = deque()  # end [ns], number, busy [ns]
        self._is_slow = False

    def update(self, number: int, busy_ns: int, now_ns: int, others: float) -> Slowness | None:
        """The verdict after the number-th frame set, which took busy_ns until now_ns; None: it keeps up. others: see
        Slowness."""
        p, sets = self._params, self._sets
        sets.append((now_ns, number, busy_ns))
        while len(sets) > p.fewest and now_ns - sets[0][0] > nanoseconds(p.window_s):
            sets.popleft()
        if len(sets) < p.fewest:
            return None
        gaps = [later[1] - before[1] for before, later in pairwise(sets)]
        # without the longest gap: a single pause, such as for compiling a kernel, is no slow machine
        made, tracked = sum(gaps) - max(gaps), len(gaps) - 1
        skipped = 1.0 - tracked / max(made, tracked)
        self._is_slow = skipped > (p.end if self._is_slow else p.begin)
        if not self._is_slow:
            return None
        span_s = max(seconds(now_ns - sets[0][0]), 1e-3)
        busy_ms = sorted(busy for _, _, busy in sets)[len(sets) // 2] / 1e6
        return Slowness(skipped, len(gaps) / span_s, sum(gaps) / span_s, busy_ms, others)
