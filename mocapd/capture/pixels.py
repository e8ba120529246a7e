"""Converts OpenCV's buffers to the pixels of a Frame."""

import numpy as np

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

from cv2.typing import MatLike

from mocapd.types import Bytes


def frozen_pixels(image: MatLike) -> Bytes:
    """The same memory as C-contiguous uint8, read-only from here on: several threads will look at it."""
    pixels = np.ascontiguousarray(image, dtype=np.uint8)
    pixels.setflags(write=False)
    return pixels
