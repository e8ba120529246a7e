"""PNG and JPEG from outside: measured by their headers before anything is decoded.

OpenCV allocates what a header or a chunk claims: 69 bytes that speak of a chunk of 4 GB take 4 GB and
nine seconds. So the size is read here, compared with what is wanted, and every length with the data.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from mocapd.errors import MalformedError
from mocapd.types import Bytes

MOST_PIXELS = 40_000_000  # of a picture whose size is not known before: somewhat above 8K
MOST_FILE_BYTES = 64 << 20

_PNG = b"\x89PNG\r\n\x1a\n"
_PNG_CHANNELS = {0: 1, 2: 3, 3: 3, 4: 2, 6: 4}  # by colour type; 3: a palette, decoded as colour
_JPEG = b"\xff\xd8"
_SOF = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # start of frame; not tables
_DHT, _SOS, _EOI = 0xC4, 0xDA, 0xD9
_ALONE = frozenset({0x01, *range(0xD0, 0xD9)})  # markers without a length
_MOST_STRAY = 1024  # bytes between segments, which some webcams leave and decoders skip


@dataclass(frozen=True, slots=True)
class PictureHeader:
    """size_px: width, height; channels as stored; bits of each."""

    kind: Literal["png", "jpeg"]
    size_px: tuple[int, int]
    channels: int
    bits: int


def read_header(data: bytes | memoryview) -> PictureHeader:
    """What a PNG or JPEG says of itself. Raises MalformedError, also when it says what cannot be."""
    data = memoryview(data)
    if data[: len(_PNG)] == _PNG:
        header = _png_header(data)
    elif data[: len(_JPEG)] == _JPEG:
        header = _jpeg_header(data)
    else:
        raise MalformedError("is neither PNG nor JPEG")
    if min(header.size_px) < 1:
        raise MalformedError("has no pixels")
    return header


def is_plain_jpeg(data: bytes, size_px: tuple[int, int]) -> bool:
    """Whether it is a JPEG of this size (width, height) that every browser shows: of 8 bits, grey or colour,
    with its Huffman tables, which some webcams leave out. Raises MalformedError."""
    header = read_header(data)
    return (
        header.kind == "jpeg"
        and header.size_px == size_px
        and header.bits == 8
        and header.channels in (1, 3)
        and any(marker == _DHT for marker, _ in _jpeg_segments(memoryview(data)))
    )


def decode_picture(
    data: bytes | Bytes,
    flags: int,
    size_px: tuple[int, int] | None = None,
    most_pixels: int = MOST_PIXELS,
    most_bits: int = 8,
) -> Bytes:
    """A PNG or JPEG as cv2.imdecode with these flags has it: (h,w,3) BGR or (h,w), uint8.

    `size_px` (width, height) is what it must have; without it, `most_pixels` is the limit. Of more than
    8 bits a channel, where `most_bits` lets it in, the upper 8 are given. Raises MalformedError: no such
    picture, cut short, another size, more bits.
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
    try:
        picture = cv2.imdecode(array, flags)
    except cv2.error as error:
        raise MalformedError(f"cannot be decoded ({error.err})") from None
    if picture is None:
        raise MalformedError("is damaged or cut short")
    return np.asarray(picture, dtype=np.uint8)


def _png_header(data: memoryview) -> PictureHeader:
    header: PictureHeader | None = None
    at = len(_PNG)
    while True:
        if at + 12 > len(data):
            raise MalformedError("is cut short")
        length = int.from_bytes(data[at : at + 4], "big")
        name = bytes(data[at + 4 : at + 8])
        if at + 12 + length > len(data):
            raise MalformedError("has a chunk that is longer than the file")
        if header is None:
            if name != b"IHDR" or length != 13:
                raise MalformedError("does not begin with its header")
            width, height, bits, colour = struct.unpack(">IIBB", data[at + 8 : at + 18])
            if colour not in _PNG_CHANNELS:
                raise MalformedError(f"has the unknown colour type {colour}")
            header = PictureHeader("png", (width, height), _PNG_CHANNELS[colour], bits)
        elif name == b"acTL":
            raise MalformedError("is animated")
        elif name == b"IEND":
            return header
        at += 12 + length


def _jpeg_header(data: memoryview) -> PictureHeader:
    for marker, segment in _jpeg_segments(data):
        if marker in _SOF:
            if len(segment) < 6:
                raise MalformedError("has a frame header that is cut short")
            bits, height, width, channels = struct.unpack(">BHHB", segment[:6])
            return PictureHeader("jpeg", (width, height), channels, bits)
    raise MalformedError("has no frame header")


def _jpeg_segments(data: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Marker and content of every segment before the compressed picture."""
    at, stray = len(_JPEG), 0
    while at + 4 <= len(data):
        marker = data[at + 1]
        if data[at] != 0xFF or marker in (0x00, 0xFF):  # fill bytes may stand before a marker
            at, stray = at + 1, stray + 1
            if stray > _MOST_STRAY:
                return
            continue
        if marker in (_SOS, _EOI):
            return
        if marker in _ALONE:
            at += 2
            continue
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if length < 2 or at + 2 + length > len(data):
            raise MalformedError("has a segment that is longer than the file")
        yield marker, data[at + 4 : at + 2 + length]
        at += 2 + length
