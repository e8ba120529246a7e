"""A camera's JPEG decoded smaller: the same picture as the whole one averaged, and nothing else is lost."""

import cv2
import numpy as np
import pytest

from mocapd.boundary.image_decoding import REDUCTIONS, decode_camera_picture
from mocapd.capture.jpeg_picture import JpegPicture, read_jpeg
from mocapd.errors import MalformedError
from mocapd.types import Bytes, Frame
from tests.capture.films import smooth_jpeg, taken_upright

SIZE_PX = (322, 242)
SMALLER = [by for by in REDUCTIONS if by > 1]


def frame(data: bytes | Bytes, reduced_by: int) -> Frame:
    return Frame("a", 0, 0, read_jpeg(data, reduced_by=reduced_by))


@pytest.mark.parametrize("by", SMALLER)
def test_small_pictures_are_the_whole_one_averaged(by: int) -> None:
    data = smooth_jpeg(SIZE_PX)
    one = frame(data, by)
    small, smaller = one.small(by)
    assert smaller == by
    whole = decode_camera_picture(data)
    assert one.size_px == (322, 242)
    assert small.shape == (-(-242 // by), -(-322 // by), 3)
    h, w = 242 // by, 322 // by
    averaged = cv2.resize(whole[: h * by, : w * by], (w, h), interpolation=cv2.INTER_AREA)
    off = np.abs(small[:h, :w].astype(int) - averaged)
    assert off.mean() < 1.5
    assert np.abs((small[:h, :w].astype(int) - averaged).mean(axis=(0, 1))).max() < 0.5


@pytest.mark.parametrize("by", SMALLER)
def test_who_asks_for_the_whole_picture_gets_it(by: int) -> None:
    data = smooth_jpeg(SIZE_PX)
    whole = decode_camera_picture(data)
    assert np.array_equal(frame(data, by).pixels, whole)
    assert frame(data, by).encoded == data
    assert frame(data, by).small(3 * by)[1] == by
    odd, at = frame(data, by).small(3)  # which no reduction divides
    assert at == 1
    assert np.array_equal(odd, whole)
    picture = read_jpeg(data, reduced_by=by)
    assert isinstance(picture, JpegPicture)
    off = picture.grey.astype(int) - cv2.cvtColor(whole, cv2.COLOR_BGR2GRAY)
    assert np.abs(off).max() <= 2


def test_a_cut_file_is_refused_at_every_size() -> None:
    data = smooth_jpeg((64, 48))
    for end in range(0, len(data) - 2, 7):
        for by in REDUCTIONS:
            with pytest.raises(MalformedError):
                read_jpeg(data[:end], reduced_by=by)


def test_a_damaged_file_is_good_or_bad_whatever_its_size() -> None:
    data, rng = smooth_jpeg((64, 48)), np.random.default_rng(3)
    for _ in range(200):
        spoilt = bytearray(data)
        for at in rng.integers(0, len(data), 3):
            spoilt[at] = rng.integers(0, 256)
        whole = _picture(bytes(spoilt), 1)
        for by in SMALLER:
            small = _picture(bytes(spoilt), by)
            assert (small is None) == (whole is None)
            if whole is not None and small is not None:
                assert np.array_equal(
                    Frame("a", 0, 0, small).pixels, Frame("a", 0, 0, whole).pixels
                )


@pytest.mark.parametrize("by", list(REDUCTIONS))
def test_a_picture_that_was_taken_upright_is_turned(by: int) -> None:
    one = frame(taken_upright(smooth_jpeg(SIZE_PX)), by)
    assert one.size_px == one.pixels.shape[1::-1] == (242, 322)


def _picture(data: bytes, by: int) -> Bytes | JpegPicture | None:
    try:
        return read_jpeg(data, reduced_by=by)
    except MalformedError:
        return None
