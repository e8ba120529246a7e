"""Simultaneous pictures of all cameras at the end of a countdown."""

from collections.abc import Iterable
from dataclasses import dataclass

from mocapd.clock import nanoseconds, seconds
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame

_PATIENCE_S = 1.0  # timeout for a camera without a picture after the countdown


@dataclass(frozen=True, slots=True, eq=False)
class StillPictures:
    """The pictures by camera id, and the cameras without one."""

    frames: dict[str, Frame]
    missing: tuple[str, ...]


class Countdown:
    """Counts down from its creation; then takes the newest picture of each camera."""

    def __init__(self, now_ns: int, wait_s: float) -> None:
        self._due_ns = now_ns + nanoseconds(wait_s)

    def left_s(self, now_ns: int) -> float:
        """Seconds until the pictures are due, at least 0."""
        return max(0.0, seconds(self._due_ns - now_ns))

    def take(self, hub: FrameHub, cameras: Iterable[str], now_ns: int) -> StillPictures | None:
        """The pictures after the countdown's end; None while waiting for them."""
        if now_ns < self._due_ns:
            return None
        newest = {name: hub.newest(name) for name in cameras}
        fresh = {
            name: frame
            for name, frame in newest.items()
            if frame is not None and frame.t_ns >= self._due_ns
        }
        if len(fresh) < len(newest) and now_ns < self._due_ns + nanoseconds(_PATIENCE_S):
            return None
        return StillPictures(fresh, tuple(name for name in newest if name not in fresh))
