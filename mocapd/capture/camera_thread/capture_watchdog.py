"""Watchdog of running capture threads: handles hanging drivers and suspension of the machine."""

import logging
from collections.abc import Collection

from mocapd.capture.camera_thread.suspension import SuspensionWatch
from mocapd.capture.camera_thread.thread import CaptureThread

_LOG = logging.getLogger(__name__)


class CaptureWatchdog:
    """Watches all capture threads of one owner. Not thread-safe."""

    def __init__(self, captures: Collection[CaptureThread]) -> None:
        self._captures = captures
        self._suspension = SuspensionWatch()

    def watch(self) -> None:
        """Replaces hanging threads; reopens all cameras after a suspension. Call at least once a second."""
        slept_s = self._suspension.slept_s()
        if slept_s:
            _LOG.info("the machine has slept for %.0f s: every camera is opened again", slept_s)
        for capture in self._captures:
            if slept_s:
                capture.renew(f"the machine has slept for {slept_s:.0f} s")
            capture.watch()
