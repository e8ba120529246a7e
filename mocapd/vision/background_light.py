"""Relights the background model: copied outside the body, scaled by the local gain behind it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Singles

_LEAST_AGE = 6  # updates after which a background pixel is valid
_AGE_BEHIND = 8  # inferred pixels are valid, and adapt quickly once they are visible
_STEP = 4  # the gain is smooth: sampled at every fourth pixel each way
_SPREAD = 10.0  # standard deviation of the gain's smoothing window [steps]
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
