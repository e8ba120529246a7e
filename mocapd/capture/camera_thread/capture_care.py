"""Capture threads looked after while they run: drivers that hang, and a machine that has slept."""

import logging
from collections.abc import Collection

from mocapd.capture.camera_thread.suspension import SuspensionWatch
from mocapd.capture.camera_thread.thread import CaptureThread

_LOG = logging.getLogger(__name__)


class CaptureCare:
    """Of all threads of one owner, for whose one thread it is."""

    def __init__(self, captures: Collection[CaptureThread]) -> None:
        self._captures = captures
        self._suspension = SuspensionWatch()

    def watch(self) -> None:
        """What hangs or has slept is set right; call it about once a second or more often."""
        slept_s = self._suspension.slept_s()
        if slept_s:
            _LOG.info("the machine has slept for %.0f s: every camera is opened again", slept_s)
        for capture in self._captures:
            if slept_s:
                capture.renew(f"the machine has slept for {slept_s:.0f} s")
            capture.watch()
