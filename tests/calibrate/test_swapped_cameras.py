"""Which cameras are swapped: points of the room, the room that another camera remembers, and people, in one decision."""

from dataclasses import replace

import numpy as np

from mocapd.calibrate.bump.swapped_cameras import SwappedCameras
from mocapd.clock import nanoseconds
from mocapd.types import Bytes, Frame
from tests.calibrate.test_changed_places import room

NAMES = A, B = "left", "right"  # in that room


def newest(pictures: tuple[Bytes, Bytes], at_s: float) -> dict[str, Frame]:
    shown = zip(NAMES, pictures, strict=True)
    return {name: Frame(name, 0, nanoseconds(at_s), one) for name, one in shown}


def test_points_of_the_room_show_a_swap_and_its_end() -> None:
    cameras, (a, b) = room("close")
    swapped = SwappedCameras(cameras)
    swapped.compare_points(newest((b, a), 1.0))
    assert (swapped.partner(A), swapped.partner(B)) == (B, A)
    swapped.compare_points(newest((a, b), 2.0))
    assert swapped.is_swapped(A)  # a pair is due again only after some time
    swapped.compare_points(newest((a, b), 40.0))
    assert not swapped.is_swapped(A)
    swapped.compare_points(newest((b, a), 60.0))
    assert not swapped.is_swapped(A)  # what happens later is a bump


def test_cameras_whose_points_say_nothing_are_not_looked_at_for_ever() -> None:
    cameras, (a, b) = room("close")
    swapped = SwappedCameras((cameras[0], replace(cameras[1], name="right")))
    dark = np.zeros_like(a)
    for k in range(20):
        swapped.compare_points(newest((a, dark), 11.0 * k))
    swapped.compare_points(newest((b, a), 1000.0))
    swapped.compare_points({})
    assert not swapped.is_swapped(A)


def test_different_cameras_must_each_show_the_others_room_and_of_identical_ones_one_is_enough() -> (
    None
):
    swapped = SwappedCameras(room("close")[0])
    swapped.shows_room_of(A, B)
    assert not swapped.is_swapped(A)
    swapped.shows_room_of(B, A)
    assert (swapped.partner(A), swapped.partner(B)) == (B, A)
    swapped.shows_room_of(B, None)
    assert not swapped.is_swapped(A)
    swapped.shows_room_of(A, B, is_sure=True)
    assert (swapped.partner(A), swapped.partner(B)) == (B, None)


def test_the_views_of_people_count_until_another_comparison_or_the_room_contradicts() -> None:
    cameras, (a, b) = room("close")
    swapped = SwappedCameras(cameras)
    swapped.take_views([NAMES])
    assert (swapped.partner(A), swapped.partner(B)) == (B, A)
    swapped.take_views([])
    assert not swapped.is_swapped(A)
    swapped.take_views([NAMES])
    swapped.compare_points(newest((a, b), 1.0))
    assert not swapped.is_swapped(A)


def test_people_take_nothing_back_that_the_room_shows() -> None:
    cameras, (a, b) = room("close")
    swapped = SwappedCameras(cameras)
    swapped.compare_points(newest((b, a), 1.0))
    swapped.take_views([NAMES])
    swapped.take_views([])
    assert swapped.is_swapped(A)


def test_of_three_that_are_mixed_up_each_is_swapped_though_not_with_which_is_known() -> None:
    swapped = SwappedCameras(room("close")[0])
    swapped.take_views([(*NAMES, "third")])
    assert swapped.is_swapped("third")
    assert swapped.partner("third") is None
    swapped.take_views([])
    assert not swapped.is_swapped("third")
