"""Keeps pictures from the tracker that do not fit its calibration, as while a setup tries another size."""

from collections.abc import Mapping

from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.types import Frame


class SizeGuard:
    """Between a hub and whoever works with the frames. A camera of another size takes no part until it
    fits again; the others go on. Its capture thread tells of it."""

    def __init__(self, sizes_px: Mapping[str, tuple[int, int]], onwards: TakesFrames) -> None:
        """sizes_px: width and height by camera; one that is not named may have any."""
        self._sizes_px = sizes_px
        self._onwards = onwards

    def put(self, frame: Frame) -> None:
        """Hand in a frame."""
        got_px = frame.pixels.shape[1::-1]
        want_px = self._sizes_px.get(frame.camera, got_px)
        if got_px == want_px:
            self._onwards.put(frame)
