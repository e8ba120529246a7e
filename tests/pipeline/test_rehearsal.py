"""The rehearsal before the first frame: what the tracker is shown, and that it forgets it."""

import numpy as np

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.pipeline.rehearsal import STEPS, rehearse
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import BodyState, Camera, FrameSet, Rig


def camera(name: str) -> Camera:
    return Camera(name, (8, 6), np.eye(3), np.zeros(5), np.eye(3), np.zeros(3))


class Witness(CannedTracker):
    """Remembers what it was shown since the last reset."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: list[FrameSet] = []
        self.before_reset: list[FrameSet] = []

    def reset(self, near: BodyState | None = None) -> None:
        self.before_reset, self.shown = self.shown, []

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self.shown.append(frames)
        return super().step(frames, shape)


def test_it_is_shown_the_person_and_forgets_it() -> None:
    tracker, told = Witness(), []
    picture = np.full((6, 8, 3), 7, np.uint8)
    wrong = np.full((12, 16, 3), 7, np.uint8)
    rig = Rig((camera("a"), camera("b"), camera("c")))
    rehearse(
        tracker,
        mean_shape(1.75),
        rig,
        {"a": picture, "b": wrong},
        lambda *parts: told.append(parts),
    )

    assert tracker.shown == []
    assert len(tracker.before_reset) == STEPS
    times = [frames.t_ns for frames in tracker.before_reset]
    assert times == sorted(set(times))
    for frames in tracker.before_reset:
        assert list(frames.frames) == ["a", "b", "c"]
        assert {frame.pixels.shape for frame in frames.frames.values()} == {(6, 8, 3)}
        assert [int(f.pixels.max()) for f in frames.frames.values()] == [7, 0, 0]
    assert told[0] == (0, STEPS)
    assert told[-1] == (STEPS, STEPS)


def test_without_a_rig_there_is_nothing_to_show() -> None:
    tracker = Witness()
    rehearse(tracker, mean_shape(1.75), None, {}, lambda *_: None)
    assert {len(frames.frames) for frames in tracker.before_reset} == {0}
