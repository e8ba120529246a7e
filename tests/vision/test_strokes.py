"""Stroke files: read in each form a paint program saves them, refused with the reason otherwise."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.errors import InputError
from mocapd.types import Bytes
from mocapd.vision.strokes import read_image, read_labelled, read_strokes

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
        (STROKES.astype(np.uint16), "uint16"),
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
    with pytest.raises(InputError, match="is not an image"):
        read_image(empty)
    text = tmp_path / "text.png"
    text.write_text("not a picture")
    with pytest.raises(InputError, match="is not an image"):
        read_image(text)
    with pytest.raises(InputError, match="cannot be read"):
        read_image(tmp_path)


def test_strokes_must_fit_their_image(tmp_path: Path) -> None:
    image = write(tmp_path / "i.png", np.zeros((48, 64, 3), np.uint8))
    strokes = write(tmp_path / "s.png", STROKES[:, :60])
    with pytest.raises(InputError, match="60x48 pixels, wanted 64x48"):
        read_labelled(image, strokes)
