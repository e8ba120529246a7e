"""PNG and JPEG that lie: about their size, their chunks and segments, and what is compressed in them."""

import struct
import zlib
from random import Random

import cv2
import numpy as np

from mocapd.types import Bytes
from tests.fuzz.mutations import damaged

_PNG = b"\x89PNG\r\n\x1a\n"
_SIZES = (0, 1, 2, 17, 255, 32000, 65500, 65535, 65536, 100_000, 1 << 20, (1 << 31) - 1, 1 << 31)
_LENGTHS = (0, 1, 3, 0x7FFFFFFF, 0x80000000, 0xFF000000, 0xFFFFFFFF, 0x10000000, 0x40000000)
_SOF = frozenset({0xC0, 0xC1, 0xC2})

Chunk = tuple[bytes, bytes]


def png(pixels: Bytes) -> bytes:
    """A PNG of pixels (h,w) or (h,w,3) BGR."""
    return bytes(cv2.imencode(".png", pixels)[1])


def jpeg(pixels: Bytes) -> bytes:
    """A JPEG of them."""
    return bytes(cv2.imencode(".jpg", pixels)[1])


def sample(size_px: tuple[int, int], seed: int = 1) -> Bytes:
    """A picture (h,w,3) that is not plain."""
    width, height = size_px
    small = np.random.default_rng(seed).integers(0, 255, (6, 8, 3), dtype=np.uint8)
    return np.asarray(cv2.resize(small, (width, height)), dtype=np.uint8)


def strokes_on(size_px: tuple[int, int]) -> Bytes:
    """Strokes (h,w) of all ten colours."""
    width, height = size_px
    out = np.zeros((height, width), np.uint8)
    for colour in range(1, 11):
        left = (2 * colour - 1) * width // 22
        out[height // 4 : height // 2, left : left + max(1, width // 22)] = colour
    return out


def damaged_png(random: Random, data: bytes) -> bytes:
    """Changed in its chunks, checksums mostly right again, or in its bytes."""
    if random.random() < 0.4:
        return damaged(random, data)
    chunks = _chunks_of(data)
    at = random.randrange(len(chunks))
    kind = random.randrange(7)
    if kind == 0:
        chunks[0] = (b"IHDR", _header(random, chunks[0][1]))
    elif kind == 1:
        chunks.pop(at)
    elif kind == 2:
        chunks.insert(random.randint(1, len(chunks)), chunks[at])
    elif kind == 3:
        name = random.choice(
            (b"PLTE", b"tRNS", b"acTL", b"fcTL", b"fdAT", b"eXIf", b"iCCP", b"zzzz")
        )
        chunks.insert(
            random.randint(1, len(chunks)), (name, random.randbytes(random.randint(0, 30)))
        )
    elif kind == 4:
        chunks = [(n, _recompressed(random, d) if n == b"IDAT" else d) for n, d in chunks]
    elif kind == 5:
        chunks[at] = (chunks[at][0], damaged(random, chunks[at][1]))
    return _png_of(random, chunks, at if kind == 6 else -1)


def damaged_jpeg(random: Random, data: bytes) -> bytes:
    """Changed in its size, its segments or its bytes."""
    kind = random.random()
    if kind < 0.4:
        return damaged(random, data)
    out = bytearray(data)
    segments = _segments_of(data)
    marker, at = random.choice(segments)
    if kind < 0.7:
        at = next((place for one, place in segments if one in _SOF), at)
        size = [random.choice(_SIZES) & 0xFFFF for _ in range(2)]
        if random.random() < 0.5:
            size = [32000, 32000]
        out[at + 5 : at + 9] = struct.pack(">HH", *size)
        if random.random() < 0.3:
            out[at + 9] = random.randrange(256)  # channels
    elif kind < 0.85:
        out[at + 2 : at + 4] = struct.pack(">H", random.choice((0, 1, 2, 3, 0x7FFF, 0xFFFF)))
    elif kind < 0.92:
        out[at:at] = b"\xff" * random.choice((1, 3, 2000))
    else:
        out[at + 1] = random.choice(
            (marker ^ 1, 0xC3, 0xC9, 0xD9, 0xDA, 0x01, random.randrange(256))
        )
    return bytes(out)


def _header(random: Random, data: bytes) -> bytes:
    width, height, bits, colour, *rest = struct.unpack(">IIBBBBB", data)
    if random.random() < 0.7:
        width = random.choice((width, *_SIZES))
        height = random.choice((height, *_SIZES))
    else:
        bits, colour = random.choice((1, 2, 4, 8, 16, 3)), random.choice((0, 2, 3, 4, 6, 7))
        rest[2] = random.choice((0, 0, 1))
    return struct.pack(">IIBBBBB", width, height, bits, colour, *rest)


def _recompressed(random: Random, data: bytes) -> bytes:
    """Too little, too much, or other bytes."""
    try:
        raw = zlib.decompress(data)
    except zlib.error:
        return data
    kind = random.randrange(3)
    if kind == 0:
        raw = raw[: random.randint(0, len(raw))]
    elif kind == 1:
        raw += bytes(random.choice((1, 1000, 20_000_000)))
    else:
        raw = damaged(random, raw)
    return zlib.compress(raw, 1)


def _chunks_of(data: bytes) -> list[Chunk]:
    chunks, at = [], len(_PNG)
    while at < len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        chunks.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    return chunks


def _png_of(random: Random, chunks: list[Chunk], lies: int) -> bytes:
    """The file; the chunk `lies` says another length than it has."""
    out = bytearray(_PNG)
    for number, (name, data) in enumerate(chunks):
        length = random.choice(_LENGTHS) if number == lies else len(data)
        out += struct.pack(">I", length) + name + data
        wrong = random.random() < 0.02
        out += struct.pack(">I", (zlib.crc32(name + data) + wrong) & 0xFFFFFFFF)
    return bytes(out)


def _segments_of(data: bytes) -> list[tuple[int, int]]:
    """Marker and place of each segment up to the picture's data."""
    found, at = [], 2
    while at + 4 <= len(data) and data[at] == 0xFF:
        found.append((data[at + 1], at))
        if data[at + 1] == 0xDA:
            break
        at += 2 + int.from_bytes(data[at + 2 : at + 4], "big")
    return found
