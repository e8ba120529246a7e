"""The newest body, for whoever looks; bodies go on to who works with them. Twin of `frame_hub`."""

import threading
from dataclasses import dataclass
from typing import Protocol

from mocapd.tracking.base import Track
from mocapd.types import BodyState, FrameSet, Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class BodySample:
    """A person at one instant as a pipeline leaves it.

    track: of the tracker, its body smoothed and, without frames, faded; skeleton: what that pose is of;
    frames: what it was seen in, none of them where it is told by the clock alone.
    """

    track: Track
    skeleton: Skeleton
    frames: FrameSet

    @property
    def body(self) -> BodyState:
        """The person, ready to be sent."""
        return self.track.body


class TakesBodies(Protocol):
    """Where bodies go on to; `put` never blocks."""

    def put(self, sample: BodySample, /) -> None: ...


class BodyHub:
    """What pipelines put bodies in, one pipeline after another. Keeps a reference to the newest, no copy.

    Safe from any threads. Whoever joins gets every body from then on, in the pipeline's thread.
    """

    def __init__(self, *onwards: TakesBodies) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._newest: BodySample | None = None
        self._onwards: tuple[TakesBodies, ...] = onwards

    def put(self, sample: BodySample) -> None:
        """Hand in a body."""
        with self._lock:
            self._newest = sample
            onwards = self._onwards
        for one in onwards:
            one.put(sample)

    def newest(self) -> BodySample | None:
        """The newest body; None before the first, and after `forget` until another comes."""
        with self._lock:
            return self._newest

    def forget(self) -> None:
        """What put bodies in has ended, and the newest no longer holds."""
        with self._lock:
            self._newest = None

    def join(self, taker: TakesBodies) -> None:
        """From now on this one gets every body too."""
        with self._lock:
            self._onwards = (*self._onwards, taker)

    def leave(self, taker: TakesBodies) -> None:
        """No more bodies for this one; nothing happens when it never joined."""
        with self._lock:
            self._onwards = tuple(one for one in self._onwards if one is not taker)
