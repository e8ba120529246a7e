"""A tracker stepped as a loop steps it: the shape of each track goes into the next step."""

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.tracking.base import Track, Tracker
from mocapd.types import BodyState, FrameSet, Skeleton


class Stepping:
    """Owns the wearer's shape, which `reset` puts back to what it was."""

    def __init__(self, tracker: Tracker, shape: BodyShape) -> None:
        self.tracker, self.name = tracker, tracker.name
        self._first = self.shape = shape

    @property
    def skeleton(self) -> Skeleton:
        """The wearer's as known now."""
        return skeleton_of(self.shape)

    def reset(self, near: BodyState | None = None) -> None:
        """As before the first step."""
        self.tracker.reset(near)
        self.shape = self._first

    def step(self, frames: FrameSet) -> Track:
        """One step."""
        track = self.tracker.step(frames, self.shape)
        self.shape = track.shape
        return track
