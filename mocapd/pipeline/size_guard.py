"""Keeps pictures from the tracker that do not fit its calibration, as while a setup tries another size."""

import logging
from collections.abc import Mapping

from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.types import Frame

_LOG = logging.getLogger(__name__)


class SizeGuard:
    """Between a hub and whoever works with the frames. A camera of another size takes no part until it
    fits again; the others go on. Each camera's frames come in one thread."""

    def __init__(self, sizes_px: Mapping[str, tuple[int, int]], onwards: TakesFrames) -> None:
        """sizes_px: width and height by camera; one that is not named may have any."""
        self._sizes_px = sizes_px
        self._onwards = onwards
        self._told: set[str] = set()  # of whom it was said that they do not fit

    def put(self, frame: Frame) -> None:
        """Hand in a frame."""
        got_px = frame.pixels.shape[1::-1]
        want_px = self._sizes_px.get(frame.camera, got_px)
        if got_px == want_px:
            self._told.discard(frame.camera)
            self._onwards.put(frame)
        elif frame.camera not in self._told:
            self._told.add(frame.camera)
            _LOG.warning(
                "%s: takes no part: it sends %dx%d, its calibration is for %dx%d",
                *(frame.camera, *got_px, *want_px),
            )
