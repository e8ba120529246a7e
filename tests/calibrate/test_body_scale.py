"""What is said when the typed stature and the room's scale disagree."""

import math

import pytest

from mocapd.calibrate.body_shape.body_scale import Scale, scale_trouble

NAN = math.nan


@pytest.mark.parametrize("scale", [Scale(1.0, 1.0), Scale(0.95, NAN), Scale(1.05, 0.95)])
def test_people_of_one_stature_differ_a_little(scale: Scale) -> None:
    assert scale_trouble(scale, 1.75, by_wearer=False) is None


def test_a_larger_person_than_typed() -> None:
    trouble = scale_trouble(Scale(1.10, 1.09), 1.70, by_wearer=False)
    assert trouble is not None
    assert "1.87 m tall, 10 % more than the 1.70 m" in trouble.what
    assert "ruler" in trouble.fix


def test_without_a_floor_the_bones_tell() -> None:
    trouble = scale_trouble(Scale(0.90, NAN), 1.80, by_wearer=False)
    assert trouble is not None
    assert "10 % less" in trouble.what


def test_a_room_that_the_wearer_scaled_has_no_board_to_blame() -> None:
    trouble = scale_trouble(Scale(0.90, NAN), 1.80, by_wearer=True)
    assert trouble is not None
    assert "ruler" not in trouble.fix
    assert "another stature" in trouble.fix


def test_a_floor_in_the_wrong_place() -> None:
    trouble = scale_trouble(Scale(1.01, 0.90), 1.80, by_wearer=False)
    assert trouble is not None
    assert "10 % less" in trouble.what
    assert "floor" in trouble.fix


def test_bones_and_height_that_contradict_each_other() -> None:
    trouble = scale_trouble(Scale(1.12, 0.92), 1.80, by_wearer=False)
    assert trouble is not None
    assert "measure again" in trouble.fix
