"""What is opened late is let go: nobody holds a camera that nobody reads."""

from pathlib import Path

import cv2
import pytest

from mocapd.capture.guard import Openings
from tests.capture.films import write_film


@pytest.fixture
def film(tmp_path: Path) -> Path:
    return write_film(tmp_path / "a.avi", 3)


def opened(film: Path) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(str(film), cv2.CAP_FFMPEG)
    assert capture.isOpened()
    return capture


def test_what_is_opened_in_time_is_there_until_it_is_closed(film: Path) -> None:
    openings, capture = Openings(), opened(film)
    assert openings.take(openings.begin(), capture)
    guarded = openings.current
    assert guarded is not None
    openings.close()
    openings.close()
    assert openings.current is None
    assert guarded.closing
    assert not capture.isOpened()


def test_what_was_closed_while_it_was_opened_is_released(film: Path) -> None:
    openings, capture = Openings(), opened(film)
    number = openings.begin()
    openings.close()
    assert not openings.take(number, capture)
    assert not capture.isOpened()
    assert openings.current is None


def test_a_driver_that_comes_back_late_does_not_disturb_who_came_after_it(film: Path) -> None:
    openings, late, newer = Openings(), opened(film), opened(film)
    stuck = openings.begin()
    assert openings.take(openings.begin(), newer)
    assert not openings.take(stuck, late)
    assert not late.isOpened()
    assert newer.isOpened()
    openings.close()
