"""A soft visual hull: each camera's evidence that a point is the person's, summed over cameras as log-odds.

A hard intersection loses every point that one camera misses; votes of all but one camera add ghosts. Here a point's pixel has
log P(pixel | point is the person's) - log P(pixel | it is not). A point of the person's is foreground wherever it is in
view. Another point is foreground, too, where the person stands before or behind it, which a camera expects with
probability `covered`. So foreground is weak evidence, at most -log(covered), and certain background a veto.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.types import Camera, Floats, Singles
from mocapd.vision.hull.hull_kernels import sum_at_points
from mocapd.vision.hull.picture_stack import stack_pictures, stack_projections

CERTAIN = 50.0  # log-odds of a mask that is believed
COVERED = 0.4  # share of a camera's rays near a person that meet the person


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

    pixel_log_odds (h,w) of each camera, over its whole frame at any size. A camera without a point in view says
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
