"""Detects that a person-sized region has moved for seconds while no person is found."""

from collections.abc import Mapping

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.tracking.base import LostReason
from mocapd.tracking.cues.clothes.clothes_params import MotionMonitorParams
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import BEFORE


class MotionMonitor:
    """Compares the foreground masks of successive searches."""

    def __init__(self, params: MotionMonitorParams) -> None:
        self._params = params
        self.reset()

    def reset(self) -> None:
        """A person is found, or no picture has come yet."""
        self._last: Mapping[int, Bytes] = {}
        self._since_ns: int | None = None  # when it began to move
        self._moved_ns = 0  # when it moved last

    def update(self, t_ns: int, foreground: Mapping[int, Bytes]) -> None:
        """The foreground (h,w), labelled as `stands_before` does, of each camera by its index, at a frame set's time."""
        p = self._params
        now = {i: (before == BEFORE) for i, before in foreground.items()}
        moving = sum(self._moves(i, mask) for i, mask in now.items())
        self._last = now
        if self._since_ns is not None and t_ns - self._moved_ns > nanoseconds(p.rest_s):
            self._since_ns = None
        if moving >= min(p.cameras, len(now)) > 0:
            self._since_ns = t_ns if self._since_ns is None else self._since_ns
            self._moved_ns = t_ns

    def reason(self, t_ns: int) -> LostReason | None:
        """Why no person is tracked; None if nothing moves, or not for long."""
        p, since_ns = self._params, self._since_ns
        if since_ns is None or t_ns - self._moved_ns > nanoseconds(p.rest_s):
            return None
        lasted = self._moved_ns - since_ns >= nanoseconds(p.lasts_s)
        return LostReason.UNRECOGNISED if lasted else None

    def _moves(self, camera: int, mask: Bytes) -> bool:
        last, p = self._last.get(camera), self._params
        area = np.count_nonzero(mask)
        if last is None or not p.least_px <= area <= p.most_share * mask.size:
            return False
        return bool(np.count_nonzero(mask != last) >= max(p.moved_px, p.moved_share * area))
