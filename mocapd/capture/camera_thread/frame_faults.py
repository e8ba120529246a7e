"""Detects bad pictures of a live camera: frozen, black, damaged, or of another size."""

from collections import deque

import numpy as np

from mocapd.clock import NS_PER_S
from mocapd.types import Frame

FROZEN_NS = 2 * NS_PER_S  # the sensor's noise alone makes every picture another one
# A video encoder may drop the noise: for an empty room it sends unchanged pictures until the next key frame.
FROZEN_VIDEO_NS = 60 * NS_PER_S
_LEAST_EQUAL = 5  # pictures; decides at low frame rates
_LOOK_NS = NS_PER_S // 2
_BLACK_NS = 2 * NS_PER_S
_BLACK = 16  # of 255: what a covered lens sends, with its noise
_EVERY_PX = 16
_TORN_NS = 10 * NS_PER_S
_TORN_SHARE = 0.05  # one in twenty damaged is a cable, one in ten thousand is the world


class FrameFaults:
    """Detector for one camera; takes every frame in order since its opening. Not thread-safe.

    `notice`: the trouble in words for users, empty without trouble. `frozen`: True if the camera repeats one picture.
    No sensor does that, so the camera must be reopened.
    """

    def __init__(self, size_px: tuple[int, int] | None = None) -> None:
        """size_px: (width, height) of its calibration; None accepts any size."""
        self._size_px = size_px
        self.clear()

    def clear(self) -> None:
        """Resets the detector after a reopening."""
        self.notice = ""
        self.frozen = False
        self._before: Frame | None = None
        self._equal, self._equal_since_ns = 0, 0
        self._black_since_ns: int | None = None
        self._looked_ns = 0
        self._torn: deque[tuple[int, int, int]] = (
            deque()
        )  # time, frames and damaged ones until then
        self._frames = 0

    def add(self, frame: Frame, torn: int, of_source: str = "") -> bool:
        """Takes a frame; returns True if `notice` changed. torn: frames that the source dropped as damaged so far;
        of_source: the source's own notice."""
        self._frames += 1
        self._compare(frame)
        if self._looked_ns and frame.t_ns - self._looked_ns < _LOOK_NS:
            return False
        self._looked_ns = frame.t_ns
        self._look_for_light(frame)
        self._torn.append((frame.t_ns, self._frames, torn))
        while frame.t_ns - self._torn[0][0] > _TORN_NS:
            self._torn.popleft()
        before, self.notice = self.notice, self._notice(frame) or of_source
        return self.notice != before

    def _compare(self, frame: Frame) -> None:
        before, self._before = self._before, frame
        if before is None or not _is_same(before, frame):
            self._equal, self._equal_since_ns = 0, frame.t_ns
            self.frozen = False
            return
        self._equal += 1
        lasted_ns = frame.t_ns - self._equal_since_ns
        limit_ns = FROZEN_NS if frame.encoded is not None else FROZEN_VIDEO_NS
        # a covered lens may send identical black pictures: that is not frozen
        self.frozen = self._equal >= _LEAST_EQUAL and lasted_ns >= limit_ns and not _is_black(frame)

    def _look_for_light(self, frame: Frame) -> None:
        if not _is_black(frame):
            self._black_since_ns = None
        elif self._black_since_ns is None:
            self._black_since_ns = frame.t_ns

    def _notice(self, frame: Frame) -> str:
        size_px = frame.size_px
        if self._size_px is not None and size_px != self._size_px:
            return (
                f"sends {size_px[0]}x{size_px[1]}, its calibration is for {self._size_px[0]}x{self._size_px[1]}: it "
                "takes no part -- set it to that size, or calibrate it again"
            )
        if self._black_since_ns is not None and frame.t_ns - self._black_since_ns >= _BLACK_NS:
            return "its picture is black -- uncover the lens, or switch on the light"
        (_, frames, torn), (_, frames_now, torn_now) = self._torn[0], self._torn[-1]
        damaged, whole = torn_now - torn, frames_now - frames
        if damaged > 2 and damaged > _TORN_SHARE * (damaged + whole):
            return "many of its pictures come damaged -- check its cable and its hub"
        return ""


def _is_black(frame: Frame) -> bool:
    small, by = frame.small(_EVERY_PX)
    every = _EVERY_PX // by
    return bool(small[::every, ::every].max() <= _BLACK)


def _is_same(a: Frame, b: Frame) -> bool:
    if a.encoded is not None and b.encoded is not None:
        return a.encoded == b.encoded
    few = (
        slice(None, None, _EVERY_PX),
        slice(None, None, _EVERY_PX),
    )  # a sparse sample: decides most cases at no cost
    return np.array_equal(a.pixels[few], b.pixels[few]) and np.array_equal(a.pixels, b.pixels)
