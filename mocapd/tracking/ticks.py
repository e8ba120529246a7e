"""The time of frame sets in ticks of 1/30 s, which schedule work that does not run in every frame set.

At 30 Hz, even with some jitter, each frame set is one tick. At 15 Hz two pass with each, at 60 Hz one with every second.
So an interval in seconds holds at any frame rate and after dropped frames.
"""

from collections import deque
from dataclasses import dataclass

from mocapd.clock import seconds
from mocapd.fit.fit_params import TICK_S

_JITTER = 0.15  # of a tick: a smaller timing error does not shift later ticks
_USUAL_OF = 8  # frame sets; some of them follow without a gap, unless most are dropped


@dataclass(frozen=True, slots=True)
class Ticks:
    """The ticks first ... last that passed with a frame set, counted from 1; none if `first` is greater.

    frame_index: counts the frame sets with at least one tick; usual: the ticks of one, where none is dropped.
    """

    first: int
    last: int
    frame_index: int
    usual: int = 1

    @property
    def count(self) -> int:
        """Number of ticks that passed."""
        return self.last - self.first + 1

    def due(self, every_s: float, at_s: float = 0.0) -> bool:
        """True if work with this interval is due, at_s after its multiples; both are rounded to whole ticks."""
        every, at = round(every_s / TICK_S), round(at_s / TICK_S)
        return (self.last - at) // every > (self.first - 1 - at) // every

    def alternates(self, kinds: int, kind: int) -> bool:
        """True if this frame set is for work of index `kind` among `kinds` that alternate from tick to tick. A set of a slow
        camera is for several of them; one after dropped ones is not, since the machine is late already."""
        past = self.frame_index * self.usual - kind
        return self.count > 0 and past // kinds > (past - self.usual) // kinds


class TickClock:
    """Counts ticks from the times of frame sets. now: ticks of the newest one."""

    def __init__(self) -> None:
        self.now = Ticks(1, 0, 0)
        self._t_ns: int | None = None
        self._remainder = 0.0  # time since the last tick [ticks]
        self._counts: deque[int] = deque(maxlen=_USUAL_OF)  # of ticks, with the newest frame sets

    def pass_to(self, t_ns: int) -> Ticks:
        """The ticks of a frame set at this time."""
        passed = (
            1.0 if self._t_ns is None else seconds(t_ns - self._t_ns) / TICK_S + self._remainder
        )
        count = round(passed)
        self._t_ns, self._remainder = t_ns, passed - count
        if abs(self._remainder) <= _JITTER:
            self._remainder = 0.0
        last, index = self.now.last, self.now.frame_index
        if count > 0:
            self._counts.append(count)
            index += 1
        self.now = Ticks(last + 1, last + count, index, min(self._counts, default=1))
        return self.now
