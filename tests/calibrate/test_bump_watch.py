"""A bumped camera is told within five seconds; somebody who moves before it is not a bump."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibrate.bump.bump_watch import BumpWatch, Mounting
from mocapd.calibrate.bump.landmark_memory import LandmarkMemory
from mocapd.capture.capture_folder import folder_source, load_folder, sources_in_step
from mocapd.capture.pace import Pace
from mocapd.clock import nanoseconds, seconds
from mocapd.geometry import rotations
from mocapd.types import Bytes, Camera, Frame
from tests.calibrate.distant_scene import AXES, Room, camera, turn

NOTICED_S = 5.0  # wanted
CAPTURES = (  # and which camera of each
    ("pair_clutter_jacks", 0),
    ("pair_lampoff_basket", 1),
    ("pair_office_traffic", 0),
    ("pair_outdoor_async", 1),
    ("mono_shirt_signals", 0),
)


def watch_of(lens: Camera) -> BumpWatch:
    return BumpWatch(LandmarkMemory(lens))


class Watching:
    """Shows the watch of each room's camera one picture a second."""

    def __init__(self, *rooms: Room) -> None:
        self.rooms = rooms or (Room(camera()),)
        self.watches = [watch_of(room.camera) for room in self.rooms]
        self.t_s = 0.0

    def show(self, picture: Bytes, room: int = 0) -> Mounting:
        self.t_s += 1.0
        return self.watches[room].look(nanoseconds(self.t_s), picture)

    def steady(self, seconds_s: int = 5) -> None:
        for _ in range(seconds_s):
            said = self.show(self.rooms[0].picture())
        assert said is Mounting.STEADY


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("degrees", [0.6, 1.0, 3.0])
def test_a_bump_is_told_in_time_whatever_its_axis(axis: str, degrees: float) -> None:
    w = Watching()
    w.steady()
    began_s = w.t_s
    while w.show(w.rooms[0].picture(turn(axis, degrees))) is not Mounting.BUMPED:
        assert w.t_s - began_s < NOTICED_S
    assert w.watches[0].turn_deg == pytest.approx(degrees, abs=0.1)


def test_somebody_walking_about_for_minutes_is_no_bump() -> None:
    w, rng = Watching(), np.random.default_rng(1)
    x, y = 115, 30
    for _ in range(90):
        x, y = (
            int(np.clip(x + rng.normal(0, 30), 0, 230)),
            int(np.clip(y + rng.normal(0, 5), 0, 55)),
        )
        assert w.show(w.rooms[0].picture(person_px=(x, y))) is not Mounting.BUMPED
    assert w.watches[0].mounting is Mounting.STEADY


def test_somebody_who_moves_a_little_and_stays_there_is_no_bump() -> None:
    w = Watching()
    for x in (100, 100, 100, 100, 106, 106, 106, 106, 106, 106):
        assert w.show(w.rooms[0].picture(person_px=(x, 30))) is not Mounting.BUMPED


def test_a_table_that_is_leaned_on_for_a_moment_is_no_bump() -> None:
    w = Watching()
    w.steady()
    for degrees in (1.5, 0.0, 0.0, 1.0, 0.0, 0.0):
        assert w.show(w.rooms[0].picture(turn("pitch", degrees))) is Mounting.STEADY


def test_a_bump_in_the_first_seconds_lasts_before_it_is_told() -> None:
    w = Watching()
    said = [
        w.show(w.rooms[0].picture(turn("pitch", d))) for d in (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    ]
    assert Mounting.BUMPED not in said


def test_light_that_fades_is_no_bump_and_a_bump_in_little_light_is_told() -> None:
    w = Watching()
    w.steady()
    for light in np.linspace(1.0, 0.25, 30):
        assert w.show(w.rooms[0].picture(light=float(light))) is Mounting.STEADY
    for _ in range(4):
        said = w.show(w.rooms[0].picture(turn("yaw", 1.0), light=0.25))
    assert said is Mounting.BUMPED


def test_a_room_that_is_furnished_anew_bit_by_bit_is_still_watched() -> None:
    """The first marks go one by one; those made meanwhile hold on."""
    w, other = Watching(), Room(camera(), seed=7)
    w.steady()
    for column in range(0, 800, 16):
        w.rooms[0].canvas[:, column : column + 16] = other.canvas[:, column : column + 16]
        assert w.show(w.rooms[0].picture()) is not Mounting.BUMPED
    w.steady(15)
    for _ in range(4):
        said = w.show(w.rooms[0].picture(turn("pitch", 1.0)))
    assert said is Mounting.BUMPED


def test_a_covered_lens_is_unknown_after_a_while_and_then_steady_again() -> None:
    w = Watching()
    w.steady()
    black = np.zeros((240, 320, 3), np.uint8)
    assert w.show(black) is Mounting.STEADY
    for _ in range(12):
        said = w.show(black)
    assert said is Mounting.UNKNOWN
    w.steady()


def test_nothing_is_claimed_where_there_is_nothing_to_see() -> None:
    w = Watching()
    for _ in range(20):
        assert w.show(np.full((240, 320, 3), 128, np.uint8)) is Mounting.UNKNOWN


def test_a_camera_put_back_is_steady_again_and_its_neighbour_was_all_along() -> None:
    w = Watching(Room(camera("left")), Room(camera("right"), seed=1))
    for degrees in (0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0):
        left = w.show(w.rooms[0].picture(turn("yaw", degrees)))
        right = w.show(w.rooms[1].picture(), 1)
    assert (left, right) == (Mounting.BUMPED, Mounting.STEADY)
    for _ in range(4):
        left = w.show(w.rooms[0].picture(turn("yaw", 0.1)))
    assert left is Mounting.STEADY


def turned(pixels: Bytes, lens: Camera, axis: str, degrees: float) -> Bytes:
    """What the camera would have shown, turned; black beyond the edge of what it did show."""
    R = rotations.to_matrix(rotations.exp(turn(axis, degrees)))
    H = lens.K @ R @ np.linalg.inv(lens.K)
    return np.asarray(cv2.warpPerspective(pixels, H, lens.size_px), dtype=np.uint8)


@pytest.mark.parametrize(("name", "k"), CAPTURES)
def test_recorded_cameras_are_steady_until_they_are_turned(
    name: str, k: int, dev_captures: Callable[[str], Path]
) -> None:
    folder = load_folder(dev_captures(name))
    lens = folder.rig.cameras[k]
    shown: list[Frame] = []
    for one in sources_in_step([folder_source(folder.cameras[k], Pace(live=False))]):
        frame = one.frames[lens.name]
        if not shown or frame.t_ns - shown[-1].t_ns >= nanoseconds(0.99):
            shown.append(replace(frame, picture=frame.pixels.copy()))
    undisturbed = watch_of(lens)
    said = [undisturbed.look(f.t_ns, f.pixels) for f in shown]
    assert Mounting.BUMPED not in said
    assert said[-1] is Mounting.STEADY
    bumped, (axis, other) = watch_of(lens), (("yaw", "roll"), ("pitch", "yaw"))[k]
    for f in shown[:3]:
        bumped.look(f.t_ns, f.pixels)
    for before, f in pairwise(shown[2:]):
        pixels = turned(turned(f.pixels, lens, axis, 1.0), lens, other, 0.5)
        if bumped.look(f.t_ns, pixels) is Mounting.BUMPED:
            break
        assert seconds(before.t_ns - shown[2].t_ns) < NOTICED_S
    assert bumped.mounting is Mounting.BUMPED
