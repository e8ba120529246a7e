"""Pictures are measured by their headers: what they claim is compared before it is believed."""

import resource
import struct
import zlib
from contextlib import suppress

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.boundary.pictures import decode_picture, read_header
from mocapd.errors import MalformedError
from mocapd.types import Bytes

COLOUR = np.arange(6 * 9 * 3, dtype=np.uint8).reshape(6, 9, 3)
GREY = COLOUR[..., 0].copy()


def png(pixels: Bytes) -> bytes:
    return bytes(cv2.imencode(".png", pixels)[1])


def jpeg(pixels: Bytes) -> bytes:
    return bytes(cv2.imencode(".jpg", pixels)[1])


def chunk(name: bytes, data: bytes, length: int | None = None) -> bytes:
    return (
        struct.pack(">I", len(data) if length is None else length)
        + name
        + data
        + struct.pack(">I", zlib.crc32(name + data))
    )


def png_of(width: int, height: int, *chunks: bytes) -> bytes:
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + b"".join(chunks)


IDAT = chunk(b"IDAT", zlib.compress(b"\0\0"))
END = chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("data", "size_px", "channels"),
    [
        (png(COLOUR), (9, 6), 3),
        (png(GREY), (9, 6), 1),
        (jpeg(COLOUR), (9, 6), 3),
        (jpeg(GREY), (9, 6), 1),
        (jpeg(COLOUR)[:2] + b"\xff\xff\x00stray" + jpeg(COLOUR)[2:], (9, 6), 3),
    ],
)
def test_the_size_is_read_without_decoding(
    data: bytes, size_px: tuple[int, int], channels: int
) -> None:
    header = read_header(data)
    assert (header.size_px, header.channels, header.bits) == (size_px, channels, 8)


def test_a_picture_comes_out_as_it_went_in() -> None:
    assert np.array_equal(decode_picture(png(COLOUR), cv2.IMREAD_COLOR), COLOUR)
    assert np.array_equal(decode_picture(png(GREY), cv2.IMREAD_UNCHANGED, (9, 6)), GREY)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"GIF89a",
        png(COLOUR)[:-5],
        png_of(1, 1, chunk(b"IDAT", b"\0", length=0xFF000000)),
        png_of(65536, 65536, IDAT, END),
        png_of(0, 5, IDAT, END),
        png_of(1, 1, chunk(b"acTL", b"\0\0\0\2\0\0\0\0"), IDAT, END),
        b"\x89PNG\r\n\x1a\n" + IDAT + END,
        bytes(cv2.imencode(".png", GREY.astype(np.uint16))[1]),
        b"\xff\xd8\xff\xc0\x00\x11\x08\x7d\x00\x7d\x00\x03" + bytes(9) + b"\xff\xd9",
        b"\xff\xd8\xff\xe0\xff\xff\x00",
        b"\xff\xd8" + b"\x00" * 100_000,
        jpeg(COLOUR)[:20],
    ],
)
def test_what_is_no_picture_is_malformed(data: bytes) -> None:
    with pytest.raises(MalformedError):
        decode_picture(data, cv2.IMREAD_UNCHANGED)


def test_another_size_is_refused_and_told() -> None:
    with pytest.raises(MalformedError, match="9x6 pixels, wanted 6x9"):
        decode_picture(jpeg(COLOUR), cv2.IMREAD_COLOR, (6, 9))


def test_a_header_that_lies_costs_no_memory() -> None:
    frame = bytearray(jpeg(np.zeros((480, 640, 3), np.uint8)))
    at = frame.index(b"\xff\xc0") + 5
    frame[at : at + 4] = struct.pack(">HH", 32000, 32000)
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(MalformedError):
        decode_picture(bytes(frame), cv2.IMREAD_COLOR, (640, 480))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 50_000


@settings(max_examples=300, deadline=None)
@given(
    which=st.sampled_from([png(COLOUR), jpeg(COLOUR)]),
    changes=st.lists(st.tuples(st.integers(0, 700), st.integers(0, 255)), max_size=6),
)
def test_any_change_is_a_picture_or_malformed(which: bytes, changes: list[tuple[int, int]]) -> None:
    data = bytearray(which)
    for at, value in changes:
        data[at % len(data)] = value
    with suppress(MalformedError):
        assert decode_picture(bytes(data), cv2.IMREAD_COLOR, (9, 6)).shape == (6, 9, 3)


def test_sixteen_bits_are_read_where_they_are_wanted() -> None:
    data = bytes(cv2.imencode(".png", np.full((4, 6, 3), 77 * 257, np.uint16))[1])
    with pytest.raises(MalformedError, match="16 bits"):
        decode_picture(data, cv2.IMREAD_COLOR)
    assert (decode_picture(data, cv2.IMREAD_COLOR, most_bits=16) == 77).all()
