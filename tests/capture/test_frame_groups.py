"""Frames put together anew once the times of some cameras are corrected."""

import numpy as np

from mocapd.capture.frame_groups import as_set, delayed_sets
from mocapd.types import Frame, FrameSet

PIXELS = np.zeros((2, 2, 3), np.uint8)


def frame(camera: str, index: int) -> Frame:
    return Frame(camera, index, round(index * 1e9 / 30.0), PIXELS)


def in_step(count: int) -> list[FrameSet]:
    return [as_set({name: frame(name, k) for name in ("a", "b")}) for k in range(count)]


def test_what_one_camera_shows_later_comes_with_the_others_of_its_moment() -> None:
    sets = list(delayed_sets(in_step(20), ("a", "b"), {"b": 3 / 30.0}, 30.0))
    both = [one for one in sets if len(one.frames) == 2]
    assert [one.frames["a"].seq - one.frames["b"].seq for one in both] == [3] * 17
    assert sum(len(one.frames) for one in sets) == 40
    assert [one.t_ns for one in sets] == sorted(one.t_ns for one in sets)


def test_a_camera_that_ends_holds_nobody_up() -> None:
    sets = [*in_step(5), *(as_set({"a": frame("a", k)}) for k in range(5, 400))]
    out = delayed_sets(iter(sets), ("a", "b"), {"b": 0.1}, 30.0)
    assert [one.frames["a"].seq for one in out if "a" in one.frames] == list(range(400))
