"""That the machine has slept: cameras lose their power meanwhile, and their controls with it."""

from collections.abc import Callable

from mocapd.clock import NS_PER_S, seconds, suspended_ns

_LEAST_NS = NS_PER_S // 2  # the two clocks are read one after the other


class SuspensionWatch:
    """Asked now and then whether there was a suspension since. For one thread."""

    def __init__(self, clock: Callable[[], int] = suspended_ns) -> None:
        """clock: how long the machine has slept in all [ns]."""
        self._clock = clock
        self._before_ns = clock()

    def slept_s(self) -> float:
        """How long it slept since this was asked last [s]; 0 when it did not."""
        now_ns = self._clock()
        slept_ns = now_ns - self._before_ns
        if slept_ns < _LEAST_NS:
            return 0.0
        self._before_ns = now_ns
        return seconds(slept_ns)
