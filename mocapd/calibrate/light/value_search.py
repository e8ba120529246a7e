"""Searches the control value for a wanted reading, where the reading grows with the value."""

import math

_TRIES = 8


class ValueSearch:
    """Bisection by trial: apply `value`, measure, call `report`, until `over`; then `value` is the best one.

    low, high: the control's range; first: its present value; wanted: the target of the reading;
    tolerance: of the reading, relative. Bisects on a logarithmic scale, as exposures work.
    """

    def __init__(self, low: int, high: int, first: int, wanted: float, tolerance: float) -> None:
        self._low, self._high = max(low, 1), max(high, low, 1)
        self._wanted, self._tolerance = wanted, tolerance
        self._left = _TRIES
        self._best = (math.inf, first)
        self.value = min(max(first, self._low), self._high)
        self.over = False

    def report(self, reading: float) -> None:
        """Take the reading at `value`; sets the next value, or the best one at the end."""
        self._left -= 1
        off = math.log(max(reading, 1e-3) / max(self._wanted, 1e-3))
        self._best = min(self._best, (abs(off), self.value))
        if off < 0:
            self._low = min(self.value + 1, self._high)
        else:
            self._high = max(self.value - 1, self._low)
        following = round(math.sqrt(self._low * self._high))
        is_reached = self._best[0] <= math.log1p(self._tolerance)
        if is_reached or self._left <= 0 or following == self.value:
            self.value, self.over = self._best[1], True
        else:
            self.value = following
