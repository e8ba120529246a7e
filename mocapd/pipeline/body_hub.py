"""Holds the newest body for readers and passes every body to subscribers. Counterpart of `frame_hub`."""

import threading
from dataclasses import dataclass
from typing import Protocol

from mocapd.tracking.base import Track
from mocapd.types import BodyState, FrameSet, Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class BodySample:
    """The pipeline's result at one instant.

    track: of the tracker, its body smoothed and, without frames, faded; skeleton: of its pose; frames: its frame set,
    empty while no camera delivers.
    """

    track: Track
    skeleton: Skeleton
    frames: FrameSet

    @property
    def body(self) -> BodyState:
        """The person, ready to be sent."""
        return self.track.body


class TakesBodies(Protocol):
    """A subscriber; `put` never blocks."""

    def put(self, sample: BodySample, /) -> None: ...


class BodyHub:
    """Receives the bodies of successive pipelines. Holds a reference to the newest, no copy.

    Safe from any threads. A subscriber gets every body from `join` on, in the pipeline's thread.
    """

    def __init__(self, *onwards: TakesBodies) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._newest: BodySample | None = None
        self._onwards: tuple[TakesBodies, ...] = onwards

    def put(self, sample: BodySample) -> None:
        """Add a body."""
        with self._lock:
            self._newest = sample
            onwards = self._onwards
        for taker in onwards:
            taker.put(sample)

    def newest(self) -> BodySample | None:
        """The newest body; None before the first, and after `forget` until the next."""
        with self._lock:
            return self._newest

    def forget(self) -> None:
        """Drop the newest body, because its pipeline has ended."""
        with self._lock:
            self._newest = None

    def join(self, taker: TakesBodies) -> None:
        """Add a subscriber."""
        with self._lock:
            self._onwards = (*self._onwards, taker)

    def leave(self, taker: TakesBodies) -> None:
        """Remove a subscriber, if it is one."""
        with self._lock:
            self._onwards = tuple(other for other in self._onwards if other is not taker)
