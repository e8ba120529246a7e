"""The interface of an initialiser: a way to start a track without a previous pose."""

from dataclasses import dataclass
from typing import Protocol

from mocapd.fit.motion_state import MotionState
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate
from mocapd.tracking.cues.shirt.shirt_cue import ShirtEstimate
from mocapd.tracking.track_state import BodyShapeEstimate
from mocapd.types import FrameSet


@dataclass(frozen=True, slots=True, eq=False)
class InitialPose:
    """A whole body to start a track, with each cue's estimate."""

    body: MotionState
    trunk: ShirtEstimate | None = None
    whole: ClothesEstimate | None = None


class Initialiser(Protocol):
    """Runs in each frame set while no person is tracked; may keep state between calls."""

    name: str

    def find(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        frames: FrameSet,
        frame_index: int,
        /,
    ) -> InitialPose | None:
        """A person in this frame set. present: each present camera's time offset [s], by index; frame_index: see `Ticks`."""
        ...
