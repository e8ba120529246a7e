"""Trackers without the shirt among faces that are nobody's and people who are not meant: nobody's body is made up, and the
person stays the person."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibrate.bump.changed_places import PlacesVerdict, places_of
from mocapd.calibration.calibration_record import Calibration
from mocapd.clock import nanoseconds
from mocapd.tracking.base import Track, Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import FrameSet, Tracking
from tests.tracking.hard_film import CLOSE_PAIR, N_EMPTY, HardFilm, hard_film
from tests.tracking.profiles import hecht2009_tracker, markerless_tracker
from tests.tracking.stepping import Stepping

pytestmark = [pytest.mark.kernels, pytest.mark.long]

Build = Callable[[Calibration], Tracker]
BOTH = pytest.mark.parametrize(
    "build", [markerless_tracker, hecht2009_tracker], ids=["markerless", "hecht2009"]
)


def run(film: HardFilm, build: Build) -> list[Track]:
    tracker = Stepping(build(film.known), wearer_shape(film.known))
    return [tracker.step(one) for one in film.frames]


def hips_off_m(film: HardFilm, tracks: list[Track]) -> np.ndarray:
    """Of the frames with the person from half a second after they came; infinite where nobody is told."""
    off = []
    for track, joints_m in list(zip(tracks, film.joints_m, strict=True))[N_EMPTY + 15 :]:
        assert joints_m is not None
        told = track.body.joints_m
        off.append(np.inf if told is None else float(np.linalg.norm(told[0] - joints_m[0])))
    return np.array(off)


@BOTH
def test_a_portrait_and_somebody_who_moves_on_television_are_nobody(build: Build) -> None:
    tracks = run(hard_film("television"), build)
    assert {track.body.tracking for track in tracks} == {Tracking.LOST}


@BOTH
@pytest.mark.parametrize("scene", ["before_a_television", "passer_by", "two_people"])
def test_the_person_is_who_came_first_and_is_nearer(scene: str, build: Build) -> None:
    film = hard_film(scene)
    tracks = run(film, build)
    assert all(track.body.tracking is Tracking.LOST for track in tracks[:N_EMPTY])
    assert hips_off_m(film, tracks).max() < 0.25


def test_a_minute_without_a_face_changes_nothing() -> None:
    film = hard_film("turns_away")
    tracker = Stepping(markerless_tracker(film.known), wearer_shape(film.known))
    for one in film.frames:
        last = tracker.step(one)
    assert last.body.tracking is Tracking.LIVE
    # stands there, swaying, with the back to the cameras
    there = film.joints_m[-1]
    assert there is not None
    sways = [*range(70, 90), *range(88, 70, -1)]
    for k in range(120):
        t_ns = film.frames[-1].t_ns + nanoseconds(0.5 * (k + 1))
        track = tracker.step(_later(film.frames[sways[k % len(sways)]], t_ns))
        assert track.body.tracking is Tracking.LIVE
        assert track.body.joints_m is not None
        assert np.linalg.norm(track.body.joints_m[0] - there[0]) < 0.25


def test_a_close_pair_that_has_changed_places_is_told_by_the_room_and_harms_nothing() -> None:
    film = hard_film(CLOSE_PAIR)
    assert hips_off_m(film, run(film, markerless_tracker)).max() < 0.25
    exchanged = replace(film, frames=[_exchanged(one) for one in film.frames])
    tracks = run(replace(exchanged, frames=exchanged.frames[:60]), markerless_tracker)
    assert all(one.body.joints_m is None or np.isfinite(one.body.joints_m).all() for one in tracks)
    rig = film.known.rig
    assert rig is not None
    first, second = rig.cameras
    for shown, places in ((film, PlacesVerdict.RIGHT), (exchanged, PlacesVerdict.CHANGED)):
        pictures = [shown.frames[0].frames[camera.name].pixels for camera in (first, second)]
        assert places_of((first, second), (pictures[0], pictures[1])) is places


def _exchanged(frames: FrameSet) -> FrameSet:
    """Each camera shows what the other one sees."""
    first, second = frames.frames.values()
    swapped = replace(first, picture=second.picture), replace(second, picture=first.picture)
    return replace(frames, frames={one.camera: one for one in swapped})


def _later(frames: FrameSet, t_ns: int) -> FrameSet:
    """The same pictures at another time."""
    shown = {name: replace(one, t_ns=t_ns) for name, one in frames.frames.items()}
    return replace(frames, t_ns=t_ns, frames=shown)
