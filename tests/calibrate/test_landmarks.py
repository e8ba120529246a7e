"""The turn of a camera is read off the fixed points of the room."""

import numpy as np
import pytest

from mocapd.calibrate.bump.landmarks import find_landmarks, landmarks_at, measure_turn
from mocapd.geometry.nominal_rig import nominal_rig
from tests.calibrate.distant_scene import AXES, Room, camera, turn


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("degrees", [0.0, 0.3, 1.0, 3.0, -5.0])
def test_a_turn_is_measured_to_a_twentieth_of_a_degree(axis: str, degrees: float) -> None:
    room = Room(camera())
    marks = find_landmarks(room.picture(), room.camera)
    seen = measure_turn(marks, room.picture(turn(axis, degrees)), room.camera)
    assert np.abs(np.degrees(seen.turn_rad - turn(axis, degrees))).max() < 0.05
    assert seen.agree > 0.6 * len(marks.places)


def test_it_is_measured_through_a_lens_that_distorts() -> None:
    room = Room(camera(k1=-0.25))
    marks = find_landmarks(room.picture(), room.camera)
    seen = measure_turn(marks, room.picture(turn("yaw", 4.0)), room.camera)
    assert np.abs(np.degrees(seen.turn_rad - turn("yaw", 4.0))).max() < 0.1


def test_who_moves_before_the_room_does_not_turn_it() -> None:
    room = Room(camera())
    marks = find_landmarks(room.picture(person_px=(75, 30)), room.camera)
    for x in (78, 85, 100, 165):
        seen = measure_turn(marks, room.picture(person_px=(x, 30)), room.camera)
        assert np.degrees(np.linalg.norm(seen.turn_rad)) < 0.1


def test_nothing_agrees_where_there_is_nothing_to_see() -> None:
    room = Room(camera())
    marks, dark = find_landmarks(room.picture(), room.camera), room.picture(light=0.0)
    assert measure_turn(marks, dark, room.camera).agree < 5
    assert measure_turn(marks, room.picture()[:120], room.camera).agree == 0
    plain = find_landmarks(np.full((240, 320, 3), 90, np.uint8), room.camera)
    assert len(plain.places) == 0
    assert measure_turn(plain, room.picture(), room.camera).agree == 0


def test_the_small_picture_of_a_frame_of_any_height_shows_all_of_it() -> None:
    (webcam,) = nominal_rig("webcam", (848, 480)).cameras
    small, corner = np.zeros((90, 160), np.uint8), np.array([[159.5, 89.5]], np.float32)
    (ray,) = landmarks_at(small, corner, webcam).rays
    x, y = (np.array([847.5, 479.5]) - webcam.K[:2, 2]) / webcam.K[0, 0]
    assert ray / ray[2] == pytest.approx([x, y, 1.0])
