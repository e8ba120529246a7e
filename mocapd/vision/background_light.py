"""Relights the background model: copied outside the body, scaled by the local gain behind it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes

_LEAST_AGE = 6  # updates after which a background pixel is valid
_AGE_BEHIND = 8  # inferred pixels are valid, and adapt quickly once they are visible
_STEP = 4  # the gain is smooth: sampled at every fourth pixel each way
_SPREAD = 10.0  # standard deviation of the gain's smoothing window [steps]
_FAR_SHARE = 0.02  # weight of the whole picture against the neighbourhood
_GAIN = (0.1, 10.0)


def relight_background(
    picture: Bytes, body: Bytes, mean: NDArray[np.float32], age: NDArray[np.uint8]
) -> None:
    """Take the picture (h,w,3) for the background where `body` (h,w) is 0, and scale the model
    behind the body by the gain around it.

    mean (h,w,3) 0..255 and age (h,w) are changed in place. With a mask that covers the
    picture the whole model becomes invalid: a person may be anywhere.
    """
    is_room = body == 0
    if is_room.all():
        age[:] = 0
        return
    weight = (is_room & (age >= _LEAST_AGE))[::_STEP, ::_STEP, None].astype(np.float32)
    before = _local_sums(mean[::_STEP, ::_STEP] * weight)
    now = _local_sums(picture[::_STEP, ::_STEP] * weight)
    gain = np.clip((now + 1e-3) / (before + 1e-3), *_GAIN)
    h, w = body.shape
    behind = ~is_room
    full = cv2.resize(gain.astype(np.float32), (w, h), interpolation=cv2.INTER_LINEAR)
    mean[behind] = np.minimum(mean[behind] * full[behind], 255.0)
    age[behind] = np.minimum(age[behind], _AGE_BEHIND)
    mean[is_room] = picture[is_room]


def _local_sums(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sums (h,w,3) over the neighbourhood, and a little over the whole."""
    near = cv2.GaussianBlur(values, (0, 0), _SPREAD, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(near + _FAR_SHARE * values.mean(axis=(0, 1)), np.float32)
