"""The newest body that a setup tracks, for who shows it."""

from dataclasses import dataclass

from mocapd.pipeline.loop import PipelineLoop
from mocapd.types import BodyState, FrameSet, Skeleton


@dataclass(slots=True, eq=False)
class NewestBody:
    """Written by the pipeline's thread, read by any: a reference is replaced whole.

    `loop`: the pipeline that writes; both are None while nothing tracks.
    """

    body: tuple[BodyState, Skeleton] | None = None
    loop: PipelineLoop | None = None

    def publish(self, body: BodyState, skeleton: Skeleton, _frames: FrameSet) -> None:
        """As a pipeline calls it."""
        self.body = body, skeleton

    def forget(self) -> None:
        """Nothing tracks any more."""
        self.body = self.loop = None
