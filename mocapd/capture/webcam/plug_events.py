"""Hears from udev that a camera was plugged in, at the moment when its node has its rights.

Whoever seeks a camera looks for it by itself too, four times a second: where there is no udev (a container, a small
system) nothing is heard, and only that quarter of a second is lost.
"""

import logging
import os
import select
import threading
from collections.abc import Callable
from typing import Any

_log = logging.getLogger(__name__)

_SUBSYSTEM = "video4linux"


class PlugEvents:
    """Calls `heard` in a thread of its own from `start` to `stop`."""

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._thread: threading.Thread | None = None
        self._end_fd = -1  # readable when the thread is to end

    def start(self) -> bool:
        """Whether anything can be heard here."""
        try:
            monitor = _monitor()
        except (ImportError, OSError) as error:  # no libudev; no netlink for this service
            _log.debug("udev tells nothing here (%s): cameras are looked for by turns", error)
            return False
        self._end_fd = os.eventfd(0)
        self._thread = threading.Thread(
            target=self._listen, args=(monitor, self._end_fd), name="udev", daemon=True
        )
        self._thread.start()
        return True

    def stop(self) -> None:
        """Ends its thread; may be called twice, and when nothing can be heard."""
        thread, self._thread = self._thread, None
        if thread is not None:
            os.eventfd_write(self._end_fd, 1)
            thread.join()
            os.close(self._end_fd)

    def _listen(self, monitor: Any, end_fd: int) -> None:
        """monitor: of pyudev, which has no types."""
        while not _waited_for(monitor, end_fd):
            try:
                while (device := monitor.poll(timeout=0)) is not None:
                    if device.action == "add":
                        self._heard()
            except OSError as error:  # more came at once than its buffer takes, maybe a camera
                _log.debug("udev's words were lost (%s): it is listened to anew", error)
                try:
                    monitor = _monitor()
                except OSError:
                    return  # cameras are looked for by turns
                self._heard()


def _monitor() -> Any:
    """Hears of webcams from now on. Raises ImportError or OSError."""
    import pyudev

    monitor = pyudev.Monitor.from_netlink(pyudev.Context(), source="udev")
    monitor.filter_by(_SUBSYSTEM)
    monitor.start()
    return monitor


def _waited_for(monitor: Any, end_fd: int) -> bool:
    """Returns when something is said, or with True when it is over."""
    waiting = select.poll()
    for fd in (monitor.fileno(), end_fd):
        waiting.register(fd, select.POLLIN)
    return any(fd == end_fd for fd, _ in waiting.poll())
