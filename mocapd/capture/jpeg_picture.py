"""A camera's JPEG, decoded as it arrives to the size that is needed most, and whole where somebody asks.

A tracker computes on pictures of some 320 pixels width. The JPEG decoder makes a half, a quarter or an eighth of the size
in less than half the time of the whole picture, and averages as a filter would; the page and recordings take the file.
"""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.boundary.image_decoding import REDUCTIONS, decode_camera_picture
from mocapd.boundary.jpeg_segments import jpeg_header
from mocapd.capture.pixels import frozen_pixels
from mocapd.types import Bytes


class JpegPicture:
    """See CompressedPicture. From any thread: two that ask at once may both decode."""

    def __init__(
        self,
        encoded: bytes,
        small: Bytes,
        reduced_by: int = 1,
        size_px: tuple[int, int] | None = None,
    ) -> None:
        """small: decoded already, (h,w,3); size_px: width and height of the whole, None where `small` is that."""
        self.encoded, self.small, self.reduced_by = encoded, small, reduced_by
        h, w = small.shape[:2]
        self.size_px = (w, h) if size_px is None else size_px
        self._pixels = small if reduced_by == 1 else None
        self._grey: Bytes | None = None

    @property
    def pixels(self) -> Bytes:
        if self._pixels is None:
            self._pixels = frozen_pixels(decode_camera_picture(self.encoded))
        return self._pixels

    @property
    def grey(self) -> Bytes:
        if self._grey is None and self._pixels is None:
            self._grey = frozen_pixels(
                decode_camera_picture(self.encoded, flags=cv2.IMREAD_GRAYSCALE)
            )
        elif self._grey is None:
            self._grey = frozen_pixels(cv2.cvtColor(self.pixels, cv2.COLOR_BGR2GRAY))
        return self._grey


def read_jpeg(
    data: bytes | Bytes, size_px: tuple[int, int] | None = None, reduced_by: int = 1
) -> Bytes | JpegPicture:
    """A camera's JPEG for a `Frame`, decoded to `small`. size_px: required width and height.

    The file is copied, as it may lie in the driver's buffer; but of one larger than its pixels only these are kept, as most
    of it is no picture. Raises MalformedError, also for a file that is cut short: nothing is decoded in part.
    """
    small = frozen_pixels(decode_camera_picture(data, size_px, REDUCTIONS[reduced_by]))
    file = np.frombuffer(data, np.uint8)  # flat, whatever the shape of the buffer
    w, h = jpeg_header(file.data).size_px
    if len(file) > 3 * w * h:
        return small if reduced_by == 1 else frozen_pixels(decode_camera_picture(data, size_px))
    if small.shape[:2] != (-(-h // reduced_by), -(-w // reduced_by)):
        w, h = h, w  # one that says it was taken upright is turned by the decoder
    encoded = data if isinstance(data, bytes) else file.tobytes()
    return JpegPicture(encoded, small, reduced_by, (w, h))
