"""Points of the visual hull in O(n) of n cameras: rays of one camera, clipped against the silhouettes of the others.

Rao and Hodges, Interactive marker-less tracking of human limbs, section 7, after Matusik et al. 2001: a ray through each
grid point of one silhouette is clipped along its epipolar lines in the other pictures, and the parts that are inside all
silhouettes get points in proportion to their length.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.geometry.camera_model import rays
from mocapd.types import Bytes, Camera, Floats, Ints
from mocapd.vision.hull.hull_kernels import clip_rays
from mocapd.vision.hull.picture_stack import stack_pictures, stack_projections

_MOST_INTERVALS = 8  # of a ray: a body has four limbs


@dataclass(frozen=True, slots=True)
class RayHullParams:
    """rays: about how many; points: how many at most; step_px: along epipolar lines, of the silhouettes."""

    rays: int = 800
    points: int = 1500
    step_px: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class RayIntervals:
    """Parts of rays that are inside every silhouette. own: the camera whose rays they are; eye_m (3,), ways (N,3) of
    length 1; intervals_m (N,K,2): distances from the eye, of which the first counts (N,) are valid."""

    own: int
    eye_m: Floats
    ways: Floats
    intervals_m: Floats
    counts: Ints


def ray_hull(
    cameras: Sequence[Camera],
    silhouettes: Sequence[Bytes],
    box_m: Floats,
    params: RayHullParams | None = None,
) -> RayIntervals:
    """Clip the rays of the camera with the largest silhouette.

    silhouettes (h,w): 0 is background; each shows its camera's whole frame at any size. box_m (2,3): lower and upper
    corner of the space that is looked at [m, world]. No rays without a camera or without foreground.
    """
    p = params if params is not None else RayHullParams()
    areas = [int(np.count_nonzero(mask)) * (1e6 / mask.size) for mask in silhouettes]
    if not areas or max(areas) == 0.0:
        none = np.empty((0, 3))
        return RayIntervals(
            0, np.zeros(3), none, np.empty((0, _MOST_INTERVALS, 2)), np.empty(0, int)
        )
    own = int(np.argmax(areas))
    pixels = _grid(silhouettes[own], p.rays, cameras[own])
    eye, ways = rays(cameras[own], pixels)
    reach = _within_box(eye, ways, box_m)
    intervals = np.empty((len(ways), _MOST_INTERVALS, 2))
    counts = np.zeros(len(ways), np.int64)
    masks = np.asarray(stack_pictures(silhouettes), np.uint8)
    sizes = [(mask.shape[1], mask.shape[0]) for mask in silhouettes]
    clip_rays(
        eye, np.ascontiguousarray(ways), reach, own, masks, *stack_projections(cameras, sizes), p.step_px, intervals,
        counts,
    )  # fmt: skip
    return RayIntervals(own, eye, ways, intervals, counts)


def points_on(hull: RayIntervals, most: int) -> Floats:
    """(P,3) [m, world]: points at even distances along all intervals laid end to end, so that each interval has as many as
    its length deserves; P is `most`, or 0 where the hull is empty."""
    valid = np.arange(hull.intervals_m.shape[1]) < hull.counts[:, None]
    spans = hull.intervals_m[valid]
    ray = np.nonzero(valid)[0]
    ends = np.cumsum(spans[:, 1] - spans[:, 0])
    if len(ends) == 0 or ends[-1] <= 0.0:
        return np.empty((0, 3))
    along = (np.arange(most) + 0.5) * (ends[-1] / most)
    which = np.minimum(np.searchsorted(ends, along), len(ends) - 1)
    at_m = spans[which, 1] - (ends[which] - along)
    points: Floats = hull.eye_m + at_m[:, None] * hull.ways[ray[which]]
    return points


def hull_points(
    cameras: Sequence[Camera],
    silhouettes: Sequence[Bytes],
    box_m: Floats,
    params: RayHullParams | None = None,
) -> Floats:
    """Points (P,3) [m, world] inside the visual hull within box_m; see `ray_hull` and `points_on`."""
    p = params if params is not None else RayHullParams()
    return points_on(ray_hull(cameras, silhouettes, box_m, p), p.points)


def _grid(mask: Bytes, wanted: int, camera: Camera) -> Floats:
    """Frame pixels (N,2) of about so many foreground pixels of a mask (h,w), on a square grid."""
    stride = max(1, int(np.sqrt(np.count_nonzero(mask) / wanted)))
    rows, columns = np.nonzero(mask[stride // 2 :: stride, stride // 2 :: stride])
    xy = np.stack([columns, rows], axis=-1) * stride + stride // 2
    scale = np.array(camera.size_px) / (mask.shape[1], mask.shape[0])
    pixels: Floats = (xy + 0.5) * scale - 0.5
    return pixels


def _within_box(eye_m: Floats, ways: Floats, box_m: Floats) -> Floats:
    """Where (N,2) rays enter and leave a box (2,3) [m]; the first is the greater where they miss it."""
    safe = np.where(np.abs(ways) < 1e-12, 1e-12, ways)
    crossings = (box_m[:, None] - eye_m) / safe
    enter, leave = crossings.min(axis=0).max(axis=1), crossings.max(axis=0).min(axis=1)
    return np.stack([np.maximum(enter, 0.0), leave], axis=-1)
