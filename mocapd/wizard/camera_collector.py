"""Collects the frames of some cameras of a hub, if others are open, too."""

from collections.abc import Sequence

from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame


class CameraCollector(FrameCollector):
    """A subscriber of a hub that collects the frames of `names` only."""

    def __init__(self, hub: FrameHub, names: Sequence[str]) -> None:
        super().__init__(names, hub.bundler)
        self._names = frozenset(names)

    def put(self, frame: Frame) -> None:
        if frame.camera in self._names:
            super().put(frame)
