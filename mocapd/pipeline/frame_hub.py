"""Holds the newest frame of every camera for readers and passes every frame to subscribers."""

import threading
from collections.abc import Iterable
from typing import Protocol

from mocapd.pipeline.bundler import BundlerParams
from mocapd.types import Frame


class TakesFrames(Protocol):
    """A subscriber; `put` never blocks."""

    def put(self, frame: Frame, /) -> None: ...


class FrameHub:
    """The mailbox of capture threads. Holds a reference to each camera's newest frame, no copy.

    Safe from any threads. A subscriber gets every frame from `join` on, in the capture threads; `bundler`:
    the bundler's timeouts for these cameras.
    """

    def __init__(
        self, names: Iterable[str], *onwards: TakesFrames, bundler: BundlerParams | None = None
    ) -> None:
        self.names = tuple(names)
        self.bundler = bundler if bundler is not None else BundlerParams()
        self._lock = threading.Lock()  # guards what follows
        self._newest: dict[str, Frame] = {}
        self._onwards: tuple[TakesFrames, ...] = onwards

    def put(self, frame: Frame) -> None:
        with self._lock:
            self._newest[frame.camera] = frame
            onwards = self._onwards
        for one in onwards:
            one.put(frame)

    def newest(self, camera: str) -> Frame | None:
        """The camera's newest frame; None before its first."""
        with self._lock:
            return self._newest.get(camera)

    def join(self, taker: TakesFrames) -> None:
        """Add a subscriber."""
        with self._lock:
            self._onwards = (*self._onwards, taker)

    def leave(self, taker: TakesFrames) -> None:
        """Remove a subscriber, if it is one."""
        with self._lock:
            self._onwards = tuple(one for one in self._onwards if one is not taker)
