"""Detects two cameras that changed places: the room's points in both pictures fit the calibration only crosswise.

Silhouettes cannot show it: in a pair that is symmetric about the person they only mirror the body. A point of the room
can: its two rays either meet in front of both cameras and above the floor, or not. In a close pair of converging cameras
they meet either way, with distances mirrored about the crossing of the views; then the result is `unknown`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import cv2
import numpy as np

from mocapd.geometry.camera_model import centre, rays
from mocapd.types import Bytes, Camera, Floats


class PlacesVerdict(StrEnum):
    """`unknown`: too few points are visible in both."""

    UNKNOWN = "unknown"
    RIGHT = "right"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class PlacesParams:
    """Thresholds of the decision."""

    alike: float = 0.8  # ratio test: of the distance to the second best match [Lowe 2004]
    features: int = 1500
    off_deg: float = 0.3  # of a ray from the other's plane: two pixels
    between_m: tuple[float, float] = (0.4, 12.0)  # from each camera, where rays may meet
    floor_m: float = -0.15  # no point lies lower
    least: int = 7  # points that fit one way: of a hundred false matches two or three do
    times: float = 2.5  # least ratio of the points that fit one way and the other


def places_of(
    cameras: tuple[Camera, Camera],
    pictures: tuple[Bytes, Bytes],
    params: PlacesParams | None = None,
) -> PlacesVerdict:
    """Compares two cameras with their pictures (h,w,3) BGR, each of its camera's size."""
    p = params if params is not None else PlacesParams()
    features = room_features(pictures[0], p), room_features(pictures[1], p)
    return places_by_matches(cameras, matching_points(features, p), p)


def places_by_matches(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], params: PlacesParams
) -> PlacesVerdict:
    """The same from given matches (N,2) and (N,2) [px]."""
    if len(px[0]) < params.least:
        return PlacesVerdict.UNKNOWN

    def decides(fitting: int, otherwise: int) -> bool:
        return fitting >= params.least and fitting > params.times * (otherwise + 1)

    first, second = cameras
    straight = fitting_points((first, second), px, params)
    crossed = fitting_points((second, first), px, params)
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


def room_features(picture: Bytes, params: PlacesParams) -> RoomFeatures:
    """Of a picture (h,w,3) BGR."""
    detector = cv2.SIFT.create(nfeatures=params.features)
    # without a feature there are no descriptors, which OpenCV's stubs do not say
    points, described = detector.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)
    rows: Any = described
    if rows is None:
        rows = np.empty((0, 128), np.float32)
    return RoomFeatures(np.array([point.pt for point in points]).reshape(-1, 2), rows)


def matching_points(
    features: tuple[RoomFeatures, RoomFeatures], params: PlacesParams
) -> tuple[Floats, Floats]:
    """Positions (N,2) [px] of unambiguous matches between both pictures."""
    a, b = features
    if min(len(a.px), len(b.px)) < 2:
        return np.empty((0, 2)), np.empty((0, 2))
    matcher = cv2.BFMatcher(cv2.NORM_L2)
    there = {
        m.queryIdx: m.trainIdx
        for m in _sure(matcher.knnMatch(a.described, b.described, k=2), params)
    }
    back = {
        m.queryIdx: m.trainIdx
        for m in _sure(matcher.knnMatch(b.described, a.described, k=2), params)
    }
    pairs = [(i, j) for i, j in there.items() if back.get(j) == i]
    if not pairs:
        return np.empty((0, 2)), np.empty((0, 2))
    return a.px[[i for i, _ in pairs]], b.px[[j for _, j in pairs]]


def _sure(pairs: Sequence[Sequence[cv2.DMatch]], params: PlacesParams) -> list[cv2.DMatch]:
    """Of the two best matches of each feature, the first where it is clearly better (ratio test)."""
    return [
        pair[0]
        for pair in pairs
        if len(pair) == 2 and pair[0].distance < params.alike * pair[1].distance
    ]


def fitting_points(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], params: PlacesParams
) -> int:
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
    low, high = params.between_m
    meets = (from_first > low) & (from_first < high) & (from_second > low) & (from_second < high)
    above = centre(first)[1] + from_first * a[:, 1] > params.floor_m
    return int(np.count_nonzero(meets & above & (off < np.radians(params.off_deg))))
