"""Ends a process within a deadline, even if threads still work or hang."""

import logging
import os
import sys
import threading
import time
from collections.abc import Callable

from mocapd.latch import Latch

_log = logging.getLogger(__name__)


class EndDeadline:
    """After `begin` the process exits in order, or is ended after `within_s` [s].

    A forced end loses nothing: files are written atomically, and the system closes connections.
    """

    def __init__(self, within_s: float, exit_code: Callable[[], int]) -> None:
        self._within_s, self._exit_code = within_s, exit_code
        self._asked = Latch()

    def start(self) -> None:
        """Starts the watching thread. Not in the signal handler, which may interrupt the start of another thread."""
        threading.Thread(target=self._watch, name="end-deadline", daemon=True).start()

    def begin(self) -> None:
        """Starts the deadline; thread-safe and signal-safe."""
        self._asked.set()

    def _watch(self) -> None:
        self._asked.wait(threading.TIMEOUT_MAX)
        time.sleep(self._within_s)
        _log.warning(
            "the orderly end takes longer than %.1f s; what still works is left behind",
            self._within_s,
        )
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(self._exit_code())
