"""Ablations: each disables one step, and the tracker follows somebody all the same."""

from dataclasses import replace

import numpy as np
import pytest

from lab.compared.ablations import CLOTHES_ABLATIONS, HECHT2009_ABLATIONS
from lab.compared.rivals import RIVALS, ready_rival
from mocapd.published.hecht2009.params import Params as Hecht2009Params
from mocapd.trackers.registry import TRACKERS, Resources
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Rig, Tracking
from tests.tracking.plain_film import N_EMPTY, plain_film

pytestmark = pytest.mark.kernels


def test_each_ablation_differs_from_the_tracker_and_from_the_others() -> None:
    for usual, edits in (
        (ClothesParams(), CLOTHES_ABLATIONS.values()),
        (Hecht2009Params(), HECHT2009_ABLATIONS.values()),
    ):
        different = [usual, *(edit(usual) for edit in edits)]  # type: ignore[arg-type]
        assert all(one not in different[:n] for n, one in enumerate(different))


def test_every_tracker_that_is_compared_exists() -> None:
    assert set(RIVALS) <= set(TRACKERS)


@pytest.mark.parametrize("label", ["no joints", "no floor", "no shadows", "no limits"])
def test_without_a_step_somebody_is_followed_all_the_same(label: str) -> None:
    film = plain_film()
    ready = ready_rival(RIVALS["markerless"][label], Resources(), film.known)
    tracks = [ready.tracker.step(one, ready.shape) for one in film.frames]
    last = tracks[-1].body
    assert last.tracking is Tracking.LIVE
    assert last.joints_m is not None
    off_m = np.linalg.norm(last.joints_m - film.joints_m[len(film.frames) - 1 - N_EMPTY], axis=1)
    assert np.median(off_m) < 0.10


@pytest.mark.parametrize("label", ["no texture", "no depths"])
def test_cameras_side_by_side_run_without_a_step(label: str) -> None:
    film = plain_film()
    rig = film.known.rig
    assert rig is not None
    first, second = rig.cameras
    beside = replace(second, R=first.R, t_m=first.t_m - np.array([0.12, 0.0, 0.0]))
    close = replace(film.known, rig=Rig((first, beside)))
    ready = ready_rival(RIVALS["markerless"][label], Resources(), close)
    tracks = [ready.tracker.step(one, ready.shape) for one in film.frames[:N_EMPTY]]
    assert {track.body.tracking for track in tracks} == {Tracking.LOST}
