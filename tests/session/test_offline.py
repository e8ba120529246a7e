"""A track's file: what the tracker said of each frame with a person."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.errors import ConfigError
from mocapd.session.offline import RecordedTrack, learn_room, track_all, why_missing, write_track
from mocapd.trackers.canned.tracker import UNCERTAINTY_M, CannedTracker
from mocapd.tracking.base import LostReason, Track, lost_body
from mocapd.types import Frame, FrameSet
from tests.pipeline.free_running import PIXELS

FRAMES, PERIOD_NS = 5, 33_000_000


def test_confidence_and_uncertainty_of_every_joint_are_kept(tmp_path: Path) -> None:
    sets = [
        FrameSet(k * PERIOD_NS, {} if k == 2 else {"a": Frame("a", k, k * PERIOD_NS, PIXELS)})
        for k in range(FRAMES)
    ]
    done: list[int] = []
    track = track_all(CannedTracker(), mean_shape(1.75), sets, done.append)
    write_track(tmp_path / "a.npz", track)
    assert done == [1, 2, 3, 4, 5]
    with np.load(tmp_path / "a.npz") as kept:
        assert kept["joints"].shape == (FRAMES - 1, len(INDEX), 3)  # in one nobody was there
        assert kept["confidence"].shape == kept["uncertainty"].shape == (FRAMES - 1, len(INDEX))
        assert (kept["uncertainty"] == UNCERTAINTY_M).all()


class _BlindTracker(CannedTracker):
    """Finds nobody, and says of all frames but the first why."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        reason = LostReason.UNRECOGNISED if frames.t_ns else None
        return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=reason)


def test_why_nobody_was_tracked_is_told_with_how_often() -> None:
    sets = [FrameSet(k * PERIOD_NS, {}) for k in range(FRAMES)]
    lost = track_all(_BlindTracker(), mean_shape(1.75), sets, lambda _: None)
    assert len(lost.times_s) == 0
    assert why_missing(lost, FRAMES).startswith(
        "in 4 of 5 frames somebody moves here who is not taken for a person -- stand upright once"
    )
    well = track_all(CannedTracker(), mean_shape(1.75), sets, lambda _: None)
    assert why_missing(well, FRAMES) == ""


class _LearningTracker(CannedTracker):
    """Keeps the numbers of the frames that it learned the room from."""

    def __init__(self) -> None:
        super().__init__()
        self.learned: list[int] = []

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        self.learned += [one.frames["a"].seq for one in frames]


def test_a_room_is_learned_from_pictures_all_over_a_long_recording() -> None:
    sets = [FrameSet(k, {"a": Frame("a", k, k, PIXELS)}) for k in range(1000)]
    tracker = _LearningTracker()
    learn_room(tracker, iter(sets), len(sets))
    assert 40 < len(tracker.learned) <= 60
    assert len(set(np.diff(tracker.learned))) == 1
    assert tracker.learned[-1] > 950
    few = _LearningTracker()
    learn_room(few, iter(sets[:5]), 5)
    assert few.learned == [0, 1, 2, 3, 4]


def test_a_tracker_that_learns_no_room_is_told_so() -> None:
    with pytest.raises(ConfigError, match="'canned' learns no room"):
        learn_room(CannedTracker(), [], 0)


def test_a_track_without_uncertainties_knows_none() -> None:
    n = len(INDEX)
    track = RecordedTrack(
        np.zeros(2),
        tuple(INDEX),
        np.zeros((2, n, 3)),
        np.zeros((2, n, 4)),
        np.ones((2, n)),
        np.array(["a", "a"]),
    )
    assert np.isinf(track.uncertainty_m).all()
    assert track.uncertainty_m.shape == (2, n)
