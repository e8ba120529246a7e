"""Starts from the shirt: searches all pictures for its patches and looks them up in the pose database."""

from mocapd.tracking.cues.shirt.shirt_locator import ShirtLocator
from mocapd.tracking.initialisers.base import InitialPose
from mocapd.tracking.track_state import BodyShapeEstimate
from mocapd.types import FrameSet


class ShirtPose:
    """See Initialiser."""

    name = "shirt_pose"

    def __init__(self, locator: ShirtLocator) -> None:
        self._locator = locator

    def find(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        frames: FrameSet,
        frame_index: int,
        /,
    ) -> InitialPose | None:
        """See Initialiser."""
        trunk = self._locator.search(wearer, present, frames.t_ns, frame_index)
        return (
            None if trunk is None else InitialPose(self._locator.upright_body(trunk, wearer), trunk)
        )
