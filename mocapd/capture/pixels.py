"""Converts OpenCV's buffers to the pixels of a Frame and the JPEG that they were decoded from."""

import numpy as np

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

from cv2.typing import MatLike

from mocapd.types import Bytes


def frozen_pixels(image: MatLike) -> Bytes:
    """The same memory as C-contiguous uint8, read-only from here on: several threads will look at it."""
    pixels = np.ascontiguousarray(image, dtype=np.uint8)
    pixels.setflags(write=False)
    return pixels


def delivered_jpeg(buffer: MatLike, pixels: Bytes) -> bytes | None:
    """A copy of a camera's JPEG file, which outlives the driver's buffer.

    None for a file larger than its pixels: most of it is no picture.
    """
    return buffer.tobytes() if buffer.nbytes <= pixels.nbytes else None
