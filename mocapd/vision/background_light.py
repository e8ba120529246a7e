"""The background in a new light: seen where nobody stands, and inferred behind the body."""

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes

_KNOWN = 6  # looks after which a background pixel counts
_AGE_BEHIND = 8  # what was inferred counts as known, and gives way quickly once it is seen
_STEP = 4  # the change of light is smooth: looked at in every fourth pixel each way
_SPREAD = 10.0  # standard deviation over which a place tells of its neighbours [steps]
_FAR_SHARE = 0.02  # weight of the whole picture against the neighbourhood
_GAIN = (0.1, 10.0)


def relight_background(
    picture: Bytes, body: Bytes, mean: NDArray[np.float32], age: NDArray[np.uint8]
) -> None:
    """Take the picture (h,w,3) for the background where `body` (h,w) is 0, and scale what was known
    behind the body by the change of light seen around it.

    mean (h,w,3) 0..255 and age (h,w) are changed in place. With nobody known everything is
    forgotten instead: somebody unseen may stand in the picture.
    """
    beside = body == 0
    if beside.all():
        age[:] = 0
        return
    seen = (beside & (age >= _KNOWN))[::_STEP, ::_STEP, None].astype(np.float32)
    before = _local_sums(mean[::_STEP, ::_STEP] * seen)
    now = _local_sums(picture[::_STEP, ::_STEP] * seen)
    gain = np.clip((now + 1e-3) / (before + 1e-3), *_GAIN)
    h, w = body.shape
    behind = ~beside
    full = cv2.resize(gain.astype(np.float32), (w, h), interpolation=cv2.INTER_LINEAR)
    mean[behind] = np.minimum(mean[behind] * full[behind], 255.0)
    age[behind] = np.minimum(age[behind], _AGE_BEHIND)
    mean[beside] = picture[beside]


def _local_sums(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sums (h,w,3) over the neighbourhood, and a little over the whole."""
    near = cv2.GaussianBlur(values, (0, 0), _SPREAD, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(near + _FAR_SHARE * values.mean(axis=(0, 1)), np.float32)
