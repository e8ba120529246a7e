"""Position of a face in one camera's picture: by a close second camera, by a distant one, or by its size alone."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from mocapd.body.head_proportions import FACE_WIDTH
from mocapd.geometry.camera_model import normalised, project, to_camera
from mocapd.geometry.triangulation import triangulate
from mocapd.published.hecht2009.face.face_detection import FaceBox, face_windows, group_windows
from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays
from mocapd.published.hecht2009.head.head_params import (
    FACE_DEPTH_SD,
    FACE_SD,
    FARTHEST_M,
    LEAST_WINDOWS,
    MEETING_M,
    NEAREST_M,
    SIZE_SHARE,
    is_head_sized,
)
from mocapd.published.hecht2009.head.head_shape import head_size
from mocapd.published.hecht2009.head.head_views import HeadView, have_baseline, ray_through
from mocapd.published.hecht2009.head.stereo_distance import (
    WIDEST_RAD,
    swept_distance,
    view_angle_rad,
)
from mocapd.types import Floats

_PATCH = 0.45  # of the box's side: the face without its outline


class Depth(Enum):
    """The source of a face's distance."""

    SIZE = "apparent size"
    STEREO = "a camera close by"
    MEETING = "the face in another view"


@dataclass(frozen=True, slots=True, eq=False)
class PlacedFace:
    """The middle (3,) of the head [m, world] with its standard deviation along the ray [m]; boxes by camera index;
    size_share: the face's true width against a grown person's of that stature."""

    middle_m: Floats
    sigma_along_m: float
    depth: Depth
    boxes: dict[int, FaceBox]
    size_share: float

    @property
    def is_head_sized(self) -> bool:
        """True for a face of a person's size."""
        return is_head_sized(self.size_share)

    @property
    def is_sure(self) -> bool:
        """True if another view agrees on a person's face."""
        return self.depth is not Depth.SIZE and self.is_head_sized


def apparent_distance_m(view: HeadView, box: FaceBox, stature_m: float) -> float:
    """Distance along the ray to the box's middle, by the person's face size."""
    depth_m = FACE_WIDTH * stature_m * float(view.camera.K[0, 0]) / box.size_px
    _, ray = ray_through(view, middle_px(box))
    return depth_m / max(float((view.camera.R @ ray)[2]), 0.1)


def placed_face(
    views: Sequence[HeadView], mine: HeadView, box: FaceBox, cascade: CascadeArrays, stature_m: float,
    is_still: Callable[[HeadView, FaceBox], bool],
) -> PlacedFace:  # fmt: skip
    """The position of the face in `box` of the view `mine`, by the best of the other views, or else by its size.

    is_still: whether a face of another view is part of the background; such a face is no match.
    """
    apparent_m = apparent_distance_m(mine, box, stature_m)
    from_m, ray = ray_through(mine, middle_px(box))
    about_m = from_m + apparent_m * ray
    far = []
    for other in views:
        if other.index == mine.index or not have_baseline(other.camera, mine.camera):
            continue
        if view_angle_rad(mine.camera, other.camera, about_m) > WIDEST_RAD:
            far.append(other)
            continue
        found = swept_distance(
            mine.stereo, other.stereo, middle_px(box), _PATCH * box.size_px,
            (NEAREST_M, FARTHEST_M), head_size(stature_m).length_m,
        )  # fmt: skip
        if found is not None:
            return PlacedFace(
                from_m + found.distance_m * ray, found.sigma_m, Depth.STEREO, {mine.index: box},
                found.distance_m / apparent_m,
            )  # fmt: skip
    for other in far:
        met = _met(mine, other, box, apparent_m, cascade, stature_m, is_still)
        if met is not None:
            return met
    sigma_m = FACE_DEPTH_SD * apparent_m
    return PlacedFace(about_m, sigma_m, Depth.SIZE, {mine.index: box}, 1.0)


def fits_swapped(
    mine: HeadView, other: HeadView, box: FaceBox, cascade: CascadeArrays, stature_m: float,
    is_still: Callable[[HeadView, FaceBox], bool],
) -> bool:  # fmt: skip
    """Whether the face is of a person's size where the two views agree on it once their pictures change places."""
    if not have_baseline(mine.camera, other.camera):
        return False
    crossed = _with_cameras_of(mine, other), _with_cameras_of(other, mine)
    return placed_face(crossed, crossed[0], box, cascade, stature_m, is_still).is_sure


def _with_cameras_of(view: HeadView, other: HeadView) -> HeadView:
    """The view with the other camera's calibration."""
    return replace(view, stereo=replace(other.stereo, grey=view.grey))


def middle_px(box: FaceBox) -> Floats:
    """The middle (2,) of a box [px]."""
    return np.array([box.x_px, box.y_px])


def _met(
    mine: HeadView, other: HeadView, box: FaceBox, apparent_m: float, cascade: CascadeArrays, stature_m: float,
    is_still: Callable[[HeadView, FaceBox], bool],
) -> PlacedFace | None:  # fmt: skip
    """The same face found along its ray in a view from elsewhere."""
    from_m, ray = ray_through(mine, middle_px(box))
    ends_m = from_m + apparent_m * np.outer(SIZE_SHARE, ray)
    depth_m = to_camera(other.camera, ends_m)[:, 2]
    if (depth_m < NEAREST_M).any():
        return None
    ends_px = project(other.camera, ends_m)
    size_px = FACE_WIDTH * stature_m * float(other.camera.K[0, 0]) / float(depth_m.mean())
    low, high = ends_px.min(axis=0) - size_px, ends_px.max(axis=0) + size_px
    region = (int(low[0]), int(low[1]), int(high[0]) + 1, int(high[1]) + 1)
    sizes = tuple(size_px * share for share in (0.75, 0.9, 1.08, 1.3))
    seen = group_windows(face_windows(cascade, other.grey, sizes, region), LEAST_WINDOWS)
    best: PlacedFace | None = None
    for candidate in seen:
        xy = np.stack([normalised(mine.camera, middle_px(box)), normalised(other.camera, middle_px(candidate))])  # fmt: skip
        point_m, residual_m = triangulate([mine.camera, other.camera], xy)
        if not np.isfinite(point_m).all() or residual_m.max() > MEETING_M:
            continue
        share = float(np.linalg.norm(point_m - from_m)) / apparent_m
        if not is_head_sized(share) or is_still(other, candidate):
            continue
        if best is None or abs(np.log(share)) < abs(np.log(best.size_share)):
            sigma_m = FACE_SD * FACE_WIDTH * stature_m * 2.0
            boxes = {mine.index: box, other.index: candidate}
            best = PlacedFace(point_m, sigma_m, Depth.MEETING, boxes, share)
    return best
