"""Hears from udev that a camera was plugged in, at the moment when its node has its rights.

Whoever seeks a camera looks for it by itself too, four times a second: where there is no udev (a container, a small
system) nothing is heard, and only that quarter of a second is lost.
"""

import logging
from collections.abc import Callable
from typing import Any

_log = logging.getLogger(__name__)

_SUBSYSTEM = "video4linux"


class PlugEvents:
    """Calls `heard` in a thread of its own from `start` to `stop`."""

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._observer: Any = None  # pyudev has no types

    def start(self) -> bool:
        """Whether anything can be heard here."""
        try:
            import pyudev

            monitor = pyudev.Monitor.from_netlink(pyudev.Context(), source="udev")
            monitor.filter_by(_SUBSYSTEM)
        except (ImportError, OSError) as error:  # no libudev; no netlink for this service
            _log.debug("udev tells nothing here (%s): cameras are looked for by turns", error)
            return False
        self._observer = pyudev.MonitorObserver(monitor, callback=self._take, name="udev")
        self._observer.start()
        return True

    def stop(self) -> None:
        """Ends its thread; may be called twice, and when nothing can be heard."""
        observer, self._observer = self._observer, None
        if observer is not None:
            observer.stop()

    def _take(self, device: Any) -> None:
        if device.action == "add":
            self._heard()
