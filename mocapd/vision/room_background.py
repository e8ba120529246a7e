"""One camera's background: learned where nobody is, in a new light at once, and what stands before it."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.types import Bytes
from mocapd.vision.background_kernels import changed, learn_background
from mocapd.vision.background_light import relight_background
from mocapd.vision.foreground_kernels import BEFORE, UNKNOWN, stands_before

_PHASES = 4  # the background changes slowly: every fourth row is looked at each time
_SPECK = np.ones((2, 2), np.uint8)  # what is smaller is noise
_GAP = np.ones((5, 5), np.uint8)  # what is narrower is a part of the body that looks like its background


@dataclass(frozen=True, slots=True)
class BackgroundParams:
    """When a background counts as known, and what differs from it."""

    first_looks: int = 20  # in which every row is looked at
    known_looks: int = 6  # at a place
    tolerance: float = 16.0  # of a channel, 0..255: three times the noise of a dim picture
    darkest: float = 0.5  # of a shadow, against what it falls on
    tint: float = 0.1  # by how much its channels may be darkened unlike
    rate: float = 0.04  # share of a look, once it is known
    lamp_tolerance: float = 0.12  # of a channel, 0..1: what differs by more is in another light
    lamp_share: float = 0.15  # of the background that changes at once when a lamp does


class RoomBackground:
    """Mean and age of each pixel of one camera's work pictures; the only state is theirs."""

    def __init__(self, height: int, width: int, params: BackgroundParams) -> None:
        self._params = params
        self._mean = np.zeros((height, width, 3), np.float32)
        self._age = np.zeros((height, width), np.uint8)
        self._before = np.zeros((height, width), np.uint8)
        self.reset()

    def reset(self) -> None:
        """Nothing is known."""
        self._mean[:] = 0.0
        self._age[:] = 0
        self._looks = 0

    @property
    def is_new(self) -> bool:
        """Whether too little was seen yet to tell who stands before it."""
        return self._looks < self._params.first_looks

    def seed(self, picture: Bytes, body: Bytes) -> None:
        """Take a picture (h,w,3) for the background where `body` (h,w) is 0, as when a body is handed over."""
        beside = body == 0
        self._mean[beside] = picture[beside]
        self._age[beside] = self._params.known_looks
        self._looks = self._params.first_looks

    def follow_light(self, picture: Bytes, body: Bytes) -> bool:
        """Whether a lamp went on or off: then the background is taken in its new light. body (h,w): not 0 where
        somebody is expected."""
        p = self._params
        share = changed(picture, body, self._mean, self._age, p.lamp_tolerance)
        if share <= p.lamp_share:
            return False
        relight_background(picture, body, self._mean, self._age)
        return True

    def learn(self, picture: Bytes, body: Bytes) -> None:
        """Follow the background where `body` (h,w) is 0."""
        if self.is_new:
            phases: Sequence[int] = range(_PHASES)
        else:
            phases = (self._looks % _PHASES,)
        for phase in phases:
            learn_background(picture, body, self._mean, self._age, self._params.rate, phase, _PHASES)
        self._looks += 1

    def before(self, picture: Bytes) -> Bytes:
        """(h,w) of a picture (h,w,3): BEFORE, UNKNOWN or BACKGROUND, without specks and narrow gaps."""
        p, out = self._params, self._before
        stands_before(
            picture, self._mean, self._age, p.known_looks, p.tolerance, p.darkest, p.tint, out
        )
        unknown = out == UNKNOWN
        one = (out == BEFORE).astype(np.uint8)
        one = np.asarray(cv2.morphologyEx(one, cv2.MORPH_OPEN, _SPECK), np.uint8)
        one = np.asarray(cv2.morphologyEx(one, cv2.MORPH_CLOSE, _GAP), np.uint8)
        one[unknown] = UNKNOWN
        return one
