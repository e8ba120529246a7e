"""What a camera's pictures say of it: frozen after a while, black without being frozen, and well again."""

import pytest

from mocapd.capture.camera_thread.frame_faults import FROZEN_NS, FROZEN_VIDEO_NS, FrameFaults
from mocapd.capture.jpeg_picture import JpegPicture
from mocapd.clock import NS_PER_S
from mocapd.types import Frame
from tests.capture.films import picture

PERIOD_NS = NS_PER_S // 10


def frame(number: int, shown: int, jpeg: bool = True) -> Frame:
    """What is shown at this place of a film of 10 Hz."""
    pixels = picture(shown)
    one = JpegPicture(bytes([shown]) * 9, pixels) if jpeg else pixels
    return Frame("a", number, number * PERIOD_NS, one)


@pytest.mark.parametrize(("jpeg", "limit_ns"), [(True, FROZEN_NS), (False, FROZEN_VIDEO_NS)])
def test_the_same_picture_is_frozen_after_a_while_and_another_one_ends_it(
    jpeg: bool, limit_ns: int
) -> None:
    faults = FrameFaults()
    frames = limit_ns // PERIOD_NS
    for number in range(frames):
        faults.add(frame(number, 7, jpeg), 0)
        assert not faults.frozen
    faults.add(frame(frames, 7, jpeg), 0)
    assert faults.frozen
    faults.add(frame(frames + 1, 8, jpeg), 0)
    assert not faults.frozen


def test_a_covered_lens_is_black_and_not_frozen() -> None:
    faults = FrameFaults()
    black = picture(0) * 0
    told = [
        faults.add(Frame("a", number, number * PERIOD_NS, JpegPicture(b"black", black)), 0)
        for number in range(100)
    ]
    assert not faults.frozen
    assert "is black" in faults.notice
    assert sum(told) == 1
    assert any(faults.add(frame(number, number), 0) for number in range(100, 110))
    assert faults.notice == ""


def test_a_damaged_picture_now_and_then_is_the_world_and_many_are_a_cable() -> None:
    faults = FrameFaults()
    for number in range(200):
        faults.add(frame(number, number), number // 50)
    assert faults.notice == ""
    for number in range(200, 260):
        faults.add(frame(number, number % 250), number - 196)
    assert "come damaged" in faults.notice
