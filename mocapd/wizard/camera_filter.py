"""Passes the frames of some cameras to a collector, if others are open, too."""

from dataclasses import dataclass

from mocapd.pipeline.collector import FrameCollector
from mocapd.types import Frame


@dataclass(frozen=True, slots=True, eq=False)
class CameraFilter:
    """A subscriber of a hub that passes on the frames of `names` only."""

    collector: FrameCollector
    names: frozenset[str]

    def put(self, frame: Frame) -> None:
        """A frame of any camera."""
        if frame.camera in self.names:
            self.collector.put(frame)
