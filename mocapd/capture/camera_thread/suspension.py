"""Detects suspension of the machine: cameras lose their power then, and with it their controls."""

from collections.abc import Callable

from mocapd.clock import NS_PER_S, seconds, suspended_ns

_LEAST_NS = NS_PER_S // 2  # the two clocks are read one after the other


class SuspensionWatch:
    """Polled for suspensions. Not thread-safe."""

    def __init__(self, clock: Callable[[], int] = suspended_ns) -> None:
        """clock: total time that the machine was suspended [ns]."""
        self._clock = clock
        self._before_ns = clock()

    def slept_s(self) -> float:
        """Time suspended since the last call [s]; 0 without a suspension."""
        now_ns = self._clock()
        slept_ns = now_ns - self._before_ns
        if slept_ns < _LEAST_NS:
            return 0.0
        self._before_ns = now_ns
        return seconds(slept_ns)
