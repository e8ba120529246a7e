"""The sharpness of a picture of a board."""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.types import Bytes, Floats


def edge_sharpness(grey: Bytes, corners_px: Floats) -> float:
    """The rise of the steepest edges within the corners' box, in parts of the contrast per pixel.

    About 0.5 for the sharpest picture a lens gives, 0.1 for one in which edges are ten pixels
    wide; independent of the board's size in the picture and of the light. 0 without contrast.
    """
    height, width = grey.shape
    low = np.floor(np.maximum(corners_px.min(axis=0), 0)).astype(int)
    high = np.ceil(np.minimum(corners_px.max(axis=0), (width - 1, height - 1))).astype(int) + 1
    part = grey[low[1] : high[1], low[0] : high[0]].astype(np.float32)
    if min(part.shape) < 4:
        return 0.0
    dark, light = np.percentile(part, (5, 95))
    if light - dark < 8.0:
        return 0.0
    gx = cv2.Scharr(part, cv2.CV_32F, 1, 0) / 32.0
    gy = cv2.Scharr(part, cv2.CV_32F, 0, 1) / 32.0
    return float(np.percentile(np.hypot(gx, gy), 98) / (light - dark))
