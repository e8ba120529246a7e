"""When recorded frames are due: at their own pace on the live clock, or as fast as they are read."""

import threading

from mocapd.clock import monotonic_ns


class Pace:
    """The common start of recordings that belong together; shared by their sources, from any thread.

    Live: recording time 0 is the moment the first source asks, so that cameras that open a little
    later join in the middle and stay in step. Offline: recording time 0 is 0 and nothing waits.
    """

    def __init__(self, live: bool) -> None:
        self.live = live
        self._lock = threading.Lock()
        self._start_ns: int | None = None if live else 0

    def start_ns(self) -> int:
        """The time of recording time 0 [ns]: CLOCK_MONOTONIC when live, else 0."""
        with self._lock:
            if self._start_ns is None:
                self._start_ns = monotonic_ns()
            return self._start_ns
