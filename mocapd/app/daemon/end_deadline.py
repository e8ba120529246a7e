"""The end of a process within a time, whatever still works or hangs when it is asked to end."""

import logging
import os
import sys
import threading
import time
from collections.abc import Callable

from mocapd.latch import Latch

_log = logging.getLogger(__name__)


class EndDeadline:
    """Once asked to end, the process exits in order by itself, or is ended `within_s` later [s].

    What is left behind then holds nothing that must be written: files are written whole or not at all, and the system closes
    connections.
    """

    def __init__(self, within_s: float, exit_code: Callable[[], int]) -> None:
        self._within_s, self._exit_code = within_s, exit_code
        self._asked = Latch()

    def start(self) -> None:
        """Begin to watch, in a thread: one cannot be started in a signal handler, which may have interrupted such a start."""
        threading.Thread(target=self._watch, name="end-deadline", daemon=True).start()

    def begin(self) -> None:
        """The time runs from now on; from any thread or a signal handler."""
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
