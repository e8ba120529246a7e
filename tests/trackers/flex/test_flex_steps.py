"""Steps of the tracker without a shirt that a user leaves out: it follows all the same, without what they decide."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.trackers.flex.build import build_flex_tracker, params_of
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.section import FlexSection
from mocapd.trackers.known import known_shape
from mocapd.types import Rig, Tracking
from tests.trackers.flex.plain_film import N_EMPTY, plain_film

pytestmark = pytest.mark.kernels

STEPS = (
    "texture",
    "depths",
    "floor",
    "arm_search",
    "leg_search",
    "faces",
    "turns",
    "shadows",
    "look_alikes",
    "limits",
    "steady",
)


def without(step: str) -> FlexSection:
    return FlexSection(**{step: False})


def test_a_user_who_sets_nothing_has_the_usual_numbers() -> None:
    assert params_of(None) == params_of(FlexSection()) == Params()


def test_each_step_is_left_out_alone() -> None:
    usual = Params()
    changed = [params_of(without(step)) for step in STEPS]
    for n, one in enumerate(changed):
        assert one != usual
        assert one not in changed[:n]


@pytest.mark.parametrize("step", STEPS[:2])
def test_cameras_side_by_side_do_without_texture(step: str) -> None:
    film = plain_film()
    rig = film.known.rig
    assert rig is not None
    first, second = rig.cameras
    beside = replace(second, R=first.R, t_m=first.t_m - np.array([0.12, 0.0, 0.0]))
    close = replace(film.known, rig=Rig((first, beside)))
    tracker, shape = build_flex_tracker(close, without(step)), known_shape(close)
    tracks = [tracker.step(one, shape) for one in film.frames[:N_EMPTY]]
    assert {track.body.tracking for track in tracks} == {Tracking.LOST}


@pytest.mark.parametrize("step", STEPS[2:])
def test_without_a_step_somebody_is_followed_all_the_same(step: str) -> None:
    film = plain_film()
    tracker, shape = build_flex_tracker(film.known, without(step)), known_shape(film.known)
    tracks = [tracker.step(one, shape) for one in film.frames]
    last = tracks[-1].body
    assert last.tracking is Tracking.LIVE
    assert last.joints_m is not None
    off_m = np.linalg.norm(last.joints_m - film.joints_m[len(film.frames) - 1 - N_EMPTY], axis=1)
    assert np.median(off_m) < 0.10
