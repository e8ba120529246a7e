"""Somebody in any clothes, who stands, sits or crouches before the background; see `person_search`."""

from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.initialisers.base import Begun
from mocapd.tracking.track_state import Proportions
from mocapd.types import FrameSet


class PersonBeforeBackground:
    """See Initialiser."""

    name = "person_before_background"

    def __init__(self, clothes: ClothesCue) -> None:
        self._clothes = clothes

    def find(
        self, wearer: Proportions, _present: dict[int, float], frames: FrameSet, _turn: int, /
    ) -> Begun | None:
        """See Initialiser."""
        whole = self._clothes.search(wearer, frames.t_ns)
        return None if whole is None else Begun(whole.motion, None, whole)
