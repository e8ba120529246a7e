"""A bumped camera is said once in the log, with what to do; and once when it is back."""

import logging

import pytest

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.clock import nanoseconds
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service.mountings import Mountings
from mocapd.types import Bytes, Frame, Rig
from tests.calibrate.distant_scene import Room, camera, turn
from tests.calibrate.test_changed_places import room


class Showing:
    """A hub whose one camera shows what it is given, looked at every second."""

    def __init__(self) -> None:
        self.room = Room(camera())
        self.hub = FrameHub(["left"])
        self.mountings = Mountings(Rig((self.room.camera, camera("unplugged"))), self.hub)
        self.seq = 0

    def show(self, pixels: Bytes, times: int = 1) -> Mounting:
        for _ in range(times):
            self.seq += 1
            self.hub.put(Frame("left", self.seq, nanoseconds(self.seq), pixels))
            self.mountings.look()
        return self.mountings.of("left")


def test_it_is_said_once_and_so_is_its_end(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    one = Showing()
    assert one.show(one.room.picture(), 5) is Mounting.STEADY
    assert not caplog.records
    assert one.show(one.room.picture(turn("yaw", 2.0)), 8) is Mounting.BUMPED
    [warning] = caplog.records
    assert warning.levelno == logging.WARNING
    assert "'left' was turned by about 2.0 degrees" in warning.message
    assert "mocapd calibrate --step room" in warning.message
    assert one.show(one.room.picture(), 8) is Mounting.STEADY
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.INFO]


def test_the_same_picture_says_nothing_new_and_one_of_another_size_nothing_at_all() -> None:
    one = Showing()
    one.show(one.room.picture())
    for _ in range(5):
        one.mountings.look()
    assert one.mountings.of("left") is Mounting.UNKNOWN
    assert one.show(one.room.picture()[:120], 5) is Mounting.UNKNOWN


def test_two_cameras_that_have_changed_places_are_said_with_what_to_do(
    caplog: pytest.LogCaptureFixture,
) -> None:
    cameras, (a, b) = room("close")
    hub = FrameHub([one.name for one in cameras])
    mountings = Mountings(Rig(cameras), hub)
    for k in range(4):
        for one, pixels in zip(cameras, (b, a), strict=True):
            hub.put(Frame(one.name, k, nanoseconds(k), pixels))
        mountings.look()
    [warning] = caplog.records
    assert "'left' and 'right' have changed places" in warning.message
    assert "mocapd calibrate --step room" in warning.message
    assert {mountings.of(one.name) for one in cameras} == {Mounting.SWAPPED}


def test_without_a_rig_nothing_is_known() -> None:
    nothing = Mountings(None, FrameHub(["left"]))
    nothing.look()
    assert nothing.of("left") is Mounting.UNKNOWN
