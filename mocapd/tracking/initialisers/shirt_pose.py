"""Somebody in the shirt, by the pose database: its patches are looked for in all of the pictures."""

from mocapd.tracking.cues.shirt.shirt_watch import ShirtWatch
from mocapd.tracking.initialisers.base import Begun
from mocapd.tracking.track_state import Proportions
from mocapd.types import FrameSet


class ShirtPose:
    """See Initialiser."""

    name = "shirt_pose"

    def __init__(self, watch: ShirtWatch) -> None:
        self._watch = watch

    def find(
        self, wearer: Proportions, present: dict[int, float], frames: FrameSet, turn: int, /
    ) -> Begun | None:
        """See Initialiser."""
        trunk = self._watch.search(wearer, present, frames.t_ns, turn)
        return None if trunk is None else Begun(self._watch.standing(trunk, wearer), trunk)
