"""Detects two cameras that changed places: the room's points in both pictures fit the calibration only crosswise.

Silhouettes cannot show it: in a pair that is symmetric about the person they only mirror the body. A point of the room
can: its two rays either meet in front of both cameras and above the floor, or not. In a close pair of converging cameras
they meet either way, with distances mirrored about the crossing of the views; then the result is `unknown`.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import cv2
import numpy as np

from mocapd.geometry.camera_model import centre, rays
from mocapd.types import Bytes, Camera, Floats

_FEATURES = 1500
_ALIKE = 0.8  # ratio test: of the distance to the second best match [Lowe 2004]
_OFF_DEG = 0.3  # of a ray from the other's plane: two pixels
_BETWEEN_M = (0.4, 12.0)  # from each camera, where rays may meet
_FLOOR_M = -0.15  # no point lies lower
_LEAST = 7  # points that fit one way: of a hundred false matches two or three do
_TIMES = 2.5  # least ratio of the points that fit one way and the other


class PlacesVerdict(StrEnum):
    """`unknown`: too few points are visible in both."""

    UNKNOWN = "unknown"
    RIGHT = "right"
    CHANGED = "changed"


def places_of(cameras: tuple[Camera, Camera], pictures: tuple[Bytes, Bytes]) -> PlacesVerdict:
    """Compares two cameras with their pictures (h,w,3) BGR, each of its camera's size."""
    features = room_features(pictures[0]), room_features(pictures[1])
    return places_by_matches(cameras, matching_points(*features))


def places_by_matches(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> PlacesVerdict:
    """The same from given matches (N,2) and (N,2) [px]."""
    if len(px[0]) < _LEAST:
        return PlacesVerdict.UNKNOWN

    def decides(fitting: int, otherwise: int) -> bool:
        return fitting >= _LEAST and fitting > _TIMES * (otherwise + 1)

    first, second = cameras
    straight = fitting_points((first, second), px)
    crossed = fitting_points((second, first), px)
    if decides(straight, crossed):
        return PlacesVerdict.RIGHT
    if decides(crossed, straight):
        return PlacesVerdict.CHANGED
    return PlacesVerdict.UNKNOWN


@dataclass(frozen=True, slots=True, eq=False)
class RoomFeatures:
    """Features of one picture: positions (N,2) [px] and descriptors (N,128)."""

    px: Floats
    described: Floats


def room_features(picture: Bytes) -> RoomFeatures:
    """Of a picture (h,w,3) BGR."""
    detector = cv2.SIFT.create(nfeatures=_FEATURES)
    # without a feature there are no descriptors, which OpenCV's stubs do not say
    points, described = detector.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)
    rows: Any = described
    if rows is None:
        rows = np.empty((0, 128), np.float32)
    return RoomFeatures(np.array([point.pt for point in points]).reshape(-1, 2), rows)


def matching_points(a: RoomFeatures, b: RoomFeatures) -> tuple[Floats, Floats]:
    """Positions (N,2) [px] of unambiguous matches between both pictures."""
    if min(len(a.px), len(b.px)) < 2:
        return np.empty((0, 2)), np.empty((0, 2))
    there, back = _clear_matches(a, b), _clear_matches(b, a)
    pairs = [(i, j) for i, j in there.items() if back.get(j) == i]
    i, j = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return a.px[i], b.px[j]


def _clear_matches(a: RoomFeatures, b: RoomFeatures) -> dict[int, int]:
    """From features of a to their best matches in b that are clearly better than the second best (ratio test)."""
    pairs = cv2.BFMatcher(cv2.NORM_L2).knnMatch(a.described, b.described, k=2)
    return {
        best.queryIdx: best.trainIdx
        for best, second in pairs
        if best.distance < _ALIKE * second.distance
    }


def fitting_points(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> int:
    """The number of matches (N,2) and (N,2) [px] in front of both cameras."""
    (first, second), (here, there) = cameras, px
    a, b = rays(first, here)[1], rays(second, there)[1]
    apart = centre(second) - centre(first)
    normal = np.cross(np.broadcast_to(apart, a.shape), a)
    length = np.linalg.norm(normal, axis=1)
    off = np.abs(np.einsum("ni,ni->n", normal, b)) / np.maximum(length, 1e-9)
    # distances along both rays at their closest approach
    cosine = np.einsum("ni,ni->n", a, b)
    along_a, along_b = a @ apart, b @ apart
    sine2 = np.maximum(1.0 - cosine**2, 1e-9)
    from_first = (along_a - cosine * along_b) / sine2
    from_second = (cosine * along_a - along_b) / sine2
    low, high = _BETWEEN_M
    meets = (from_first > low) & (from_first < high) & (from_second > low) & (from_second < high)
    above = centre(first)[1] + from_first * a[:, 1] > _FLOOR_M
    return int(np.count_nonzero(meets & above & (off < np.radians(_OFF_DEG))))
