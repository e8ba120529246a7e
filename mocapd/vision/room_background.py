"""One camera's background model: updated outside people, relit at once, and the foreground in front of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Floats, Singles
from mocapd.vision.foreground_kernels import (
    BACKGROUND,
    changed,
    label_cleaned,
    learn_background,
    learn_unknown,
    stands,
    stands_before,
)
from mocapd.vision.ghost_removal import GhostParams, find_ghosts

_PHASES = 4  # the background changes slowly: each update takes every fourth row
_SPECK = np.ones((2, 2), np.uint8)  # smaller pieces are noise
_STANDS = stands(np.arange(256, dtype=np.uint8)).astype(np.uint8)  # of each label
# narrower gaps are parts of the body in the colour of the background
_GAP = np.ones((5, 5), np.uint8)


_LEAST_AGE = 6  # updates after which a background pixel is valid
_AGE_BEHIND = 8  # inferred pixels are valid, and adapt quickly once they are visible
_STEP = 4  # the gain is smooth: sampled at every fourth pixel each way
_SPREAD = 10.0  # standard deviation of the gain's smoothing window [steps]
_MOST_NEW = 3  # ticks that one update of a new background counts for, after a pause
_FAR_SHARE = 0.02  # weight of the whole picture against the neighbourhood
_GAIN = (0.1, 10.0)
_PASSES = 2
_EXPLAINED = 16.0  # from the relit background, 0..255: as far as it may be from a picture of it
_LEAST_ROOM = 0.5  # of what was known
# of what changed: of lamps in recordings 0.46 to 1 (where somebody walks past one, from 0.23), of people who pass close to a
# lens seldom above 0.06. With nobody known what is not lit stays foreground, so that less is enough.
_LEAST_LIT, _LEAST_LIT_OF_NOBODY = 0.35, 0.2


def relight_background(
    picture: Bytes, body: Bytes, mean: NDArray[np.float32], age: NDArray[np.uint8]
) -> bool:
    """Take the picture (h,w,3) for the background where `body` (h,w) is 0, and scale the model behind the body by the gain
    around it; False if another light does not explain what changed, for instance somebody close to the lens.

    mean (h,w,3) 0..255 and age (h,w) are changed in place. With nobody known a person may be anywhere: the room is then
    what another light explains. Where that is too little, for instance after the camera was moved, the whole model
    becomes invalid.
    """
    is_room = body == 0
    is_known = is_room & (age >= _LEAST_AGE)
    changed = is_known & (np.abs(picture - mean) > _EXPLAINED).any(axis=2)
    gain = _gain(picture, mean, is_known)
    for _ in range(_PASSES):  # a person counts as light in the first one
        lit = is_known & (np.abs(picture - gain * mean) <= _EXPLAINED).all(axis=2)
        gain = _gain(picture, mean, lit)
    least_lit = _LEAST_LIT
    if is_room.all():
        if np.count_nonzero(lit) < _LEAST_ROOM * np.count_nonzero(is_known):
            age[:] = 0
            return True
        is_room, least_lit = lit, _LEAST_LIT_OF_NOBODY
    if np.count_nonzero(lit & changed) < least_lit * np.count_nonzero(changed):
        return False
    behind = ~is_room
    mean[behind] = np.minimum(mean[behind] * gain[behind], 255.0)
    age[behind] = np.minimum(age[behind], _AGE_BEHIND)
    mean[is_room] = picture[is_room]
    return True


def _gain(picture: Bytes, mean: NDArray[np.float32], known: NDArray[np.bool_]) -> Singles:
    """Of the light (h,w,3), from the surroundings where it is `known` (h,w)."""
    weight = known[::_STEP, ::_STEP, None].astype(np.float32)
    before = _local_sums(mean[::_STEP, ::_STEP] * weight)
    now = _local_sums(picture[::_STEP, ::_STEP] * weight)
    gain = np.clip((now + 1e-3) / (before + 1e-3), *_GAIN).astype(np.float32)
    h, w = known.shape
    return np.asarray(cv2.resize(gain, (w, h), interpolation=cv2.INTER_LINEAR), np.float32)


def _local_sums(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sums (h,w,3) over the neighbourhood, and a little over the whole."""
    near = cv2.GaussianBlur(values, (0, 0), _SPREAD, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(near + _FAR_SHARE * values.mean(axis=(0, 1)), np.float32)


@dataclass(frozen=True, slots=True)
class BackgroundParams:
    """When a background pixel is valid, and how far the foreground differs from it."""

    first_ticks: int = 20  # of 1/30 s, in which updates take every row
    least_looks: int = 6  # updates after which a pixel is valid
    tolerance: float = 16.0  # of a channel, 0..255: three times the noise of a dim picture
    # of a shadow: which share of the light it leaves at least, and how far a channel may be off then, 0..255
    sure_shadow: tuple[float, float] = (0.5, 7.0)
    likely_shadow: tuple[float, float] = (0.25, 12.0)
    ghosts: GhostParams = field(default_factory=GhostParams)
    rate: float = 0.04  # share of the new picture in a valid pixel
    lamp_tolerance: float = 0.055  # of a channel, 0..1: a larger difference means another light
    lamp_share: float = 0.2  # of the background that changes at once when a lamp does
    # looks that a light must last to be remembered, and the share that may look otherwise when it comes back
    lasting_looks: int = 60
    same_share: float = 0.1


class RoomBackground:
    """One camera's background, shared by the cues: mean (h,w,3) and age (h,w) of each pixel of its work pictures;
    lights: count of the jumps of its light."""

    def __init__(self, height: int, width: int, params: BackgroundParams) -> None:
        self._params = params
        self.mean = np.zeros((height, width, 3), np.float32)
        self.age = np.zeros((height, width), np.uint8)
        self.reset()

    def reset(self) -> None:
        """Forget the whole background."""
        self.mean[:] = 0.0
        self.lights = 0
        self.age[:] = 0
        self._looks = 0
        self._forget_earlier()

    def _forget_earlier(self) -> None:
        """Forget the room in an earlier light; the present light begins now."""
        self._earlier: tuple[Singles, Bytes] | None = None  # mean and age
        self._since = self._looks

    @property
    def is_new(self) -> bool:
        """Whether too few pictures were learned for a foreground."""
        return self._looks < self._params.first_ticks

    def empty_room(self) -> tuple[Singles, Bytes]:
        """The empty room (h,w,3) in the present light, and its validity (h,w)."""
        return self.mean, (self.age >= self._params.least_looks).astype(np.uint8)

    def seed(self, picture: Bytes, body: Bytes) -> None:
        """Take a picture (h,w,3) for the background where `body` (h,w) is 0, for instance when another cue starts."""
        is_room = body == 0
        self.mean[is_room] = picture[is_room]
        self.age[is_room] = self._params.least_looks
        self._looks = self._params.first_ticks
        self._forget_earlier()

    def set_known(self, room: Bytes, valid: NDArray[np.bool_]) -> None:
        """Take the empty room (h,w,3) for the background where it is valid (h,w)."""
        self.mean[:] = room
        self.age[:] = np.where(valid, self._params.least_looks, 0)
        self._looks = self._params.first_ticks
        self._forget_earlier()

    def looks_like(self, picture: Bytes) -> NDArray[np.bool_]:
        """(h,w): where a picture (h,w,3) looks like the background."""
        off = np.abs(picture - self.mean).max(axis=-1)
        return np.asarray(off <= self._params.tolerance)

    def forget(self, where: NDArray[np.bool_]) -> None:
        """Forget the background there (h,w)."""
        self.age[where] = 0
        self._forget_earlier()

    def remove_ghosts(self, picture: Bytes, before: Bytes, body: Bytes, arms: Bytes) -> None:
        """Move the ghosts (`find_ghosts`) of a picture (h,w,3) into the background; before (h,w): the foreground, where they
        become BACKGROUND; body, arms (h,w): as drawn."""
        ghosts = find_ghosts(
            picture, self.mean.astype(np.uint8), before, body, arms, self._params.ghosts
        )
        self.mean[ghosts] = picture[ghosts]
        before[ghosts] = BACKGROUND

    def follow_light(self, picture: Bytes, body: Bytes) -> Floats | None:
        """Relight the background when a lamp goes on or off: the gain of each channel (3,); None while the light stays, also
        when somebody passes close to the lens. A light that lasted is remembered, and comes back as it was: something dark
        before the lens is as a lamp that goes out. body (h,w): not 0 at the expected person."""
        p = self._params
        earlier, lasted = self._earlier, self._looks - self._since >= p.lasting_looks
        other_light = self._changed(picture, body, self.mean, self.age) > p.lamp_share
        if not other_light and (lasted or earlier is None or not self._is_unknown()):
            return None
        visible = (body == 0) & (self.age >= p.least_looks)
        present = self.mean.copy(), self.age.copy()
        if earlier is not None and self._changed(picture, body, *earlier) <= p.same_share:
            self.mean[:], self.age[:] = earlier
        elif not (other_light and relight_background(picture, body, self.mean, self.age)):
            return None
        if lasted or earlier is None:
            self._earlier = present
        self._since = self._looks
        self.lights += 1
        if not visible.any():
            return np.ones(3)
        before, now = present[0][visible].mean(axis=0), picture[visible].mean(axis=0)
        return np.asarray(np.clip((now + 1.0) / (before + 1.0), 0.1, 10.0), np.float64)

    def _is_unknown(self) -> bool:
        """Whether most of the room is, as after the camera was covered."""
        return bool(np.median(self.age[::4, ::4]) < self._params.least_looks)

    def _changed(self, picture: Bytes, body: Bytes, mean: Singles, age: Bytes) -> float:
        return changed(picture, body, mean, age, self._params.lamp_tolerance)

    def learn(self, picture: Bytes, body: Bytes, ticks: int = 1) -> None:
        """Follow the background where `body` (h,w) is 0; ticks: of 1/30 s since the last update. While it is new all
        pictures have the same weight."""
        if self.is_new:
            phases: Sequence[int] = range(_PHASES)
            self._looks += min(ticks, _MOST_NEW)
        else:
            phases = [(self._looks + k) % _PHASES for k in range(min(ticks, _PHASES))]
            self._looks += len(phases)
        for phase in phases:
            learn_background(picture, body, self.mean, self.age, self._params.rate, phase, _PHASES)

    def learn_unknown(self, picture: Bytes, body: Bytes, within: tuple[int, int, int, int]) -> None:
        """Learn the invalid pixels within x0, y0, x1, y1 of a picture (h,w,3), where `body`, of that region, is 0: a constant
        colour so near to the person is newly uncovered room."""
        x0, y0, x1, y1 = within
        here, p = np.s_[y0:y1, x0:x1], self._params
        learn_unknown(
            picture[here], body, p.least_looks, p.tolerance, self.mean[here], self.age[here]
        )

    def foreground(self, picture: Bytes, within: tuple[int, int, int, int] | None = None) -> Bytes:
        """Labels (h,w) of a picture (h,w,3) as of `stands_before`, without specks and narrow gaps.

        within: x0, y0, x1, y1 of the region to label; BACKGROUND elsewhere.
        """
        p, whole = self._params, np.zeros_like(self.age)
        x0, y0, x1, y1 = within or (0, 0, whole.shape[1], whole.shape[0])
        if x1 <= x0 or y1 <= y0:  # the tracked person is out of the picture
            return whole
        first = np.empty((y1 - y0, x1 - x0), np.uint8)
        stands_before(
            picture, self.mean, self.age, x0, y0, p.least_looks, p.tolerance, p.sure_shadow, p.likely_shadow, first
        )  # fmt: skip
        mask = cv2.LUT(first, _STANDS)
        # an opening; with one anchor for both steps OpenCV shifts the mask by a pixel, as the kernel has no middle
        mask = cv2.dilate(cv2.erode(mask, _SPECK, anchor=(1, 1)), _SPECK, anchor=(0, 0))
        mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _GAP)
        label_cleaned(first, np.asarray(mask, np.uint8), x0, y0, whole)
        return whole
