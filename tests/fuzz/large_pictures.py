"""Pictures that cost much: of the size they should have, and with more work, words or bytes in them than a picture has."""

import math
import struct
import zlib
from collections.abc import Callable
from functools import cache
from random import Random

import cv2
import numpy as np

from tests.fuzz.damaged_pictures import jpeg, png, sample

MOST_BYTES = 8_000_000  # what a camera node may send
_COMMENT = b"\xff\xfe\x00\x02"
_CHUNKS = (b"zTXt", b"tIME", b"cHRM", b"pHYs", b"tEXt", b"iCCP", b"gAMA", b"zzzz", b"PLTE", b"tRNS")


def many_segments(size_px: tuple[int, int], count: int, segment: bytes = _COMMENT) -> bytes:
    """A JPEG with one segment repeated before its picture."""
    good = jpeg(sample(size_px))
    return good[:2] + segment * count + good[2:]


def many_late_segments(size_px: tuple[int, int], count: int) -> bytes:
    """A JPEG with comments between its two scans."""
    whole = progressive(size_px)
    at = whole.rindex(b"\xff\xda")
    return whole[:at] + _COMMENT * count + whole[at:]


def many_scans(size_px: tuple[int, int], count: int, scan: bytes | None = None) -> bytes:
    """A progressive JPEG whose last scan, or another one, is repeated."""
    whole = progressive(size_px)
    scan = whole[whole.rindex(b"\xff\xda") : -2] if scan is None else scan
    return whole[:-2] + scan * count + whole[-2:]


def short_scan(low: int = 1, high: int = 63, bits: int = 0x10, component: int = 1) -> bytes:
    """Twelve bytes: the header of a scan of one component, and hardly any data, which decoders take for zeros."""
    return b"\xff\xda\x00\x08\x01" + bytes((component, 0, low, high, bits)) + bytes(2)


@cache
def progressive(size_px: tuple[int, int], quality: int = 95) -> bytes:
    """A progressive JPEG with few coefficients that are 0, so that its refinement has much to do."""
    width, height = size_px
    noise = np.random.default_rng(2).integers(0, 255, (height, width, 3), dtype=np.uint8)
    options = [cv2.IMWRITE_JPEG_PROGRESSIVE, 1, cv2.IMWRITE_JPEG_QUALITY, quality]
    return bytes(cv2.imencode(".jpg", noise, options)[1])


def chunk(name: bytes, data: bytes = b"") -> bytes:
    """One of a PNG."""
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def many_chunks(size_px: tuple[int, int], count: int, name: bytes = b"zTXt") -> bytes:
    """A PNG with one empty chunk repeated before its picture."""
    good = png(sample(size_px))
    at = 8 + 25  # after the header
    return good[:at] + chunk(name) * count + good[at:]


def inflating(size_px: tuple[int, int], megabytes: int) -> bytes:
    """A PNG whose data goes on after the picture, and inflates to so much."""
    width, height = size_px
    packer = zlib.compressobj(9)
    own = packer.compress(bytes(height * (1 + 3 * width))) + packer.flush(zlib.Z_FULL_FLUSH)
    more = packer.compress(bytes(1_000_000)) + packer.flush(zlib.Z_FULL_FLUSH)
    packed = (
        own + more * megabytes + packer.flush()
    )  # each flush is a beginning: it may be repeated
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", packed) + chunk(b"IEND")


@cache
def plain_png(size_px: tuple[int, int], colour: int = 6, bits: int = 8) -> bytes:
    """A PNG of one colour, a thousandth of its pixels' size."""
    width, height = size_px
    samples = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    packer, row = zlib.compressobj(1), bytes(1 + width * samples * bits // 8)
    raw = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", raw) + chunk(b"IEND")


def large_picture(random: Random, size_px: tuple[int, int]) -> bytes:
    """One of these, of this size, but for some that claim a larger one."""

    def count_of(size: int) -> int:
        return max(1, round(math.pow(MOST_BYTES / size, random.random())))

    segments = (
        _COMMENT,
        b"\xff\xe1\x00\x02",
        b"\xff\xdb\x00\x02",
        b"\xff\xd0",
        b"\xff\x01",
        b"\xff",
    )
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: many_segments(size_px, count_of(4), random.choice(segments)),
        lambda: many_late_segments(size_px, count_of(4)),
        lambda: many_scans(size_px, count_of(3000)),
        lambda: many_scans(size_px, count_of(12), short_scan(*random.choice(_SCANS))),
        lambda: many_scans((1280, 720), count_of(12), short_scan(*random.choice(_SCANS))),
        lambda: many_chunks(size_px, count_of(12), random.choice(_CHUNKS)),
        lambda: many_chunks(size_px, count_of(12), b"IDAT"),
        lambda: inflating(size_px, count_of(1000)),
        lambda: plain_png(random.choice(_SIZES), random.choice((0, 2, 4, 6)), random.choice((8, 16))),
        lambda: jpeg(sample(size_px)) + random.randbytes(1000) * count_of(1000),
    )  # fmt: skip
    return random.choice(ways)()


_SCANS = ((0, 0, 0), (0, 0, 0x10), (1, 63, 0), (1, 63, 0x10), (1, 1, 0x10, 2), (1, 63, 0x10, 3))
_SIZES = ((2000, 2000), (6000, 4000), (24_000, 1000), (9000, 9000))
