"""The room behind somebody who is found: forgotten where it was learned with them, kept where it was there before."""

import numpy as np
import pytest

from mocapd.tracking.cues.clothes.camera_view import CameraView
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Bytes

PARAMS = ClothesParams()
ROI = (20, 20, 80, 100)
ROOM, PERSON = 60, 160


def view_of(room: Bytes, picture: Bytes) -> CameraView:
    """A camera that shows a person in the middle of ROI, of this room as it was learned."""
    view = CameraView("a camera", (100, 120), 1, PARAMS)
    view.background.seed(room, np.zeros((120, 100), np.uint8))
    view.take(picture)
    ids = np.zeros((80, 60), np.uint8)
    ids[20:60, 20:40] = 1
    view.mark_body((ROI, ids))
    return view


def grey(level: int) -> Bytes:
    return np.full((120, 100, 3), level, np.uint8)


def with_person(left: int) -> Bytes:
    """A person of the drawn size, from this column on."""
    picture = grey(ROOM)
    picture[40:80, left : left + 20] = PERSON
    return picture


@pytest.mark.parametrize("moved_px", [0, 5])
def test_who_stood_there_is_forgotten_with_the_room_close_to_them(moved_px: int) -> None:
    view = view_of(with_person(40 - moved_px), with_person(40))
    view.forget_person()
    _, is_known = view.background.empty_room()
    assert not is_known[40:80, 40 - PARAMS.moved_px : 60].any()
    assert is_known[:, : 40 - PARAMS.moved_px].all()


def test_a_room_that_was_there_before_them_stays() -> None:
    view = view_of(grey(ROOM), with_person(40))
    view.forget_person()
    _, is_known = view.background.empty_room()
    assert is_known.all()
