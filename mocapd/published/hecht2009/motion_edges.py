"""Motion and edges: the two evidence pictures of [Hecht et al. 2009, section III], at work size."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.published.hecht2009.edge_kernels import FULL, mark_edges
from mocapd.types import Bytes

_MOTION_STEP = 4  # work pixels to one of the motion image
# Thresholds in grey levels 0..255 of the work picture, blurs in pixels of their picture.
# Two frames of a webcam differ by 2 to 3 from noise alone, averaged over 2x2 pixels: five times that.
_LEAST_DIFFERENCE = 14
# of Sobel's two derivatives together: a step of 9, dark trousers on a dark floor
_LEAST_GRADIENT = 36
_STILL_SHARE = 0.6  # of an edge that does not move, against one that does
_EDGE_BLUR_PX = 2.0  # how far off an outline may be drawn and still say something
# a straight edge's peak is some 0.65 of what is marked after that blur: back to one and beyond
_MARKED = round(2.0 * FULL)
_MOTION_BLUR_PX = 2.5  # of the motion image: 10 work pixels, a hand's breadth at 2.5 m


@dataclass(frozen=True, slots=True, eq=False)
class WorkPicture:
    """colour (h,w,3) BGR and grey (h,w) of a picture averaged down."""

    colour: Bytes
    grey: Bytes


def work_picture(pixels: Bytes, size_px: tuple[int, int]) -> WorkPicture:
    """A camera's picture (H,W,3) averaged down to this width and height."""
    colour = np.asarray(cv2.resize(pixels, size_px, interpolation=cv2.INTER_AREA), np.uint8)
    return WorkPicture(colour, np.asarray(cv2.cvtColor(colour, cv2.COLOR_BGR2GRAY), np.uint8))


@dataclass(frozen=True, slots=True, eq=False)
class MotionEdges:
    """Evidence of one camera at work size (h,w).

    edges (h,w,3): strength (0 far from any edge, FULL and more on a clear moving one, less on a still one or near one),
    and strength times cosine and sine of twice the gradient's angle; motion (h/4,w/4): 255 where everything around
    changed.
    """

    edges: NDArray[np.int16]
    motion: Bytes


def motion_edges(grey: Bytes, previous: Bytes | None) -> MotionEdges:
    """From the grey work picture (h,w) and the previous one; None: no motion."""
    difference = cv2.absdiff(grey, grey if previous is None else previous)
    changed = np.asarray(difference, np.uint8)
    return MotionEdges(_edge_image(grey, changed), _motion_image(changed))


def _edge_image(grey: Bytes, difference: Bytes) -> NDArray[np.int16]:
    """(h,w,3): blurred combination of thresholded gradient and thresholded difference.

    A gradient counts whether it moves or not, a difference only on a gradient: what moves uncovers a background that has
    not moved, and light that changes changes everything.
    """
    dx, dy = (np.asarray(of, np.int16) for of in cv2.spatialGradient(grey))
    still = round(_MARKED * _STILL_SHARE)
    marked = np.empty((*grey.shape, 3), np.int16)
    mark_edges(dx, dy, difference, _LEAST_GRADIENT, _LEAST_DIFFERENCE, _MARKED, still, marked)
    return np.asarray(cv2.GaussianBlur(marked, (0, 0), _EDGE_BLUR_PX), np.int16)


def _motion_image(difference: Bytes) -> Bytes:
    """(h/4,w/4): the thresholded difference averaged down and blurred heavily."""
    h, w = difference.shape
    _, changed = cv2.threshold(difference, _LEAST_DIFFERENCE - 1, 255, cv2.THRESH_BINARY)
    size = -(-w // _MOTION_STEP), -(-h // _MOTION_STEP)
    small = cv2.resize(changed, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.GaussianBlur(small, (0, 0), _MOTION_BLUR_PX), np.uint8)
