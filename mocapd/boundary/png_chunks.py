"""Parses the chunks of a PNG file within limits, and rebuilds the file from the necessary ones.

libpng writes a line to stderr for each odd chunk (480,000 empty ones in 8 MB: 15.7 MB of log), and inflates
whatever follows the picture's own data (4 MB: 5 s). So OpenCV gets IHDR, PLTE, tRNS, one IDAT and IEND, checked here.
W3C PNG specification, third edition, sections 5, 8 and 11.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

from mocapd.errors import MalformedError

MOST_CHUNKS = 256  # that are not the picture's data
MOST_DATA_CHUNKS = 65_536  # libpng writes 8 kB in each: 500 MB
MOST_RAW_BYTES = 170_000_000  # of a picture, inflated: four bytes of each of 40 million pixels

_PNG = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {0: 1, 2: 3, 3: 3, 4: 2, 6: 4}  # by colour type; 3: a palette, decoded as colour
_BITS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
_PALETTE = 3
_TRANSPARENT_BYTES = {0: (2, 2), 2: (6, 6), _PALETTE: (1, 256)}  # of tRNS, by colour type
_PASSES = (
    (0, 0, 8, 8),
    (4, 0, 8, 8),
    (0, 4, 4, 8),
    (2, 0, 4, 4),
    (0, 2, 2, 4),
    (1, 0, 2, 2),
    (0, 1, 1, 2),
)
_STEP_BYTES = 1 << 20  # inflated at once


@dataclass(frozen=True, slots=True)
class PngHeader:
    """size_px: width, height; channels as decoded; bits of each stored sample; colour: its type."""

    size_px: tuple[int, int]
    channels: int
    bits: int
    colour: int
    is_interlaced: bool


def is_png(data: memoryview) -> bool:
    """True if the data has the signature of a PNG."""
    return data[: len(_PNG)] == _PNG


def png_header(data: memoryview) -> PngHeader:
    """Parses the header. Raises MalformedError for an incomplete PNG or too many chunks."""
    header: PngHeader | None = None
    for name, content, _ in _chunks(data):
        if header is None:
            header = _header(name, content)
    if header is None:
        raise MalformedError("is cut short")
    return header


def plain_png(data: memoryview, header: PngHeader) -> bytes:
    """The same picture without other chunks. Raises MalformedError for damage or excess data."""
    chunks: dict[bytes, memoryview] = {}
    pixels: list[memoryview] = []
    for name, content, checksum in _chunks(data):
        if name == b"IDAT":
            pixels.append(content)
        elif name in (b"IHDR", b"PLTE", b"tRNS") and name not in chunks:
            chunks[name] = content
        else:
            continue
        if zlib.crc32(content, zlib.crc32(name)) != checksum:
            raise MalformedError("is damaged")
    _check_pixels(pixels, _raw_bytes(header))
    parts = [_PNG, _chunk(b"IHDR", chunks[b"IHDR"])]
    if header.colour == _PALETTE:
        parts.append(_chunk(b"PLTE", _palette(chunks.get(b"PLTE", memoryview(b"")), header.bits)))
    transparent = chunks.get(b"tRNS")
    low, high = _TRANSPARENT_BYTES.get(header.colour, (1, 0))
    if transparent is not None and low <= len(transparent) <= high:
        most = len(chunks[b"PLTE"]) // 3 if header.colour == _PALETTE else high
        parts.append(_chunk(b"tRNS", transparent[:most]))
    parts += [_chunk(b"IDAT", b"".join(pixels)), _chunk(b"IEND", b"")]
    return b"".join(parts)


def _chunks(data: memoryview) -> Iterator[tuple[bytes, memoryview, int]]:
    """Name, content and checksum of every chunk up to the picture's end."""
    at, others, pixels = len(_PNG), 0, 0
    while True:
        if at + 12 > len(data):
            raise MalformedError("is cut short")
        length = int.from_bytes(data[at : at + 4], "big")
        name = bytes(data[at + 4 : at + 8])
        end = at + 8 + length
        if end + 4 > len(data):
            raise MalformedError("has a chunk that is longer than the file")
        if name == b"acTL":
            raise MalformedError("is animated")
        if name == b"IDAT":
            pixels += 1
        else:
            others += 1
        if others > MOST_CHUNKS or pixels > MOST_DATA_CHUNKS:
            raise MalformedError(f"has more than {MOST_CHUNKS} chunks besides its picture")
        yield name, data[at + 8 : end], int.from_bytes(data[end : end + 4], "big")
        if name == b"IEND":
            return
        at = end + 4


def _header(name: bytes, content: memoryview) -> PngHeader:
    if name != b"IHDR" or len(content) != 13:
        raise MalformedError("does not begin with its header")
    width, height, bits, colour, compression, filters, interlaced = struct.unpack(
        ">IIBBBBB", content
    )
    if colour not in _CHANNELS:
        raise MalformedError(f"has the unknown colour type {colour}")
    if bits not in _BITS[colour] or compression or filters or interlaced > 1:
        raise MalformedError("has a header that no PNG has")
    return PngHeader((width, height), _CHANNELS[colour], bits, colour, bool(interlaced))


def _raw_bytes(header: PngHeader) -> int:
    """Size of the inflated pixels, with the filter byte of each row [bytes]."""
    samples = 1 if header.colour == _PALETTE else header.channels
    width, height = header.size_px

    def of(columns: int, rows: int) -> int:
        return rows * (1 + -(-columns * samples * header.bits // 8)) if columns else 0

    if not header.is_interlaced:
        return of(width, height)
    return sum(
        of(-(-max(0, width - left) // across), -(-max(0, height - top) // down))
        for left, top, across, down in _PASSES
    )


def _check_pixels(pixels: list[memoryview], raw_bytes: int) -> None:
    """Checks that they inflate to `raw_bytes` bytes, in constant memory. Raises MalformedError."""
    if raw_bytes > MOST_RAW_BYTES:
        raise MalformedError(
            f"takes {raw_bytes / 1e6:.0f} MB, at most {MOST_RAW_BYTES / 1e6:.0f} MB are read"
        )
    inflater, size = zlib.decompressobj(), 0
    try:
        for piece in pixels:
            rest: bytes | memoryview = piece
            while rest and not inflater.eof and size <= raw_bytes:
                size += len(inflater.decompress(rest, _STEP_BYTES))
                rest = inflater.unconsumed_tail
        if size <= raw_bytes:
            size += len(inflater.flush())  # the rest of the output, as the input is consumed
    except zlib.error:
        raise MalformedError("is damaged") from None
    if size != raw_bytes or not inflater.eof:
        raise MalformedError(
            "is damaged or cut short" if size <= raw_bytes else "holds more than its size"
        )


def _palette(content: memoryview, bits: int) -> memoryview:
    if not 3 <= len(content) <= 3 * (1 << bits) or len(content) % 3:
        raise MalformedError("has no palette that fits")
    return content


def _chunk(name: bytes, content: bytes | memoryview) -> bytes:
    checksum = zlib.crc32(content, zlib.crc32(name))
    return b"".join((struct.pack(">I", len(content)), name, content, struct.pack(">I", checksum)))
