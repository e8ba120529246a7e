"""Somebody who was there before the empty room was is found, and nobody in a room that is empty."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.geometry.camera_model import project
from mocapd.tracking.cues.clothes.clothes_params import RoomScanParams
from mocapd.tracking.initialisers.room_scan import places_in_view
from mocapd.tracking.tracker_inputs import calibrated_rig, wearer_shape
from mocapd.types import FrameSet, Tracking
from tests.tracking.plain_film import N_EMPTY, START_NS, plain_film
from tests.tracking.profiles import markerless_tracker
from tests.tracking.stepping import Stepping


def later(frames: FrameSet, k: int) -> FrameSet:
    """The frame set as the k-th of ten a second."""
    t_ns = START_NS + k * 100_000_000
    shown = {name: replace(frame, t_ns=t_ns) for name, frame in frames.frames.items()}
    return FrameSet(t_ns, shown)


@pytest.mark.kernels
def test_somebody_who_is_there_from_the_first_picture_on_is_found() -> None:
    """At ten pictures a second, as the film is short."""
    film = plain_film()
    tracker = Stepping(markerless_tracker(film.known), wearer_shape(film.known))
    tracks = [tracker.step(later(one, k)) for k, one in enumerate(film.frames[N_EMPTY:])]
    live = [i for i, track in enumerate(tracks) if track.body.tracking is Tracking.LIVE]
    assert live[0] < 20
    joints_m = tracks[-1].body.joints_m
    assert joints_m is not None
    assert np.median(np.linalg.norm(joints_m - film.joints_m[-1], axis=1)) < 0.08


def test_places_are_in_two_pictures_and_more_and_those_that_most_show_come_first() -> None:
    rig, params = calibrated_rig(plain_film(has_third=True).known), RoomScanParams()
    places_m, shown = places_in_view(rig.cameras, 0.95, params)
    assert len(places_m) > 5
    count = shown.sum(axis=1)
    assert count.min() >= 2
    assert (np.diff(count) <= 0).all()
    for i, camera in enumerate(rig.cameras):
        at_px = project(camera, places_m[shown[:, i]])
        assert ((at_px > 0.0) & (at_px < camera.size_px)).all()


@pytest.mark.kernels
def test_a_figure_that_never_moves_is_a_part_of_the_room() -> None:
    film = plain_film()
    tracker = Stepping(markerless_tracker(film.known), wearer_shape(film.known))
    tracks = [tracker.step(later(film.frames[-1], k)) for k in range(60)]
    assert all(track.body.tracking is Tracking.LOST for track in tracks)
