"""A user's sloppy strokes on a picture, made from the exact labels."""

import cv2
import numpy as np

from mocapd.shirt.standard_shirt import N_PATCHES, standard_shirt
from mocapd.types import Bytes

_MARGIN_PX = 2  # users stay off the borders, more or less
_LEAST_PX = 40  # patches smaller than this are left out


def scribble(patch: Bytes, rng: np.random.Generator) -> Bytes:
    """Strokes (H,W) of colour ids over the visible patches (H,W) 0..20: a zigzag in each."""
    out = np.zeros_like(patch)
    colour_of = standard_shirt().colour_of_patch
    kernel = np.ones((2 * _MARGIN_PX + 1, 2 * _MARGIN_PX + 1), dtype=np.uint8)
    for index in range(1, N_PATCHES + 1):
        inside = cv2.erode((patch == index).astype(np.uint8), kernel)
        y, x = np.nonzero(inside)
        if len(x) < _LEAST_PX:
            continue
        corners = _zigzag(np.stack([x, y], axis=-1), rng)
        drawn = np.zeros_like(patch)
        cv2.polylines(drawn, [corners], False, 1, thickness=3)
        out[(drawn > 0) & (inside > 0)] = colour_of[index]
    # the hand slips a pixel
    slip = rng.integers(-1, 2, size=2)
    return np.roll(out, (int(slip[0]), int(slip[1])), axis=(0, 1))


def _zigzag(points: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A few of the points (N,2) x, y, ordered along the region's long side: (M,2) int32."""
    centre = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - centre, full_matrices=False)
    along, across = (points - centre) @ axes[0], (points - centre) @ axes[1]
    stops = np.quantile(along, np.linspace(0.08, 0.92, int(rng.integers(5, 8))))
    corners = []
    for i, stop in enumerate(stops):
        away = np.abs(along - stop)
        near = np.flatnonzero(away <= max(1.5, 0.05 * np.ptp(along), away.min()))
        side = across[near] * (1 if i % 2 else -1)
        # not to the very edge: somewhere in the outer half of this side
        choice = near[np.argsort(side)[int(rng.uniform(0.7, 0.95) * (len(near) - 1))]]
        corners.append(points[choice])
    return np.array(corners, dtype=np.int32)
