"""Drops pictures of another size than the tracker's calibration, as while a setup tries another size."""

from collections.abc import Mapping

from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.types import Frame


class SizeGuard:
    """Between a hub and a subscriber. Drops a camera's frames while their size differs, and logs it in the capture
    thread; the other cameras continue."""

    def __init__(self, sizes_px: Mapping[str, tuple[int, int]], onwards: TakesFrames) -> None:
        """sizes_px: width and height by camera; other cameras may have any size."""
        self._sizes_px = sizes_px
        self._onwards = onwards

    def put(self, frame: Frame) -> None:
        """Pass a frame on, or drop it."""
        got_px = frame.size_px
        want_px = self._sizes_px.get(frame.camera, got_px)
        if got_px == want_px:
            self._onwards.put(frame)
