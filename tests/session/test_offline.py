"""A track's file: what the tracker said of each frame with a person."""

from pathlib import Path

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.session.offline import RecordedTrack, track_all, write_track
from mocapd.trackers.canned.tracker import UNCERTAINTY_M, CannedTracker
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
