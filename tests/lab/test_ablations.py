"""Ablations: each changes one thing, and the tracker still runs without the step."""

from dataclasses import replace

import numpy as np
import pytest

from lab.ablations import flex_ablations, flex_paper_ablations
from mocapd.trackers.flex.build import build_flex_tracker
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex_paper.params import Params as PaperParams
from mocapd.trackers.known import known_shape
from mocapd.types import Rig, Tracking
from tests.trackers.flex.plain_film import N_EMPTY, plain_film

pytestmark = pytest.mark.kernels

BESIDE_ONLY = ("no texture", "no depths")  # steps of cameras side by side
IN_ANY_RIG = [label for label in flex_ablations() if label not in ("no joints", *BESIDE_ONLY)]


def test_each_ablation_differs_from_the_tracker_and_from_the_others() -> None:
    for usual, changed in ((Params(), flex_ablations()), (PaperParams(), flex_paper_ablations())):
        different = [usual, *changed.values()]
        assert all(one not in different[:n] for n, one in enumerate(different))


@pytest.mark.parametrize("label", BESIDE_ONLY)
def test_cameras_side_by_side_run_without_a_step(label: str) -> None:
    film = plain_film()
    rig = film.known.rig
    assert rig is not None
    first, second = rig.cameras
    beside = replace(second, R=first.R, t_m=first.t_m - np.array([0.12, 0.0, 0.0]))
    close = replace(film.known, rig=Rig((first, beside)))
    tracker, shape = build_flex_tracker(close, flex_ablations()[label]), known_shape(close)
    tracks = [tracker.step(one, shape) for one in film.frames[:N_EMPTY]]
    assert {track.body.tracking for track in tracks} == {Tracking.LOST}


@pytest.mark.parametrize("label", IN_ANY_RIG)
def test_without_a_step_somebody_is_followed_all_the_same(label: str) -> None:
    film = plain_film()
    tracker = build_flex_tracker(film.known, flex_ablations()[label])
    shape = known_shape(film.known)
    tracks = [tracker.step(one, shape) for one in film.frames]
    last = tracks[-1].body
    assert last.tracking is Tracking.LIVE
    assert last.joints_m is not None
    off_m = np.linalg.norm(last.joints_m - film.joints_m[len(film.frames) - 1 - N_EMPTY], axis=1)
    assert np.median(off_m) < 0.10
