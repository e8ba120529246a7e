"""Buffers the last few frames of every camera, for picking simultaneous ones."""

import threading
from collections import deque

from mocapd.types import Frame

_KEPT = 4
_STOPPED_NS = 700_000_000  # behind the newest of all: the camera has stopped


class RecentFrames:
    """Takes frames in the capture threads; queried in the wizard's."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the frames
        self._frames: dict[str, deque[Frame]] = {}

    def put(self, frame: Frame) -> None:
        """A frame of any camera."""
        with self._lock:
            self._frames.setdefault(frame.camera, deque(maxlen=_KEPT)).append(frame)

    def together(self) -> dict[str, Frame]:
        """By camera the frame nearest to the newest instant that all cameras have reached.

        Of cameras of equal rate they are at most half a period apart. One that has stopped is absent.
        """
        with self._lock:
            recent = {name: list(frames) for name, frames in self._frames.items()}
        if not recent:
            return {}
        newest_ns = max(frames[-1].t_ns for frames in recent.values())
        live = {
            name: frames
            for name, frames in recent.items()
            if newest_ns - frames[-1].t_ns <= _STOPPED_NS
        }
        instant_ns = min(frames[-1].t_ns for frames in live.values())
        return {
            name: min(frames, key=lambda frame: abs(frame.t_ns - instant_ns))
            for name, frames in live.items()
        }
