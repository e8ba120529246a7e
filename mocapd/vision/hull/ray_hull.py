"""Points of the visual hull in O(n) of n cameras: rays of one camera, clipped against the silhouettes of the others.

Rao and Hodges, Interactive marker-less tracking of human limbs, section 7, after Matusik et al. 2001: a ray through each
grid point of one silhouette is clipped along its epipolar lines in the other pictures, and the parts that are inside all
silhouettes get points in proportion to their length.

The soft hull (`carve_log_odds`) sums each camera's evidence that a point is the person's over cameras, as log-odds. A hard
intersection loses every point that one camera misses; votes of all but one camera add ghosts. There a point's pixel has
log P(pixel | point is the person's) - log P(pixel | it is not). A point of the person's is foreground wherever it is in
view. Another point is foreground, too, where the person stands before or behind it, which a camera expects with
probability `covered`. So foreground is weak evidence, at most -log(covered), and certain background a veto.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.geometry.camera_model import project, rays
from mocapd.types import Bytes, Camera, Floats, Ints, Singles
from mocapd.vision.hull.hull_kernels import clip_rays, sum_at_points
from mocapd.vision.hull.picture_stack import block_px, stack_pictures, stack_projections

_MOST_INTERVALS = 8  # of a ray: a body has four limbs
CERTAIN = 50.0  # log-odds of a mask that is believed
COVERED = 0.4  # share of a camera's rays near a person that meet the person


@dataclass(frozen=True, slots=True)
class RayHullParams:
    """rays: about how many; points: how many at most; step_px: along epipolar lines, of the silhouettes."""

    rays: int = 800
    points: int = 1500
    step_px: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class RayIntervals:
    """Parts of rays that are inside every silhouette. own: index of their camera; eye_m (3,), ways (N,3) of
    length 1; ray_sr: the solid angle that each stands for; intervals_m (N,K,2): distances from the eye, of which the first
    counts (N,) are valid."""

    own: int
    ray_sr: float
    eye_m: Floats
    ways: Floats
    intervals_m: Floats
    counts: Ints


@dataclass(frozen=True, slots=True, eq=False)
class HullPoints:
    """points_m (P,3) [m, world] and volumes_m3 (P,), of how much of the hull each stands for."""

    points_m: Floats
    volumes_m3: Floats

    def where(self, which: NDArray[np.bool_]) -> "HullPoints":
        """Some of them (P,)."""
        return HullPoints(self.points_m[which], self.volumes_m3[which])


def ray_hull(
    cameras: Sequence[Camera],
    silhouettes: Sequence[Bytes],
    box_m: Floats,
    params: RayHullParams | None = None,
) -> RayIntervals:
    """Clip the rays of the camera with the largest silhouette.

    silhouettes (h,w): 0 is background; each of the size of its camera's work picture. box_m (2,3): lower and upper
    corner of the space that is looked at [m, world]. No rays without a camera or without foreground.
    """
    p = params if params is not None else RayHullParams()
    areas = [int(np.count_nonzero(mask)) * (1e6 / mask.size) for mask in silhouettes]
    if not areas or max(areas) == 0.0:
        none = np.empty((0, 3))
        return RayIntervals(
            0, 0.0, np.zeros(3), none, np.empty((0, _MOST_INTERVALS, 2)), np.empty(0, int)
        )
    own = int(np.argmax(areas))
    pixels, pixel_sr = _grid(silhouettes[own], p.rays, cameras[own])
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
    return RayIntervals(own, pixel_sr, eye, ways, intervals, counts)


def points_on(hull: RayIntervals, most: int) -> HullPoints:
    """Points at even distances along all intervals laid end to end, so that each interval has as many as its length deserves:
    `most` of them, or none where the hull is empty."""
    valid = np.arange(hull.intervals_m.shape[1]) < hull.counts[:, None]
    spans = hull.intervals_m[valid]
    ray = np.nonzero(valid)[0]
    ends = np.cumsum(spans[:, 1] - spans[:, 0])
    if len(ends) == 0 or ends[-1] <= 0.0:
        return HullPoints(np.empty((0, 3)), np.empty(0))
    apart_m = float(ends[-1]) / most
    along = (np.arange(most) + 0.5) * apart_m
    which = np.minimum(np.searchsorted(ends, along), len(ends) - 1)
    at_m = spans[which, 1] - (ends[which] - along)
    points = hull.eye_m + at_m[:, None] * hull.ways[ray[which]]
    return HullPoints(points, at_m**2 * (hull.ray_sr * apart_m))


def hull_points(
    cameras: Sequence[Camera],
    silhouettes: Sequence[Bytes],
    box_m: Floats,
    params: RayHullParams | None = None,
) -> HullPoints:
    """Points inside the visual hull within box_m; see `ray_hull` and `points_on`."""
    p = params if params is not None else RayHullParams()
    return points_on(ray_hull(cameras, silhouettes, box_m, p), p.points)


def box_about(middle_m: Floats, half_width_m: float, low_m: float, high_m: float) -> Floats:
    """(2,3) lower and upper corner of the space about a place, between two heights [m, world]."""
    half = np.array([half_width_m, 0.0, half_width_m])
    box = middle_m + np.stack([-half, half])
    box[:, 1] = low_m, high_m
    return np.asarray(box)


def views_of(cameras: Sequence[Camera], points_m: Floats) -> Ints:
    """(P,) how many cameras have points (P,3) [m, world] in view."""
    count = np.zeros(len(points_m), np.int64)
    for camera in cameras:
        at = np.nan_to_num(project(camera, points_m), nan=-1e6)
        count += ((at >= -0.5) & (at < np.array(camera.size_px) - 0.5)).all(axis=-1)
    return count


def _grid(mask: Bytes, wanted: int, camera: Camera) -> tuple[Floats, float]:
    """Frame pixels (N,2) of about so many foreground pixels of a mask (h,w), on a square grid, and the solid angle of a cell
    of the grid in the middle of the picture [sr]."""
    stride = max(1, int(np.sqrt(np.count_nonzero(mask) / wanted)))
    rows, columns = np.nonzero(mask[stride // 2 :: stride, stride // 2 :: stride])
    xy = np.stack([columns, rows], axis=-1) * stride + stride // 2
    scale = block_px(camera, (mask.shape[1], mask.shape[0]))
    cell = stride * scale / camera.K[[0, 1], [0, 1]]
    pixels = np.asarray((xy + 0.5) * scale - 0.5, np.float64)
    return pixels, float(cell.prod())


def _within_box(eye_m: Floats, ways: Floats, box_m: Floats) -> Floats:
    """Where (N,2) rays enter and leave a box (2,3) [m]; the first is the greater where they miss it."""
    safe = np.where(np.abs(ways) < 1e-12, 1e-12, ways)
    crossings = (box_m[:, None] - eye_m) / safe
    enter, leave = crossings.min(axis=0).max(axis=1), crossings.max(axis=0).min(axis=1)
    return np.stack([np.maximum(enter, 0.0), leave], axis=-1)


def point_log_odds(pixel_log_odds: Singles, covered: float = COVERED) -> Singles:
    """What pixels (h,w), of these log-odds to be foreground, say of a point that they show."""
    # in single precision; logaddexp takes no exponential that overflows
    background = np.float32(np.log1p(-covered)) - pixel_log_odds
    out: Singles = -np.logaddexp(np.float32(np.log(covered)), background)
    return out


def carve_log_odds(
    cameras: Sequence[Camera],
    pixel_log_odds: Sequence[Singles],
    points_m: Floats,
    covered: float = COVERED,
) -> Singles:
    """Log-odds (P,) that points (P,3) [m, world] are the person's; one belongs to the hull where they exceed a threshold,
    0 for even odds.

    pixel_log_odds (h,w) of each camera, of the size of its work picture. A camera without a point in view says
    nothing of it; -inf for a point that fewer than two cameras see.
    """
    maps = np.asarray(
        stack_pictures([point_log_odds(one, covered) for one in pixel_log_odds]), np.float32
    )
    sizes = [(one.shape[1], one.shape[0]) for one in pixel_log_odds]
    sums, views = np.empty(len(points_m), np.float32), np.empty(len(points_m), np.uint8)
    sum_at_points(
        np.ascontiguousarray(points_m), maps, *stack_projections(cameras, sizes), 0.0, sums, views
    )
    sums[views < 2] = -np.inf
    return sums


def voxel_centres(box_m: Floats, side_m: float) -> tuple[Floats, tuple[int, int, int]]:
    """Centres (P,3) of the cubes of this side that fill a box (2,3) [m, world], the last axis fastest, and how many there
    are along each axis."""
    counts = np.maximum(np.round((box_m[1] - box_m[0]) / side_m).astype(int), 1)
    axes = [low + side_m * (np.arange(n) + 0.5) for low, n in zip(box_m[0], counts, strict=True)]
    centres: Floats = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return centres, (int(counts[0]), int(counts[1]), int(counts[2]))
