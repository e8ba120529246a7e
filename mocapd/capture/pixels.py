"""What OpenCV hands out, as the pixels of a Frame, and the JPEG that they were decoded from."""

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
    """A camera's JPEG file beside the pixels decoded from it: the one copy that outlives the buffer.

    None for one that takes more than its pixels: what such a file holds is no picture.
    """
    return buffer.tobytes() if buffer.nbytes <= pixels.nbytes else None
