"""Parses the segments of a JPEG file within limits: its size, and the work of decoding it.

The format limits neither the segments before the picture nor its scans: 2,000,000 empty comments are 8 MB and blocked the
interpreter for 8 s; a progressive scan has 12 bytes and takes up to 7 ns a pixel. So both are counted before OpenCV
decodes the file. ITU-T T.81, annexes B and G.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from mocapd.errors import MalformedError

# before the picture, and again between its scans; cameras write 10, photographs 60
MOST_SEGMENTS = 256
MOST_SCANS = 64  # ordinary progressive files have 10
# Scans times pixels: below 1 s. A progressive photograph of 12 Mpixel is within.
MOST_SCANNED_PIXELS = 120_000_000
# least count of a picture in several scans, which holds all coefficients in memory
_BUFFERED_SCANS = 8

_SOI = b"\xff\xd8"
_SEQUENTIAL, _PROGRESSIVE = frozenset({0xC0, 0xC1}), 0xC2  # the frame headers that are read
_SOF = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # start of frame; not tables
_DHT, _SOS, _EOI = 0xC4, 0xDA, 0xD9
_ALONE = frozenset({0x01, *range(0xD0, 0xD9)})  # markers without a length
_FIRST_WITH_LENGTH = 0xC0  # decoders refuse those below
_MARKER = re.compile(rb"\xff[\x01-\xcf\xd8-\xfe]")  # within a scan: neither stuffing nor a restart
_MOST_STRAY = 1024  # bytes between segments, which some webcams leave and decoders skip


@dataclass(frozen=True, slots=True)
class JpegHeader:
    """size_px: width, height; channels as stored; bits of each; has_tables: Huffman tables are in the file."""

    size_px: tuple[int, int]
    channels: int
    bits: int
    is_progressive: bool
    has_tables: bool
    scan_at: int  # where the first scan begins [bytes]; the end of the file when there is none


def is_jpeg(data: memoryview) -> bool:
    """True if the data begins as a JPEG does."""
    return data[: len(_SOI)] == _SOI


def jpeg_header(data: memoryview) -> JpegHeader:
    """Parses the header. Raises MalformedError, also for too many segments."""
    frame: tuple[int, int, int, int, int] | None = None
    has_tables, scan_at = False, len(data)
    for marker, at, segment in _segments(data):
        if marker == _SOS:
            scan_at = at
        elif marker == _DHT:
            has_tables = True
        elif marker in _SOF and frame is None:
            if marker not in _SEQUENTIAL and marker != _PROGRESSIVE:
                raise MalformedError(f"is a JPEG of the rare kind SOF{marker - 0xC0}")
            if len(segment) < 6:
                raise MalformedError("has a frame header that is cut short")
            frame = marker, *struct.unpack(">BHHB", segment[:6])
    if frame is None:
        raise MalformedError("has no frame header")
    marker, bits, height, width, channels = frame
    return JpegHeader((width, height), channels, bits, marker == _PROGRESSIVE, has_tables, scan_at)


def check_work(data: bytes, header: JpegHeader) -> None:
    """Raises MalformedError for a file with more scans than a picture of its size needs."""
    width, height = header.size_px
    scans = _scans(data, header.scan_at)
    if scans > MOST_SCANS:
        raise MalformedError(f"has more than {MOST_SCANS} scans")
    if scans > 1 or header.is_progressive:
        scans = max(scans, _BUFFERED_SCANS)
    if scans * width * height > MOST_SCANNED_PIXELS:
        raise MalformedError(f"has {width}x{height} pixels in several scans, save it as one")


def _segments(data: memoryview) -> Iterator[tuple[int, int, memoryview]]:
    """Marker, place and content of every segment before the first scan, and the header of that scan."""
    at, stray = len(_SOI), 0
    segments = 0
    while at + 4 <= len(data):
        marker = data[at + 1]
        if data[at] != 0xFF or marker in (0x00, 0xFF):  # fill bytes may stand before a marker
            at, stray = at + 1, stray + 1
            if stray > _MOST_STRAY:
                return
            continue
        if marker == _EOI:
            return
        segments += 1
        if segments > MOST_SEGMENTS:
            raise MalformedError(f"has more than {MOST_SEGMENTS} segments before its picture")
        if marker in _ALONE:
            at += 2
            continue
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if length < 2 or at + 2 + length > len(data):
            raise MalformedError("has a segment that is longer than the file")
        yield marker, at, data[at + 4 : at + 2 + length]
        if marker == _SOS:
            return
        at += 2 + length


def _scans(data: bytes, at: int) -> int:
    """Number of scans up to the picture's end, at most the limit plus one. Raises MalformedError.

    Within a scan FF is followed by 00 or a restart: any other marker ends it, as decoders have it.
    """
    if data.count(b"\xff\xda", at) <= 1:  # the usual case; a thumbnail lies before the first scan
        return 1
    scans = segments = 0
    while found := _MARKER.search(data, at):
        marker, at = data[found.start() + 1], found.end()
        if marker == _EOI:
            break
        if marker == _SOS:
            scans += 1
            if scans > MOST_SCANS:
                break
        else:
            segments += 1
            if segments > MOST_SEGMENTS:
                raise MalformedError(f"has more than {MOST_SEGMENTS} segments between its scans")
        if marker >= _FIRST_WITH_LENGTH and marker not in _ALONE:
            at += int.from_bytes(data[at : at + 2], "big")
    return scans
