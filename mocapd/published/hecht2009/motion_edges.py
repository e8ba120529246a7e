"""Motion and edges: the two evidence pictures of [Hecht et al. 2009, section III].

All work on pictures averaged down to a work size; buffers are allocated once and overwritten.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.published.hecht2009.edge_kernels import FULL, mark_edges
from mocapd.types import Bytes

_MOTION_STEP = 4  # work pixels to one of the motion image


@dataclass(frozen=True, slots=True)
class MotionEdgeParams:
    """Thresholds in grey levels 0..255 of the work picture, blurs in pixels of their picture."""

    # Two frames of a webcam differ by 2 to 3 from noise alone, averaged over 2x2 pixels: five times that.
    least_difference: int = 14
    # of Sobel's two derivatives together: a step of 9, dark trousers on a dark floor
    least_gradient: int = 36
    still_share: float = 0.6  # of an edge that does not move, against one that does
    edge_blur_px: float = 2.0  # how far off an outline may be drawn and still say something
    # a straight edge's peak is some 0.65 of what is marked after that blur: back to one and beyond
    edge_gain: float = 2.0
    motion_blur_px: float = 2.5  # of the motion image: 10 work pixels, a hand's breadth at 2.5 m


@dataclass(frozen=True, slots=True, eq=False)
class WorkPicture:
    """colour (h,w,3) BGR and grey (h,w) of a picture averaged down."""

    colour: Bytes
    grey: Bytes

    @classmethod
    def allocate(cls, height: int, width: int) -> "WorkPicture":
        """Of that size, black."""
        return cls(np.zeros((height, width, 3), np.uint8), np.zeros((height, width), np.uint8))

    def fill(self, pixels: Bytes) -> None:
        """Average a camera's picture (H,W,3) down to this size."""
        h, w = self.grey.shape
        cv2.resize(pixels, (w, h), dst=self.colour, interpolation=cv2.INTER_AREA)
        cv2.cvtColor(self.colour, cv2.COLOR_BGR2GRAY, dst=self.grey)


@dataclass(frozen=True, slots=True, eq=False)
class MotionEdges:
    """Evidence of one camera at work size (h,w), overwritten by `fill`.

    edges (h,w,3): strength (0 far from any edge, FULL and more on a clear moving one, less on a still one or near one),
    and strength times cosine and sine of twice the gradient's angle; motion (h/4,w/4): 255 where everything around
    changed; `difference`, `marked`, `changed`: scratch.
    """

    edges: NDArray[np.int16]
    motion: Bytes
    difference: Bytes
    marked: NDArray[np.int16]
    changed: Bytes

    @classmethod
    def allocate(cls, height: int, width: int) -> "MotionEdges":
        """For work pictures of that size."""
        edges, marked = (np.zeros((height, width, 3), np.int16) for _ in range(2))
        difference, changed = (np.zeros((height, width), np.uint8) for _ in range(2))
        small = np.zeros((-(-height // _MOTION_STEP), -(-width // _MOTION_STEP)), np.uint8)
        return cls(edges, small, difference, marked, changed)

    def fill(self, grey: Bytes, previous: Bytes | None, params: MotionEdgeParams) -> None:
        """From the grey work picture (h,w) and the previous one; None: no motion."""
        if previous is None:
            self.difference[:] = 0
        else:
            cv2.absdiff(grey, previous, dst=self.difference)
        edge_image(grey, self.difference, params, self.marked, self.edges)
        motion_image(self.difference, params, self.changed, self.motion)


def edge_image(
    grey: Bytes,
    difference: Bytes,
    params: MotionEdgeParams,
    marked: NDArray[np.int16],
    out: NDArray[np.int16],
) -> None:
    """out (h,w,3): blurred combination of thresholded gradient and thresholded difference; marked (h,w) is scratch.

    A gradient counts whether it moves or not, a difference only on a gradient: what moves uncovers a background that has
    not moved, and light that changes changes everything.
    """
    dx, dy = (np.asarray(of, np.int16) for of in cv2.spatialGradient(grey))
    full = round(FULL * params.edge_gain)
    still = round(full * params.still_share)
    mark_edges(
        dx, dy, difference, params.least_gradient, params.least_difference, full, still, marked
    )  # fmt: skip
    cv2.GaussianBlur(marked, (0, 0), params.edge_blur_px, dst=out)


def motion_image(difference: Bytes, params: MotionEdgeParams, changed: Bytes, out: Bytes) -> None:
    """out (h/4,w/4): the thresholded difference averaged down and blurred heavily; changed (h,w) is scratch."""
    cv2.threshold(difference, params.least_difference - 1, 255, cv2.THRESH_BINARY, dst=changed)
    small = cv2.resize(changed, (out.shape[1], out.shape[0]), interpolation=cv2.INTER_AREA)
    cv2.GaussianBlur(small, (0, 0), params.motion_blur_px, dst=out)
