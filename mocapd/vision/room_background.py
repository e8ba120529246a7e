"""One camera's background: learned where nobody is, in a new light at once, and what stands before it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Floats, Singles
from mocapd.vision.background_kernels import changed, learn_background, learn_unknown
from mocapd.vision.background_light import relight_background
from mocapd.vision.foreground_kernels import (
    BACKGROUND,
    label_cleaned,
    stands,
    stands_before,
)
from mocapd.vision.ghost_removal import GhostParams, find_ghosts

_PHASES = 4  # the background changes slowly: every fourth row is looked at each time
_SPECK = np.ones((2, 2), np.uint8)  # what is smaller is noise
_STANDS = stands(np.arange(256, dtype=np.uint8)).astype(np.uint8)  # of each label
_GAP = np.ones(
    (5, 5), np.uint8
)  # what is narrower is a part of the body that looks like its background


@dataclass(frozen=True, slots=True)
class BackgroundParams:
    """When a background counts as known, and what differs from it."""

    first_looks: int = 20  # in which every row is looked at
    known_looks: int = 6  # at a place
    tolerance: float = 16.0  # of a channel, 0..255: three times the noise of a dim picture
    # of a shadow: which share of the light it leaves at least, and how far a channel may be off then, 0..255
    sure_shadow: tuple[float, float] = (0.5, 7.0)
    likely_shadow: tuple[float, float] = (0.25, 12.0)
    ghosts: GhostParams = field(default_factory=GhostParams)
    rate: float = 0.04  # share of a look, once it is known
    lamp_tolerance: float = 0.055  # of a channel, 0..1: what differs by more is in another light
    lamp_share: float = 0.2  # of the background that changes at once when a lamp does


class RoomBackground:
    """One camera's background, whichever cues look at it: mean (h,w,3) and age (h,w) of each pixel of its work pictures;
    lights: how often its light jumped."""

    def __init__(self, height: int, width: int, params: BackgroundParams) -> None:
        self._params = params
        self.mean = np.zeros((height, width, 3), np.float32)
        self.age = np.zeros((height, width), np.uint8)
        self.reset()

    def reset(self) -> None:
        """Nothing is known."""
        self.mean[:] = 0.0
        self.lights = 0
        self.age[:] = 0
        self._looks = 0

    @property
    def is_new(self) -> bool:
        """Whether too little was seen yet to tell who stands before it."""
        return self._looks < self._params.first_looks

    def empty_room(self) -> tuple[Singles, Bytes]:
        """The empty room (h,w,3) in the present light, and where it is known (h,w)."""
        return self.mean, (self.age >= self._params.known_looks).astype(np.uint8)

    def seed(self, picture: Bytes, body: Bytes) -> None:
        """Take a picture (h,w,3) for the background where `body` (h,w) is 0, as when a body is handed over."""
        beside = body == 0
        self.mean[beside] = picture[beside]
        self.age[beside] = self._params.known_looks
        self._looks = self._params.first_looks

    def set_known(self, room: Bytes, known: NDArray[np.bool_]) -> None:
        """Take the empty room (h,w,3) for the background where it is known (h,w)."""
        self.mean[:] = room
        self.age[:] = np.where(known, self._params.known_looks, 0)
        self._looks = self._params.first_looks

    def forget_body(self, picture: Bytes, body: Bytes) -> None:
        """Forget the background where `body` (h,w) is not 0 and the picture (h,w,3) looks like it: that is the body itself,
        of somebody who never left."""
        off = np.abs(picture - self.mean).max(axis=-1)
        self.age[(body > 0) & (off <= self._params.tolerance)] = 0

    def remove_ghosts(self, picture: Bytes, before: Bytes, body: Bytes, arms: Bytes) -> None:
        """Take for background what `uncovered` says of a picture (h,w,3), of what stands before it (h,w), where it becomes
        BACKGROUND, and of a body (h,w) and its arms (h,w)."""
        ghosts = find_ghosts(
            picture, self.mean.astype(np.uint8), before, body, arms, self._params.ghosts
        )
        self.mean[ghosts] = picture[ghosts]
        before[ghosts] = BACKGROUND

    def follow_light(self, picture: Bytes, body: Bytes) -> Floats | None:
        """By how much each channel (3,) became brighter when a lamp went on or off, whose light the background then takes;
        None while the light stays. body (h,w): not 0 where somebody is expected."""
        p = self._params
        share = changed(picture, body, self.mean, self.age, p.lamp_tolerance)
        if share <= p.lamp_share:
            return None
        seen = (body == 0) & (self.age >= p.known_looks)
        before, now = self.mean[seen].mean(axis=0), picture[seen].mean(axis=0)
        relight_background(picture, body, self.mean, self.age)
        self.lights += 1
        return np.asarray(np.clip((now + 1.0) / (before + 1.0), 0.1, 10.0), np.float64)

    def learn(self, picture: Bytes, body: Bytes, ticks: int = 1) -> None:
        """Follow the background where `body` (h,w) is 0; ticks: of 1/30 s since it did before. While it is new every look
        counts alike."""
        if self.is_new:
            phases: Sequence[int] = range(_PHASES)
            self._looks += 1
        else:
            phases = [(self._looks + k) % _PHASES for k in range(min(ticks, _PHASES))]
            self._looks += len(phases)
        for phase in phases:
            learn_background(picture, body, self.mean, self.age, self._params.rate, phase, _PHASES)

    def learn_unknown(self, picture: Bytes, body: Bytes, within: tuple[int, int, int, int]) -> None:
        """Learn what is not known yet within x0, y0, x1, y1 of a picture (h,w,3), where `body`, of that region, is 0: what
        stays the same so near to somebody is the room, uncovered at last."""
        x0, y0, x1, y1 = within
        here, p = np.s_[y0:y1, x0:x1], self._params
        learn_unknown(
            picture[here], body, p.known_looks, p.tolerance, self.mean[here], self.age[here]
        )

    def foreground(self, picture: Bytes, within: tuple[int, int, int, int] | None = None) -> Bytes:
        """(h,w) of a picture (h,w,3), as `stands_before` says, without specks and narrow gaps.

        within: x0, y0, x1, y1 of the only region that is asked for; BACKGROUND elsewhere.
        """
        p, whole = self._params, np.zeros_like(self.age)
        x0, y0, x1, y1 = within or (0, 0, whole.shape[1], whole.shape[0])
        if x1 <= x0 or y1 <= y0:  # who was followed is in no part of the picture
            return whole
        first = np.empty((y1 - y0, x1 - x0), np.uint8)
        stands_before(
            picture, self.mean, self.age, x0, y0, p.known_looks, p.tolerance, p.sure_shadow, p.likely_shadow, first
        )  # fmt: skip
        one = cv2.LUT(first, _STANDS)
        one = cv2.morphologyEx(one, cv2.MORPH_OPEN, _SPECK)
        one = cv2.morphologyEx(one, cv2.MORPH_CLOSE, _GAP)
        label_cleaned(first, np.asarray(one, np.uint8), x0, y0, whole)
        return whole
