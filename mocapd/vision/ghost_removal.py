"""Ghost removal: a person learned as background leaves a false foreground where they stood.

A ghost has edges along its outline in the background and none in the picture (Cucchiara et al. 2003).
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Singles
from mocapd.vision.foreground_kernels import UNKNOWN, stands

_OUTLINE = np.ones((3, 3), np.uint8)
_BODY_EDGE = np.ones((7, 7), np.uint8)  # edges within half of this belong to the body


@dataclass(frozen=True, slots=True)
class GhostParams:
    """Sizes and thresholds of the ghost test."""

    least_px: int = 60  # of a piece to test
    # of a piece with an arm in it: least length of its outline, and most edges as a share of the background's
    arm_outline_px: int = 100
    arm_edges: float = 0.6


def find_ghosts(
    picture: Bytes,
    background: Bytes,
    before: Bytes,
    body: Bytes,
    arms: Bytes,
    params: GhostParams,
) -> NDArray[np.bool_]:
    """Where ghosts are (h,w): foreground pieces with stronger edges along the outline in the background
    than in the picture (h,w,3 each).

    before (h,w): as of `stands_before`. Pieces within body (h,w) do not count, but for its arms (h,w), which the fit may have
    put on a ghost.
    """
    there = stands(before)
    if not there.any():
        return there
    body = np.where(before == UNKNOWN, np.uint8(1), body)  # the room has no edges there
    p, pictures = params, (picture, background)
    with_arms = np.zeros_like(there)
    if arms.any():
        trunk = np.where(arms > 0, np.uint8(0), body)
        with_arms = _ghosts(there, trunk, pictures, p.least_px, p.arm_outline_px, p.arm_edges)
    return with_arms | _ghosts(there & ~with_arms, body, pictures, p.least_px, 0, 1.0)


def _ghosts(
    there: NDArray[np.bool_],
    body: Bytes,
    pictures: tuple[Bytes, Bytes],
    least_px: int,
    least_outline_px: int,
    share: float,
) -> NDArray[np.bool_]:
    """Ghosts (h,w) among the pieces outside the body; pictures (h,w,3): now and background. A ghost's outline has less than
    this share of the background's edges now."""
    out = np.zeros_like(there)
    # this algorithm takes a third of the time of the usual one
    n, numbered, stats, _ = cv2.connectedComponentsWithStatsWithAlgorithm(
        (there & (body == 0)).astype(np.uint8), 8, cv2.CV_32S, cv2.CCL_BBDT
    )
    away = cv2.dilate(body, _BODY_EDGE) == 0
    for k in range(1, n):
        if stats[k, cv2.CC_STAT_AREA] < least_px:
            continue
        x, y, w, h = stats[k, : cv2.CC_STAT_AREA].tolist()
        # an outline is a pixel wide, and what edges are there depends on one more
        about = np.s_[max(y - 2, 0) : y + h + 2, max(x - 2, 0) : x + w + 2]
        mask = (numbered[about] == k).astype(np.uint8)
        outline = (cv2.morphologyEx(mask, cv2.MORPH_GRADIENT, _OUTLINE) > 0) & away[about]
        if outline.sum() >= least_outline_px:
            now, room = (brightness_edges(image[about])[outline].sum() for image in pictures)
            out[about] |= (mask > 0) & (now < share * room)
    return out


def brightness_edges(picture: Bytes) -> Singles:
    """Gradient magnitude (L1) of the brightness at each pixel (h,w) of a picture (h,w,3)."""
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    across, down = (cv2.Sobel(grey, cv2.CV_32F, dx, 1 - dx) for dx in (1, 0))
    return np.asarray(np.abs(across) + np.abs(down), np.float32)
