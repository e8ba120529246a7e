"""Pictures are measured by their headers: what they claim is compared before it is believed."""

import os
import resource
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.boundary.image_decoding import decode_camera_picture, decode_picture, read_header
from mocapd.errors import MalformedError
from mocapd.types import Bytes
from tests.fuzz import large_pictures

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


SIZE_PX = (640, 480)
HOSTILE: dict[str, Callable[[], bytes]] = {
    "empty comments": lambda: large_pictures.many_segments(SIZE_PX, 2_000_000),
    "comments between scans": lambda: large_pictures.many_late_segments(SIZE_PX, 1_900_000),
    "restarts without a scan": lambda: large_pictures.many_segments(SIZE_PX, 2_000_000, b"\xff\xd0"),
    "short scans": lambda: large_pictures.many_scans(
        SIZE_PX, 600_000, large_pictures.short_scan()
    ),
    "scans of a large picture": lambda: large_pictures.many_scans(
        (2000, 1500), 50, large_pictures.short_scan()
    ),
    "empty zTXt": lambda: large_pictures.many_chunks(SIZE_PX, 480_000),
    "empty tIME": lambda: large_pictures.many_chunks(SIZE_PX, 640_000, b"tIME"),
    "bytes after the picture's": lambda: large_pictures.inflating(SIZE_PX, 4000),
    "16 bits of 40 million pixels": lambda: large_pictures.plain_png((8000, 5000), bits=16),
}  # fmt: skip
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


@pytest.mark.parametrize("hostile", HOSTILE.values(), ids=HOSTILE.keys())
def test_more_work_than_a_picture_needs_is_refused_before_it_is_done(
    hostile: Callable[[], bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Decoding them takes from 2 s to hours, walking them all did up to 8 s: `make fuzz` measures that."""

    def decoded(*_: object) -> None:
        pytest.fail("the decoder sees it")

    monkeypatch.setattr(cv2, "imdecode", decoded)
    with pytest.raises(MalformedError):
        decode_picture(hostile(), cv2.IMREAD_COLOR, most_bits=16)


def test_what_stands_beside_a_picture_in_a_png_is_not_handed_to_the_decoder(tmp_path: Path) -> None:
    """libpng writes a line to stderr for each odd chunk: none comes, and the picture is the same."""
    odd = (b"zTXt", b"tIME", b"cHRM", b"pHYs", b"iCCP", b"PLTE", b"tRNS", b"tRNS")
    good = png(COLOUR)
    at = 8 + 25
    path = tmp_path / "odd.png"
    path.write_bytes(good[:at] + b"".join(map(chunk, odd, [b"x"] * len(odd))) + good[at:])
    program = (
        "import sys, cv2; from pathlib import Path; from mocapd.boundary.image_decoding import decode_picture\n"
        "sys.stdout.buffer.write(decode_picture(Path(sys.argv[1]).read_bytes(), cv2.IMREAD_COLOR).tobytes())"
    )
    ran = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, check=True, env=os.environ
    )
    assert (ran.stdout, ran.stderr) == (COLOUR.tobytes(), b"")


def test_a_palette_and_transparency_stay() -> None:
    palette = chunk(b"PLTE", bytes(range(12)))
    pixels = chunk(b"IDAT", zlib.compress(b"\0\x1b"))  # 0 1 2 3, of two bits
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 1, 2, 3, 0, 0, 0))
    data = b"\x89PNG\r\n\x1a\n" + header + palette + chunk(b"tRNS", b"\0\xff") + pixels + END
    colours = np.arange(12, dtype=np.uint8).reshape(1, 4, 3)[..., ::-1]
    assert np.array_equal(decode_picture(data, cv2.IMREAD_COLOR), colours)


def test_ordinary_progressive_pictures_are_read() -> None:
    width, height = 1000, 800
    data = large_pictures.progressive((width, height))
    assert data.count(b"\xff\xda") == 10
    assert decode_picture(data, cv2.IMREAD_COLOR).shape == (height, width, 3)


def test_scans_of_a_thumbnail_and_of_what_follows_the_picture_do_not_count() -> None:
    good = jpeg(np.zeros((480, 640, 3), np.uint8))
    thumbnail = b"\xff\xe1" + struct.pack(">H", 2 + 140) + b"\xff\xda" * 70
    data = good[:2] + thumbnail + good[2:] + b"\xff\xda" * 70
    assert decode_camera_picture(data, (640, 480)).shape == (480, 640, 3)


def test_a_camera_delivers_jpeg_no_larger_than_its_picture() -> None:
    noise = np.random.default_rng(0).integers(0, 256, (48, 64, 3), dtype=np.uint8)
    best = bytes(cv2.imencode(".jpg", noise, [cv2.IMWRITE_JPEG_QUALITY, 100])[1])
    assert decode_camera_picture(best, (64, 48)).shape == (48, 64, 3)
    with pytest.raises(MalformedError, match="no JPEG"):
        decode_camera_picture(png(noise), (64, 48))
    with pytest.raises(MalformedError, match="bytes for 64x48"):
        decode_camera_picture(best + bytes(4 * 64 * 48 + 65536), (64, 48))
