"""The time of frame sets in ticks of 1/30 s, by which work is scheduled that is not done in every one.

At 30 Hz, also with some jitter, each frame set is one tick. At 15 Hz two pass with each, and at 60 Hz one with every second,
so that what is due every third of a second is so at any rate, and after frames that were skipped.
"""

from dataclasses import dataclass

from mocapd.clock import seconds
from mocapd.fit.fit_params import TICK_S

_JITTER = 0.15  # of a tick: by so much a frame set may be off without shifting the ticks after it


@dataclass(frozen=True, slots=True)
class Ticks:
    """The ticks first ... last that passed with a frame set, counted from 1; none where `first` is greater.

    turn: counts the frame sets with which one passed, for kinds of work that alternate: each gets its turn at any rate.
    """

    first: int
    last: int
    turn: int

    @property
    def count(self) -> int:
        """How many passed."""
        return self.last - self.first + 1

    def due(self, every_s: float, at_s: float = 0.0) -> bool:
        """Whether work falls due that is done every so many seconds, at_s after their multiples; in whole ticks."""
        every, at = round(every_s / TICK_S), round(at_s / TICK_S)
        return (self.last - at) // every > (self.first - 1 - at) // every

    def alternates(self, kinds: int, kind: int) -> bool:
        """Whether it is the turn of this one of so many kinds of work."""
        return self.count > 0 and self.turn % kinds == kind


class TickClock:
    """Counts ticks by the times of frame sets; now: those of the newest."""

    def __init__(self) -> None:
        self.now = Ticks(1, 0, 0)
        self._t_ns: int | None = None
        self._over = 0.0  # of a tick, that passed since the last one

    def pass_to(self, t_ns: int) -> Ticks:
        """The ticks of a frame set of this time."""
        passed = 1.0 if self._t_ns is None else seconds(t_ns - self._t_ns) / TICK_S + self._over
        count = round(passed)
        self._t_ns, self._over = t_ns, passed - count
        if abs(self._over) <= _JITTER:
            self._over = 0.0
        last = self.now.last
        self.now = Ticks(last + 1, last + count, self.now.turn + (count > 0))
        return self.now
