"""Reports udev's events of new cameras, once their nodes have their permissions.

Without udev (a container, a small system) there are no events; capture threads poll four times a second anyway.
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
    """Calls `heard` at each event, in a thread of its own, from `start` to `stop`."""

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._thread: threading.Thread | None = None
        self._end_fd = -1  # readable when the thread is to end

    def start(self) -> bool:
        """Starts the thread; False without udev."""
        try:
            monitor = _monitor()
        except (ImportError, OSError) as error:  # no libudev; no netlink for this service
            _log.debug("no udev events here (%s): cameras are polled", error)
            return False
        self._end_fd = os.eventfd(0)
        self._thread = threading.Thread(
            target=self._listen, args=(monitor, self._end_fd), name="udev", daemon=True
        )
        self._thread.start()
        return True

    def stop(self) -> None:
        """Ends the thread; idempotent, also without udev."""
        thread, self._thread = self._thread, None
        if thread is not None:
            os.eventfd_write(self._end_fd, 1)
            thread.join()
            os.close(self._end_fd)

    def _listen(self, monitor: Any, end_fd: int) -> None:
        """monitor: of pyudev, which has no types."""
        while not _wait(monitor, end_fd):
            try:
                while (device := monitor.poll(timeout=0)) is not None:
                    if device.action == "add":
                        self._heard()
            except OSError as error:  # its buffer overflowed, an event of a camera may be lost
                _log.debug("udev events were lost (%s): the monitor is restarted", error)
                try:
                    monitor = _monitor()
                except OSError:
                    return  # cameras are polled
                self._heard()


def _monitor() -> Any:
    """Starts a monitor of webcam events. Raises ImportError or OSError."""
    import pyudev

    monitor = pyudev.Monitor.from_netlink(pyudev.Context(), source="udev")
    monitor.filter_by(_SUBSYSTEM)
    monitor.start()
    return monitor


def _wait(monitor: Any, end_fd: int) -> bool:
    """Waits for an event; True when the thread is to end."""
    waiting = select.poll()
    for fd in (monitor.fileno(), end_fd):
        waiting.register(fd, select.POLLIN)
    return any(fd == end_fd for fd, _ in waiting.poll())
