"""Two cameras that have changed places are told by the room, however symmetrically they stand; the dark tells nothing."""

from typing import Any

import cv2
import numpy as np
import pytest

from mocapd.calibrate.bump.changed_places import PlacesVerdict, places_of
from mocapd.calibrate.consistency.findings import Mistake
from mocapd.calibrate.consistency.hypotheses import exchanged_finding
from mocapd.calibrate.consistency.room_judge import with_the_room
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.world import World
from mocapd.types import Bytes, Camera
from tests.sim import small
from tests.sim.kept_film import kept

THINGS: list[dict[str, Any]] = [
    {"kind": "bookshelf", "base_m": [-0.9, 0.0, -1.6], "size_m": [1.0, 1.9, 0.3]},
    {"kind": "poster", "base_m": [0.3, 1.0, -1.9], "size_m": [0.8, 0.9, 0.02]},
    {"kind": "portrait", "base_m": [1.3, 1.0, -1.9], "size_m": [0.6, 0.8, 0.02]},
]
STANDS = {"close": 0.06, "symmetrical": 0.5}  # to the left and right of the middle [m]


@kept
def room(stand: str) -> tuple[tuple[Camera, Camera], tuple[Bytes, Bytes]]:
    """Two cameras of 640x480, and what they see of a furnished room with somebody in it."""
    table = small.table(room={"things": THINGS})
    for camera, side in zip(table["cameras"], (-1.0, 1.0), strict=True):
        x = side * STANDS[stand]
        # a close pair looks straight ahead
        ahead = x if stand == "close" else 0.0
        camera |= {
            "size_px": [640, 480],
            "position_m": [x, 1.4, 2.6],
            "look_at_m": [ahead, 1.1, 0.0],
        }
    left, right = camera_renderers(World(small.scenario(**table)), samples=1)
    return (left.camera, right.camera), (left.frame(3), right.frame(3))


@pytest.mark.parametrize("stand", STANDS)
def test_cameras_in_their_places_and_exchanged_ones_are_told_apart(stand: str) -> None:
    cameras, (a, b) = room(stand)
    assert places_of(cameras, (a, b)) is PlacesVerdict.RIGHT
    assert places_of(cameras, (b, a)) is PlacesVerdict.CHANGED


def test_cameras_that_see_different_rooms_tell_nothing() -> None:
    cameras, (a, _) = room("close")
    noise = np.random.default_rng(0).integers(0, 256, a.shape, dtype=np.uint8)
    dark = np.zeros_like(a)
    for other in (noise, dark, np.ascontiguousarray(a[::-1])):
        assert places_of(cameras, (a, other)) is PlacesVerdict.UNKNOWN


def test_the_room_says_that_a_picture_was_cut_and_takes_back_what_it_contradicts() -> None:
    cameras, (a, b) = room("close")
    exchanged = exchanged_finding(*(camera.name for camera in cameras))
    assert with_the_room(cameras, (a, b), ()) == ()
    assert with_the_room(cameras, (a, b), (exchanged,)) == ()
    assert with_the_room(cameras, (a, None), (exchanged,)) == (exchanged,)
    [finding] = with_the_room(cameras, (b, a), ())
    assert finding.mistake is Mistake.EXCHANGED
    h, w = b.shape[:2]
    cut = np.asarray(cv2.resize(b[: h * 3 // 4, : w * 3 // 4], (w, h)), np.uint8)
    [finding] = with_the_room(cameras, (a, cut), ())
    assert finding.mistake is Mistake.ZOOMED
    assert "points of the room" in finding.what
