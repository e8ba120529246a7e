"""The pictures that cues work on: the same whether a camera's JPEG came whole or smaller."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.errors import ConfigError
from mocapd.tracking.pictures import Pictures
from mocapd.types import Bytes, Frame, FrameSet
from tests.capture.films import smooth_jpeg
from tests.geometry.rigs import ring

CAMERA = replace(ring(1)[0], size_px=(648, 482))  # whose quarter has odd sides


def loaded(work_width_px: int, reduced_by: int) -> tuple[Bytes, Bytes]:
    """The work picture and the grey one."""
    pictures = Pictures([CAMERA], work_width_px)
    frame = Frame(CAMERA.name, 0, 7, read_jpeg(smooth_jpeg(CAMERA.size_px), reduced_by=reduced_by))
    pictures.load(FrameSet(7, {CAMERA.name: frame}))
    return pictures.each[0].bgr, pictures.grey(0)


@pytest.mark.parametrize(("width_px", "reduced_by"), [(320, 2), (160, 2), (160, 4), (216, 2)])
def test_a_picture_decoded_smaller_gives_the_same_work_picture(
    width_px: int, reduced_by: int
) -> None:
    small, grey = loaded(width_px, reduced_by)
    averaged, of_whole = loaded(width_px, 1)
    assert small.shape == averaged.shape
    assert all(side % 2 == 0 for side in small.shape[:2])
    assert np.abs(small.astype(int) - averaged).mean() < 1.5
    assert np.abs(grey.astype(int) - of_whole).max() <= 2


def test_a_picture_of_another_size_than_its_calibration_is_refused_decoded_smaller_or_not() -> None:
    pictures = Pictures([replace(CAMERA, size_px=(640, 480))], 320)
    for by in (1, 2):
        frame = Frame(CAMERA.name, 0, 7, read_jpeg(smooth_jpeg(CAMERA.size_px), reduced_by=by))
        with pytest.raises(ConfigError, match="delivers 648x482"):
            pictures.load(FrameSet(7, {CAMERA.name: frame}))


def test_a_camera_is_black_until_its_first_picture() -> None:
    pictures = Pictures([CAMERA], 320)
    assert not pictures.each[0].bgr.any()
    assert pictures.grey(0).shape == (482, 648)
    assert not pictures.grey(0).any()
