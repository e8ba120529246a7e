"""Finds a head by its outline before a learned background, for faces that the detector misses.

The top of the foreground is a head if it is as high and as narrow as a head at a distance on which the cameras agree.
"""

from collections.abc import Sequence
from itertools import combinations

import cv2
import numpy as np

from mocapd.body.head_proportions import FACE_WIDTH
from mocapd.geometry.camera_model import centre, normalised
from mocapd.geometry.triangulation import triangulate
from mocapd.published.hecht2009.face.face_detection import FaceBox
from mocapd.published.hecht2009.head.face_placing import (
    Depth,
    PlacedFace,
    apparent_distance_m,
    middle_px,
)
from mocapd.published.hecht2009.head.head_colours import initial_colours
from mocapd.published.hecht2009.head.head_params import (
    FARTHEST_M,
    MEETING_M,
    NEAREST_M,
    is_head_sized,
)
from mocapd.published.hecht2009.head.head_particle_kernels import score_heads
from mocapd.published.hecht2009.head.head_samples import INSIDE, OUTLINE
from mocapd.published.hecht2009.head.head_shape import ellipse_of, head_size
from mocapd.published.hecht2009.head.head_views import HeadView, have_baseline, ray_through
from mocapd.published.hecht2009.head.stereo_distance import (
    WIDEST_RAD,
    swept_distance,
    view_angle_rad,
)
from mocapd.types import Floats

_SMALL = 4  # by which the foreground is reduced
_LEAST_SHARE = 0.01  # of a person in the picture
_TOP_ROWS = 4  # of the reduced foreground; their middle is the crown's
_DISTANCES = 32
_LEAST_SCORE = 0.75  # of a head by the foreground alone; the best is 1 plus its edge
_TOPS = 3  # sizes that are tried
_PATCH = 0.7  # of the head's half height
_SIGMA_SHARE = 0.4  # of a head's half height: how well its outline says where it is


def outlined_head(
    views: Sequence[HeadView], stature_m: float
) -> tuple[int, FaceBox, PlacedFace] | None:
    """Camera index, box about the undetected face, and position of the head; None where the views do not agree.

    A whole person may fit a near head as well as the head fits a far one: the distance decides.
    """
    tops = [(view, box) for view in views for box in _tops(view, stature_m)]
    for view, box in tops:
        for other in views:
            placed = _beside(view, other, box, stature_m)
            if placed is not None and placed.is_head_sized:
                return view.index, box, placed
    for (one, a), (other, b) in combinations(tops, 2):
        placed = _met(one, a, other, b, stature_m)
        if placed is not None:
            return one.index, a, placed
    return None


def _met(
    one: HeadView, a: FaceBox, other: HeadView, b: FaceBox, stature_m: float
) -> PlacedFace | None:
    """The intersection of two tops in space, where both have a head's size."""
    if one.index == other.index or not have_baseline(one.camera, other.camera):
        return None
    xy = np.stack([normalised(one.camera, middle_px(a)), normalised(other.camera, middle_px(b))])
    point_m, residual_m = triangulate([one.camera, other.camera], xy)
    if not np.isfinite(point_m).all() or residual_m.max() > MEETING_M:
        return None
    shares = [
        float(np.linalg.norm(point_m - centre(view.camera)))
        / apparent_distance_m(view, box, stature_m)
        for view, box in ((one, a), (other, b))
    ]
    if not all(map(is_head_sized, shares)):
        return None
    sigma_m = _SIGMA_SHARE * head_size(stature_m).height_m
    return PlacedFace(point_m, sigma_m, Depth.MEETING, {}, shares[0])


def _beside(view: HeadView, other: HeadView, box: FaceBox, stature_m: float) -> PlacedFace | None:
    """The position by a close second camera."""
    if other.index == view.index or not have_baseline(view.camera, other.camera):
        return None
    apparent_m, size = apparent_distance_m(view, box, stature_m), head_size(stature_m)
    from_m, ray = ray_through(view, middle_px(box))
    if view_angle_rad(view.camera, other.camera, from_m + apparent_m * ray) > WIDEST_RAD:
        return None
    half_px = _PATCH * size.height_m * box.size_px / (FACE_WIDTH * stature_m)
    found = swept_distance(
        view.stereo, other.stereo, middle_px(box), half_px, (NEAREST_M, FARTHEST_M),
        size.length_m,
    )  # fmt: skip
    if found is None:
        return None
    point_m = from_m + found.distance_m * ray
    return PlacedFace(point_m, found.sigma_m, Depth.STEREO, {}, found.distance_m / apparent_m)


def _tops(view: HeadView, stature_m: float) -> list[FaceBox]:
    """Heads at the top of the largest thing before the background, of the sizes that fit, the best first."""
    if not view.has_foreground:
        return []
    h, w = view.foreground.shape
    small = cv2.resize(view.foreground, (w // _SMALL, h // _SMALL), interpolation=cv2.INTER_AREA)
    _, labels, stats, _ = cv2.connectedComponentsWithStats((small > 127).astype(np.uint8))
    area = stats[1:, cv2.CC_STAT_AREA]
    if not len(area) or area.max() < _LEAST_SHARE * small.size:
        return []
    rows, columns = np.nonzero(labels == 1 + int(np.argmax(area)))
    top = int(rows.min())
    crown = np.array([columns[rows < top + _TOP_ROWS].mean(), top]) * _SMALL + 0.5 * (_SMALL - 1)
    return _fit_outlines(view, crown, stature_m)


def _fit_outlines(view: HeadView, crown: Floats, stature_m: float) -> list[FaceBox]:
    """Of heads at all distances with their crown there, the one that the foreground fits best."""
    size = head_size(stature_m)
    focal_px = float(view.camera.K[1, 1])
    depths_m = np.geomspace(NEAREST_M, FARTHEST_M, _DISTANCES)
    pixels = crown + np.stack([np.zeros(_DISTANCES), size.height_m * focal_px / depths_m], axis=-1)
    from_m, rays = ray_through(view, pixels)
    middles_m = np.ascontiguousarray(
        from_m + (depths_m / (rays @ view.camera.R[2]))[:, None] * rays
    )
    outline = ellipse_of(view.camera, middles_m[_DISTANCES // 2], size)
    if outline is None:
        return []
    score = np.empty(_DISTANCES)
    score_heads(
        middles_m, np.array([size.width_m, size.height_m]), INSIDE, OUTLINE, view.stereo.arrays,
        view.pixels, initial_colours().head_odds, 1.0, view.foreground, outline.up, score,
    )  # fmt: skip
    around = np.concatenate([[-np.inf], score, [-np.inf]])
    peaks = (score >= around[:-2]) & (score >= around[2:]) & (score > _LEAST_SCORE)
    places = np.flatnonzero(peaks)
    sides = FACE_WIDTH * stature_m * float(view.camera.K[0, 0]) / depths_m
    return [
        FaceBox(float(pixels[i, 0]), float(pixels[i, 1]), float(sides[i]))
        for i in places[np.argsort(-score[places])][:_TOPS]
    ]
