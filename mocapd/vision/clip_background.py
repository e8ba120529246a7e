"""One camera's background from a recording with a person in view from the first frame to the last.

A pixel's colour is valid while nothing moves near it: a person at rest sways, the room does not (stable intervals:
Gutchess et al., A Background Model Initialization Algorithm for Video Surveillance, ICCV 2001). Where that is seldom so
a person was there too often, and the room is unknown; so is the area that such pixels enclose, the smooth middle of cloth.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Floats

_NEAR_PX = 9  # side of the square in which nothing may move
_GAP = np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (31, 31)), np.uint8)  # a thigh


@dataclass(frozen=True, slots=True)
class ClipBackgroundParams:
    """When a pixel counts as still, and how often it must be."""

    # between pictures that are compared: in less time a person moves less than a pixel
    apart_s: float = 0.13
    tolerance: float = 10.0  # of a channel, 0..255
    noises: float = 4.0  # or as often the difference that half of the picture has
    moving_share: float = 0.12  # of the pixels nearby that may differ: noise does
    still_share: float = 0.12  # of the pictures in which a pixel must be still


def clip_background(
    pictures: Sequence[Bytes], times_s: Floats, params: ClipBackgroundParams | None = None
) -> tuple[Bytes, NDArray[np.bool_]]:
    """The room (h,w,3) behind moving people in pictures (h,w,3) of times (N,) [s], and its validity (h,w)."""
    p = params if params is not None else ClipBackgroundParams()
    shown = np.stack(pictures)
    still = np.stack([_still(shown, k, times_s, p) for k in range(len(shown))])
    moving = (still.mean(axis=0) < p.still_share).astype(np.uint8)
    unknown = np.asarray(cv2.morphologyEx(moving, cv2.MORPH_CLOSE, _GAP), np.uint8)
    return _median_of(shown, still), _joined_to_the_border(1 - unknown)


def _still(
    shown: Bytes, k: int, times_s: Floats, params: ClipBackgroundParams
) -> NDArray[np.bool_]:
    """Where (h,w) picture k looks like those before and after it."""
    before = int(np.searchsorted(times_s, times_s[k] - params.apart_s, side="right")) - 1
    after = int(np.searchsorted(times_s, times_s[k] + params.apart_s))
    others = [j for j in (before, after) if 0 <= j < len(shown)]
    if not others:
        return np.zeros(shown.shape[1:3], dtype=bool)
    differ = np.zeros(shown.shape[1:3], np.uint8)
    for j in others:
        # numpy's own maximum over a last axis of three takes thirty times as long
        apart = reduce(np.maximum, cv2.split(cv2.absdiff(shown[k], shown[j])))
        tolerance = max(params.tolerance, params.noises * float(np.median(apart)))
        np.maximum(differ, (apart > tolerance).astype(np.uint8), out=differ)
    near = cv2.blur(differ.astype(np.float32), (_NEAR_PX, _NEAR_PX))
    moving = (near >= params.moving_share).astype(np.uint8)
    return np.asarray(cv2.morphologyEx(moving, cv2.MORPH_CLOSE, _GAP) == 0, dtype=bool)


def _median_of(shown: Bytes, still: NDArray[np.bool_]) -> Bytes:
    """Of each pixel (h,w,3), of the pictures (N,h,w,3) in which it is still (N,h,w); black where it never is."""
    count = still.sum(axis=0)
    middle = np.maximum(count - 1, 0) // 2
    room = np.zeros(shown.shape[1:], np.uint8)
    for channel in range(3):
        # moving pixels sort to the end
        values = np.sort(np.where(still, shown[..., channel], np.uint8(255)), axis=0)
        room[..., channel] = np.take_along_axis(values, middle[None], axis=0)[0]
    room[count == 0] = 0
    return room


def _joined_to_the_border(valid: Bytes) -> NDArray[np.bool_]:
    """Where valid (h,w) is not 0, without the islands inside invalid areas."""
    framed = cv2.copyMakeBorder(valid, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=1)
    _, pieces = cv2.connectedComponents(framed)
    return np.asarray(pieces == pieces[0, 0], dtype=bool)[1:-1, 1:-1]
