"""Starts from a person in any clothes in the foreground, upright, sitting or crouching; see `person_search`."""

from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.initialisers.base import InitialPose
from mocapd.tracking.track_state import BodyShapeEstimate
from mocapd.types import FrameSet


class ForegroundPerson:
    """See Initialiser."""

    name = "person_before_background"

    def __init__(self, clothes: ClothesCue) -> None:
        self._clothes = clothes

    def find(
        self,
        wearer: BodyShapeEstimate,
        _present: dict[int, float],
        frames: FrameSet,
        _frame_index: int,
        /,
    ) -> InitialPose | None:
        """See Initialiser."""
        whole = self._clothes.search(wearer, frames.t_ns)
        return None if whole is None else InitialPose(whole.motion, None, whole)
