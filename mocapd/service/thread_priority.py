"""Threads that watch, beside those that track: of low priority, and whose unexpected end is reported."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

_NICE = 15


def lower_priority() -> None:
    """Lowers the priority of the calling thread only, where the system supports it."""
    with suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)


@contextmanager
def watching(on_death: Callable[[BaseException], None] | None) -> Iterator[None]:
    """For what such a thread does: lowers its priority, and hands an unexpected error to `on_death` before it is raised."""
    lower_priority()
    try:
        yield
    except BaseException as error:
        if on_death is not None:
            on_death(error)
        raise
