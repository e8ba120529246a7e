"""Stroke files: read in each form a paint program saves them, refused with the reason otherwise."""

import os
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.errors import InputError
from mocapd.shirt.colour.strokes import (
    read_image,
    read_labelled,
    read_strokes,
    stroked_pictures,
    strokes_path,
)
from mocapd.types import Bytes

STROKES = (np.arange(48 * 64) // 280).astype(np.uint8).reshape(48, 64)


def write(path: Path, image: Bytes) -> Path:
    assert cv2.imwrite(str(path), image)
    return path


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_ids_survive_gray_colour_and_alpha(tmp_path: Path, channels: int) -> None:
    image = STROKES
    if channels >= 3:
        image = np.repeat(STROKES[..., None], 3, axis=2)
    if channels == 4:
        image = np.concatenate([image, np.full((48, 64, 1), 255, np.uint8)], axis=2)
    read = read_strokes(write(tmp_path / "s.png", image), (64, 48))
    assert (read == STROKES).all()
    assert read.flags.c_contiguous


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (STROKES + 1, "contains the id 11"),
        (STROKES[:40], "64x40 pixels, wanted 64x48"),
        (np.dstack([STROKES, STROKES, STROKES[::-1]]), "painted in colours"),
        (STROKES.astype(np.uint16), "16 bits"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, image: Bytes, message: str) -> None:
    path = write(tmp_path / "s.png", image)
    with pytest.raises(InputError, match=message) as caught:
        read_strokes(path, (64, 48))
    assert str(path) in str(caught.value)


def test_missing_empty_and_cut_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_strokes(tmp_path / "none.png")
    empty = tmp_path / "empty.png"
    empty.touch()
    with pytest.raises(InputError, match="neither PNG nor JPEG"):
        read_image(empty)
    text = tmp_path / "text.png"
    text.write_text("not a picture")
    with pytest.raises(InputError, match="neither PNG nor JPEG"):
        read_image(text)
    with pytest.raises(InputError, match="cannot be read"):
        read_image(tmp_path)


def chunk(name: bytes, data: bytes, length: int | None = None) -> bytes:
    told = len(data) if length is None else length
    return told.to_bytes(4, "big") + name + data + zlib.crc32(name + data).to_bytes(4, "big")


def png(width: int, height: int, length: int | None = None) -> bytes:
    """A small PNG that claims this size; `length`: what its chunk of pixels claims to be long."""
    head = width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes([8, 0, 0, 0, 0])
    pixels = chunk(b"IDAT", zlib.compress(b"\0" * 16), length)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + pixels + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (png(4, 3, length=0xFF000000), "longer than the file"),  # took 4 GB and 9 s
        (png(65536, 65536), "at most"),  # raised cv2.error
        (png(30_000, 30_000), "at most"),
    ],
)
def test_a_small_file_that_claims_gigabytes_is_refused(
    tmp_path: Path, data: bytes, message: str
) -> None:
    path = tmp_path / "s.png"
    path.write_bytes(data)
    for read in (read_image, read_strokes):
        with pytest.raises(InputError, match=message) as caught:
            read(path)
        assert str(path) in str(caught.value)


def test_what_is_no_regular_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.png")
    for path in (tmp_path / "pipe.png", Path("/dev/zero")):
        with pytest.raises(InputError, match="no regular file"):
            read_image(path)


def test_pictures_of_a_folder_are_not_their_strokes_and_labels(tmp_path: Path) -> None:
    for name in ("0", "0_strokes", "0_labels", "left_1", "left_1_strokes"):
        (tmp_path / f"{name}.png").touch()
    pictures = stroked_pictures(tmp_path)
    assert [path.name for path in pictures] == ["0.png", "left_1.png"]
    assert strokes_path(pictures[1]).name == "left_1_strokes.png"


def test_strokes_must_fit_their_image(tmp_path: Path) -> None:
    image = write(tmp_path / "i.png", np.zeros((48, 64, 3), np.uint8))
    strokes = write(tmp_path / "s.png", STROKES[:, :60])
    with pytest.raises(InputError, match="60x48 pixels, wanted 64x48"):
        read_labelled(image, strokes)
