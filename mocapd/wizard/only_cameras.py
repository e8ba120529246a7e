"""Filters the frames of some cameras for a collector; others may be open, too."""

from dataclasses import dataclass

from mocapd.pipeline.collector import FrameCollector
from mocapd.types import Frame


@dataclass(frozen=True, slots=True, eq=False)
class OnlyCameras:
    """Subscribes to a hub in the collector's place."""

    collector: FrameCollector
    names: frozenset[str]

    def put(self, frame: Frame) -> None:
        """A frame of any camera."""
        if frame.camera in self.names:
            self.collector.put(frame)
