"""Whether two cameras have changed places: the room's points, found in both pictures, fit the calibration only crosswise.

Silhouettes cannot tell: of a pair that stands symmetrically about the person they only mirror the body. A point of the
room can: its two rays meet before both cameras and not under the floor, or they do not. Of a close pair that is turned
towards each other they do either way, with distances mirrored about where the views cross: then nothing is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import cv2
import numpy as np

from mocapd.geometry.camera_model import centre, rays
from mocapd.types import Bytes, Camera, Floats


class Places(StrEnum):
    """`unknown`: too few points are seen by both."""

    UNKNOWN = "unknown"
    RIGHT = "right"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class PlacesParams:
    """When points decide."""

    alike: float = 0.8  # of the distance to the second best, a match's own: what occurs twice says nothing [Lowe 2004]
    features: int = 1500
    off_deg: float = 0.3  # of a ray from the other's plane: two pixels
    between_m: tuple[float, float] = (0.4, 12.0)  # from each camera, where rays may meet
    floor_m: float = -0.15  # below it nothing is
    least: int = 7  # points that fit one way: of a hundred false matches two or three do
    times: float = 2.5  # so many times as many as fit the other way, and one more


def places_of(
    cameras: tuple[Camera, Camera],
    pictures: tuple[Bytes, Bytes],
    params: PlacesParams | None = None,
) -> Places:
    """Of two cameras and what they deliver (h,w,3) BGR, each of its camera's size."""
    p = params if params is not None else PlacesParams()
    features = room_features(pictures[0], p), room_features(pictures[1], p)
    return places_by_matches(cameras, matching_points(features, p), p)


def places_by_matches(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], params: PlacesParams
) -> Places:
    """The same of matches (N,2) and (N,2) [px] that are known."""
    if len(px[0]) < params.least:
        return Places.UNKNOWN

    def decides(fitting: int, otherwise: int) -> bool:
        return fitting >= params.least and fitting > params.times * (otherwise + 1)

    first, second = cameras
    straight = fitting_points((first, second), px, params)
    crossed = fitting_points((second, first), px, params)
    if decides(straight, crossed):
        return Places.RIGHT
    if decides(crossed, straight):
        return Places.CHANGED
    return Places.UNKNOWN


@dataclass(frozen=True, slots=True, eq=False)
class RoomFeatures:
    """Of one picture: where features are (N,2) [px], and what describes them (N,128)."""

    px: Floats
    described: Floats


def room_features(picture: Bytes, params: PlacesParams) -> RoomFeatures:
    """Of a picture (h,w,3) BGR."""
    found = cv2.SIFT.create(nfeatures=params.features)
    # without a feature there is no description, whatever OpenCV's stubs say
    points, described = found.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)
    rows: Any = described
    if rows is None:
        rows = np.empty((0, 128), np.float32)
    return RoomFeatures(np.array([one.pt for one in points]).reshape(-1, 2), rows)


def matching_points(
    features: tuple[RoomFeatures, RoomFeatures], params: PlacesParams
) -> tuple[Floats, Floats]:
    """Places (N,2) [px] of what looks alike in both pictures, and in each like nothing else."""
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


def _sure(found: Sequence[Sequence[cv2.DMatch]], params: PlacesParams) -> list[cv2.DMatch]:
    """Of the two best matches of each feature, the first where it is clearly better."""
    return [
        pair[0]
        for pair in found
        if len(pair) == 2 and pair[0].distance < params.alike * pair[1].distance
    ]


def fitting_points(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], params: PlacesParams
) -> int:
    """How many matches (N,2) and (N,2) [px] of two cameras lie before both."""
    (first, second), (here, there) = cameras, px
    a, b = rays(first, here)[1], rays(second, there)[1]
    apart = centre(second) - centre(first)
    normal = np.cross(np.broadcast_to(apart, a.shape), a)
    length = np.linalg.norm(normal, axis=1)
    off = np.abs(np.einsum("ni,ni->n", normal, b)) / np.maximum(length, 1e-9)
    # distances along both rays where they pass nearest
    cosine = np.einsum("ni,ni->n", a, b)
    along_a, along_b = a @ apart, b @ apart
    sine2 = np.maximum(1.0 - cosine**2, 1e-9)
    from_first = (along_a - cosine * along_b) / sine2
    from_second = (cosine * along_a - along_b) / sine2
    low, high = params.between_m
    meets = (from_first > low) & (from_first < high) & (from_second > low) & (from_second < high)
    above = centre(first)[1] + from_first * a[:, 1] > params.floor_m
    return int(np.count_nonzero(meets & above & (off < np.radians(params.off_deg))))
