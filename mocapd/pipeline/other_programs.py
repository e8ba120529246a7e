"""Measures the share of the machine's processors that is in use, and the share that other programs use."""

import math
import time
from collections.abc import Callable

import psutil

from mocapd.clock import NS_PER_S


def _read_s() -> tuple[float, float, float]:
    """Processor time since boot [s]: total, busy, and of this process."""
    times = psutil.cpu_times()
    idle_s = times.idle + getattr(times, "iowait", 0.0)
    # guest time is part of user time
    guest_s = getattr(times, "guest", 0.0) + getattr(times, "guest_nice", 0.0)
    total_s = sum(times) - guest_s
    return total_s, total_s - idle_s, time.process_time()


class OtherPrograms:
    """Measured over a second or more. Call `share` at any rate, from one thread.

    busy: share 0..1 of all processors that all programs used when `share` was last measured; NaN before."""

    def __init__(self, read_s: Callable[[], tuple[float, float, float]] = _read_s) -> None:
        self._read_s = read_s
        self._before: tuple[float, float, float] | None = None
        self._at_ns = 0
        self._share = self.busy = math.nan

    def share(self, now_ns: int) -> float:
        """The recent share 0..1 of all processors; NaN within the first second."""
        if self._before is not None and now_ns - self._at_ns < NS_PER_S:
            return self._share
        before, self._before, self._at_ns = self._before, self._read_s(), now_ns
        if before is not None:
            total_s, busy_s, own_s = (b - a for a, b in zip(before, self._before, strict=True))
            if total_s > 0.0:
                self._share = min(1.0, max(0.0, (busy_s - own_s) / total_s))
                self.busy = min(1.0, max(0.0, busy_s / total_s))
        return self._share
