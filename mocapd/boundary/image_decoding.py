"""Decodes PNG and JPEG from outside, after checks of their size and work.

OpenCV allocates what a header or a chunk claims: 69 bytes that claim a chunk of 4 GB take 4 GB and nine seconds. So size,
length and work are limited here: no picture takes longer than a second or more than 300 MB, and libpng prints no
warnings.
"""

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from mocapd.boundary.jpeg_segments import JpegHeader, check_work, is_jpeg, jpeg_header
from mocapd.boundary.png_chunks import PngHeader, is_png, plain_png, png_header
from mocapd.errors import MalformedError
from mocapd.types import Bytes

MOST_PIXELS = 40_000_000  # limit without an expected size: somewhat above 8K
MOST_DRAWN_PIXELS = 3840 * 2160  # of a picture that a person drew strokes on, and of the strokes
MOST_FILE_BYTES = 64 << 20

REDUCTIONS = {
    1: cv2.IMREAD_COLOR, 2: cv2.IMREAD_REDUCED_COLOR_2, 4: cv2.IMREAD_REDUCED_COLOR_4, 8: cv2.IMREAD_REDUCED_COLOR_8,
}  # fmt: skip
"""The flags that decode a picture so many times smaller."""

# What a camera's file may have: noise at the best quality has 3 bytes a pixel.
_CAMERA_BYTES_PER_PIXEL, _CAMERA_SPARE_BYTES = 4, 64 << 10


@dataclass(frozen=True, slots=True)
class PictureHeader:
    """size_px: width, height; channels as stored; bits of each; detail: by its kind."""

    kind: Literal["png", "jpeg"]
    size_px: tuple[int, int]
    channels: int
    bits: int
    detail: PngHeader | JpegHeader


def read_header(data: bytes | memoryview) -> PictureHeader:
    """Parses the header of a PNG or JPEG. Raises MalformedError, also for impossible values."""
    data = memoryview(data)
    kind: Literal["png", "jpeg"]
    detail: PngHeader | JpegHeader
    if is_png(data):
        kind, detail = "png", png_header(data)
    elif is_jpeg(data):
        kind, detail = "jpeg", jpeg_header(data)
    else:
        raise MalformedError("is neither PNG nor JPEG")
    if min(detail.size_px) < 1:
        raise MalformedError("has no pixels")
    return PictureHeader(kind, detail.size_px, detail.channels, detail.bits, detail)


def is_plain_jpeg(data: bytes, size_px: tuple[int, int]) -> bool:
    """True for a JPEG of this size (width, height) that every browser shows: 8 bits, grey or colour, with its Huffman
    tables, which some webcams omit. Raises MalformedError."""
    header = read_header(data)
    return (
        isinstance(header.detail, JpegHeader)
        and header.size_px == size_px
        and header.bits == 8
        and header.channels in (1, 3)
        and header.detail.has_tables
    )


def decode_picture(
    data: bytes | Bytes,
    flags: int,
    size_px: tuple[int, int] | None = None,
    most_pixels: int = MOST_PIXELS,
    most_bits: int = 8,
) -> Bytes:
    """Decodes a PNG or JPEG as cv2.imdecode with these flags: (h,w,3) BGR or (h,w), uint8.

    `size_px`: required (width, height); without it, `most_pixels` is the limit. With more than 8 bits a
    channel, if `most_bits` permits them, the result has the upper 8. Raises MalformedError: no such
    picture, cut short, another size, more bits, more work than a picture of its size needs.
    """
    array = np.frombuffer(data, dtype=np.uint8)
    header = read_header(array.data)
    width, height = header.size_px
    if size_px is not None and header.size_px != size_px:
        raise MalformedError(f"has {width}x{height} pixels, wanted {size_px[0]}x{size_px[1]}")
    if width * height > most_pixels:
        raise MalformedError(f"has {width}x{height} pixels, at most {most_pixels} are read")
    if header.bits > most_bits:
        raise MalformedError(f"has {header.bits} bits a channel, wanted {most_bits}")
    if isinstance(header.detail, PngHeader):
        array = np.frombuffer(plain_png(array.data, header.detail), dtype=np.uint8)
    else:
        check_work(bytes(data), header.detail)
    try:
        picture = cv2.imdecode(array, flags)
    except cv2.error as error:
        raise MalformedError(f"cannot be decoded ({error.err})") from None
    if picture is None:
        raise MalformedError("is damaged or cut short")
    return np.asarray(picture, dtype=np.uint8)


def decode_camera_picture(
    data: bytes | Bytes, size_px: tuple[int, int] | None = None, flags: int = cv2.IMREAD_COLOR
) -> Bytes:
    """Decodes a camera's JPEG to (h,w,3) uint8 BGR, or as other flags say. size_px: as in `decode_picture`.

    Raises MalformedError, also for a file that is too large for its picture size.
    """
    array = np.frombuffer(data, dtype=np.uint8)
    if not is_jpeg(array.data):
        raise MalformedError("is no JPEG")
    width, height = jpeg_header(array.data).size_px
    most_bytes = _CAMERA_BYTES_PER_PIXEL * width * height + _CAMERA_SPARE_BYTES
    if len(array) > most_bytes:
        raise MalformedError(f"has {len(array)} bytes for {width}x{height} pixels")
    return decode_picture(data, flags, size_px)
