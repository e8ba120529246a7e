"""What every source promises, whatever it reads from."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.capture.base import Source
from mocapd.capture.capture_folder import folder_source, load_folder
from mocapd.capture.file import FileSource
from mocapd.capture.pace import Pace
from mocapd.capture.simulated.sim import SimSource
from mocapd.errors import CameraLost, EndOfStream, MocapdError
from tests.capture.films import numbered_sim_film, write_capture, write_film

Make = Callable[[Path], Source]


def _file(folder: Path) -> Source:
    return FileSource("film", write_film(folder / "film.avi", 6))


def _live_file(folder: Path) -> Source:
    return FileSource("film", write_film(folder / "film.avi", 200, 100.0), pace=Pace(live=True))


def _folder(folder: Path) -> Source:
    capture = load_folder(write_capture(folder / "capture", frames=(6, 6)))
    return folder_source(capture.cameras[1], Pace(live=False))


def _sim(folder: Path) -> Source:
    return SimSource(numbered_sim_film(), "cam0")


def _sim_decoded_smaller(folder: Path) -> Source:
    return SimSource(numbered_sim_film(), "cam0", reduced_by=2)


RECORDED: tuple[Make, ...] = (_file, _live_file, _folder)
LIVE: tuple[Make, ...] = (_sim, _sim_decoded_smaller)


@pytest.fixture(params=RECORDED + LIVE)
def source(request: pytest.FixtureRequest, tmp_path: Path) -> Source:
    make: Make = request.param
    return make(tmp_path)


def frames_until(source: Source, end: type[MocapdError]) -> int:
    for count in range(1000):
        try:
            source.read()
        except end:
            return count
    raise AssertionError("it does not end")


def test_frames_are_named_ordered_and_read_only(source: Source) -> None:
    source.open()
    frames = [source.read() for _ in range(3)]
    source.close()
    for frame in frames:
        assert frame.camera == source.name
        assert frame.pixels.dtype == np.uint8
        assert frame.pixels.ndim == 3
        assert frame.pixels.shape[2] == 3
        assert frame.pixels.flags.c_contiguous
        assert not frame.pixels.flags.writeable
    assert all(a.seq < b.seq and a.t_ns < b.t_ns for a, b in pairwise(frames))


def test_what_a_camera_delivers_as_jpeg_is_what_its_pixels_were_decoded_from(
    source: Source,
) -> None:
    source.open()
    frame = source.read()
    source.close()
    assert (frame.encoded is None) == source.recorded
    if frame.encoded is not None:
        decoded = cv2.imdecode(np.frombuffer(frame.encoded, np.uint8), cv2.IMREAD_COLOR)
        assert decoded is not None
        assert np.array_equal(decoded, frame.pixels)


def test_reopening_begins_anew(source: Source) -> None:
    source.open()
    first = source.read()
    source.close()
    source.open()
    again = source.read()
    source.close()
    assert np.array_equal(first.pixels, again.pixels) or again.t_ns > first.t_ns  # live goes on


@pytest.mark.parametrize("make", RECORDED)
def test_a_recording_ends_and_stays_ended(make: Make, tmp_path: Path) -> None:
    source = make(tmp_path)
    assert source.recorded
    source.open()
    assert frames_until(source, EndOfStream) >= 1
    assert frames_until(source, EndOfStream) == 0
    source.close()


def test_closing_twice_and_before_opening_is_allowed(source: Source) -> None:
    source.close()
    source.open()
    source.close()
    source.close()


def test_a_closed_source_does_not_deliver(source: Source) -> None:
    source.open()
    source.close()
    with pytest.raises(CameraLost):
        source.read()
