"""The priority of threads that watch, beside those that track."""

import os
import threading
from contextlib import suppress

_NICE = 15


def lower_priority() -> None:
    """Lowers the priority of the calling thread only, where the system supports it."""
    with suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)
