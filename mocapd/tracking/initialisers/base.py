"""What an initialiser is: a way to find somebody of whom the tracker knows nothing."""

from dataclasses import dataclass
from typing import Protocol

from mocapd.fit.motion_state import MotionState
from mocapd.tracking.cues.clothes.clothes_fits import ClothesFound
from mocapd.tracking.cues.shirt.shirt_cue import ShirtFound
from mocapd.tracking.track_state import Proportions
from mocapd.types import FrameSet


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """Somebody who was found: the whole body, and what each cue saw of it."""

    body: MotionState
    trunk: ShirtFound | None = None
    whole: ClothesFound | None = None


class Initialiser(Protocol):
    """Asked in each frame set while nobody is tracked; may remember what it saw in those before."""

    name: str

    def find(
        self, wearer: Proportions, present: dict[int, float], frames: FrameSet, turn: int, /
    ) -> Begun | None:
        """Somebody in this frame set. present: each seeing camera's own time after it [s], by index; turn: see `Ticks`."""
        ...
