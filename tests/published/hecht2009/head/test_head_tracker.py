"""A head is found by its face, followed, lost and found again; posters and wrong rigs give no head."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import reduce

import cv2
import numpy as np
import pytest

from mocapd.published.hecht2009.face.lbp_cascade import read_cascade
from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays
from mocapd.published.hecht2009.head.head_track import (
    HeadPicture,
    HeadState,
    HeadTrack,
)
from mocapd.published.hecht2009.head.head_tracker import HeadTracker
from mocapd.types import Bytes, Camera, Floats
from tests.published.hecht2009.face.toy_face import write_cascade
from tests.published.hecht2009.head.ball_scene import Ball, camera, narrow_pair, picture, wide_pair

STATURE_M = 1.75
DT_S = 1 / 30
Scene = Callable[[float], tuple[Ball, ...]]


def blind_cascade() -> CascadeArrays:
    """One that finds no face: heads are then found by their outline alone."""
    return CascadeArrays(
        first=np.zeros(2, np.int64),
        threshold=np.full(1, np.inf, np.float32),
        rects=np.zeros((0, 4), np.int64),
        subsets=np.zeros((0, 8), np.uint32),
        leaves=np.zeros((0, 2), np.float32),
    )


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> CascadeArrays:
    return read_cascade(write_cascade(tmp_path_factory.mktemp("toy") / "face.xml"))


def walking(t_s: float) -> Floats:
    """Up to 0.9 m/s, in depth too; nobody moves in the first half second."""
    s = max(0.0, t_s - 0.5)
    return np.array([0.25 * np.sin(2.0 * s), 1.5 + 0.04 * np.sin(7 * s), 0.3 * np.sin(1.5 * s)])


def nobody(_: float) -> tuple[Ball, ...]:
    return ()


def person(t_s: float) -> tuple[Ball, ...]:
    return (Ball(walking(t_s), yaw_rad=0.2 * np.sin(t_s)),)


def run(
    tracker: HeadTracker, cameras: Sequence[Camera], scene: Scene, end_s: float, begin_s: float = 0.0,
    offsets_s: Sequence[float] = (0.0, 0.0), knows_background: bool = False,
) -> list[HeadTrack]:  # fmt: skip
    """The tracks at DT_S from begin to end; each camera takes its picture at its own offset."""
    out = []
    for i in range(round((end_s - begin_s) / DT_S)):
        t_s = begin_s + i * DT_S
        pictures = []
        for of, late in zip(cameras, offsets_s, strict=False):
            pixels = picture(of, scene(t_s + late))
            before = foreground(of, pixels) if knows_background else None
            pictures.append(HeadPicture(pixels, late, before))
        out.append(tracker.step(pictures, DT_S))
    return out


def foreground(of: Camera, pixels: Bytes) -> Bytes:
    """Where the room does not look as it did when nobody was there."""
    change = reduce(np.maximum, cv2.split(cv2.absdiff(pixels, picture(of, ()))))
    return np.asarray(np.where(change > 15, 255, 0), np.uint8)


def with_body(t_s: float) -> tuple[Ball, ...]:
    """Nobody for half a second; then a person whose face no detector sees, with shoulders."""
    if t_s < 0.5:
        return ()
    middle = walking(t_s)
    head = Ball(middle, 0.105, 0.5, has_face=False)
    return (head, Ball(middle - (0.0, 0.40, 0.0), 0.3, has_face=False))


def errors_m(tracks: Sequence[HeadTrack], begin_s: float = 0.0) -> Floats:
    out = [
        np.linalg.norm(track.middle_m - walking(begin_s + i * DT_S))
        for i, track in enumerate(tracks)
        if track.state is HeadState.TRACKED and track.middle_m is not None
    ]
    return np.array(out)


@pytest.mark.parametrize("cameras", [narrow_pair(), wide_pair()], ids=["narrow", "wide"])
def test_a_person_who_walks_about_is_found_and_followed(
    toy: CascadeArrays, cameras: tuple[Camera, ...]
) -> None:
    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, person, 3.0)
    states = [track.state for track in tracks]
    assert states[20:].count(HeadState.TRACKED) >= 0.85 * len(states[20:])
    errors = errors_m(tracks)
    assert np.median(errors) < 0.04
    assert np.sqrt((errors[15:] ** 2).mean()) < 0.06
    assert 0.0 < tracks[-1].sigma_along_m < 0.09


def test_cameras_that_are_exposed_one_after_the_other_agree_all_the_same(
    toy: CascadeArrays,
) -> None:
    cameras, offsets = narrow_pair(), (0.0, 0.015)
    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, person, 2.5, offsets_s=offsets)
    assert np.median(errors_m(tracks)) < 0.05


def test_one_camera_goes_by_the_size_of_the_head_and_says_that_it_is_unsure(
    toy: CascadeArrays,
) -> None:
    alone = (camera(0.0, "one"),)
    tracks = run(HeadTracker(alone, STATURE_M, toy), alone, person, 2.5)
    followed = [track for track in tracks[-30:] if track.state is HeadState.TRACKED]
    assert len(followed) == 30
    assert np.median(errors_m(tracks)) < 0.5
    pair = run(HeadTracker(narrow_pair(), STATURE_M, toy), narrow_pair(), person, 2.5)
    unsure, sure = (np.median([t.sigma_along_m for t in of[-30:]]) for of in (followed, pair))
    assert unsure > 2.0 * sure


def test_a_head_that_turns_away_is_followed_and_its_face_is_not_made_up(
    toy: CascadeArrays,
) -> None:
    def turns(t_s: float) -> tuple[Ball, ...]:
        return (Ball(walking(t_s), yaw_rad=np.clip(2.5 * (t_s - 1.5), 0.0, np.pi)),)

    cameras = narrow_pair()
    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, turns, 4.0)
    behind = tracks[-20:]
    assert all(track.state is HeadState.TRACKED for track in behind)
    assert all(track.yaw_rad is None for track in behind)
    assert np.median(errors_m(tracks[-20:], 4.0 - 20 * DT_S)) < 0.06


def test_who_leaves_is_lost_and_who_comes_back_is_found_again(toy: CascadeArrays) -> None:
    cameras = narrow_pair()
    tracker = HeadTracker(cameras, STATURE_M, toy)
    assert run(tracker, cameras, person, 2.0)[-1].state is HeadState.TRACKED
    gone = run(tracker, cameras, nobody, 3.5, 2.0)
    assert gone[-1].state is HeadState.LOST
    assert gone[-1].middle_m is None
    # nobody is made up for longer than it takes to be sure
    assert [track.state for track in gone].count(HeadState.TRACKED) <= 0.8 / DT_S
    back = run(tracker, cameras, person, 5.5, 3.5)
    assert back[-1].state is HeadState.TRACKED
    assert errors_m(back, 3.5)[-10:].max() < 0.1


@pytest.mark.parametrize("cameras", [narrow_pair(), (camera(0.0, "one"),)], ids=["pair", "one"])
def test_a_photograph_on_the_wall_is_never_tracked(
    toy: CascadeArrays, cameras: tuple[Camera, ...]
) -> None:
    def poster(_: float) -> tuple[Ball, ...]:
        return (Ball(np.array([0.1, 1.6, 0.3])),)

    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, poster, 3.0)
    assert {track.state for track in tracks} == {HeadState.LOST, HeadState.FOUND}
    assert tracks[-1].state is HeadState.FOUND


def test_a_person_before_a_photograph_is_the_one_who_is_tracked(toy: CascadeArrays) -> None:
    def both(t_s: float) -> tuple[Ball, ...]:
        return (Ball(np.array([0.5, 1.75, 0.2])), *person(t_s))

    cameras = narrow_pair()
    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, both, 3.0)
    assert tracks[-1].state is HeadState.TRACKED
    assert np.median(errors_m(tracks)) < 0.05


def test_a_moving_face_of_a_doll_is_no_head_where_two_cameras_see_its_size(
    toy: CascadeArrays,
) -> None:
    def doll(t_s: float) -> tuple[Ball, ...]:
        return (Ball(np.array([0.1 * np.sin(3 * t_s), 1.5, 1.4]), radius_m=0.1),)

    # at 1.1 m a face of a person of 4 m, were it as large as that person's
    cameras = narrow_pair()
    tracks = run(HeadTracker(cameras, 4.0, toy), cameras, doll, 1.5)
    assert {track.state for track in tracks} == {HeadState.LOST}


def test_cameras_that_have_changed_places_are_refused(toy: CascadeArrays) -> None:
    left, right = narrow_pair()
    tracker = HeadTracker((left, right), STATURE_M, toy)
    tracks = run(tracker, (right, left), person, 2.0)
    assert HeadState.TRACKED not in {track.state for track in tracks}
    assert tracks[-1].state is HeadState.LOST


def test_two_cameras_in_one_place_go_by_the_size(toy: CascadeArrays) -> None:
    one = camera(0.0, "one")
    cameras = (one, replace(one, name="two"))
    tracks = run(HeadTracker(cameras, STATURE_M, toy), cameras, person, 2.0)
    assert tracks[-1].state is HeadState.TRACKED
    assert np.median(errors_m(tracks)) < 0.5


def test_no_pictures_at_all_are_no_head(toy: CascadeArrays) -> None:
    cameras = narrow_pair()
    tracker = HeadTracker(cameras, STATURE_M, toy)
    run(tracker, cameras, person, 1.5)
    dark = [tracker.step([HeadPicture(None), HeadPicture(None)], DT_S) for _ in range(40)]
    assert dark[-1].state is HeadState.LOST


def test_the_same_pictures_give_the_same_track_after_a_reset(toy: CascadeArrays) -> None:
    cameras = narrow_pair()
    tracker = HeadTracker(cameras, STATURE_M, toy)
    first = run(tracker, cameras, person, 1.5)
    tracker.reset()
    again = run(tracker, cameras, person, 1.5)
    for a, b in zip(first, again, strict=True):
        assert a.state is b.state
        assert (a.middle_m is None) == (b.middle_m is None)
        if a.middle_m is not None and b.middle_m is not None:
            assert np.array_equal(a.middle_m, b.middle_m)


def test_a_head_that_another_tracker_knows_is_followed_at_once(toy: CascadeArrays) -> None:
    cameras = narrow_pair()
    tracker = HeadTracker(cameras, STATURE_M, toy)
    tracker.reset(walking(0.0) + 0.03)
    tracks = run(tracker, cameras, person, 1.0)
    assert all(track.state is HeadState.TRACKED for track in tracks)
    assert errors_m(tracks)[10:].max() < 0.08


@pytest.mark.parametrize("cameras", [narrow_pair(), wide_pair()], ids=["narrow", "wide"])
def test_a_head_whose_face_is_not_seen_is_found_by_its_outline_before_a_known_background(
    cameras: tuple[Camera, ...],
) -> None:
    tracker = HeadTracker(cameras, STATURE_M, blind_cascade())
    tracks = run(tracker, cameras, with_body, 2.5, knows_background=True)
    assert {track.state for track in tracks[:15]} == {HeadState.LOST}
    followed = tracks[-40:]
    assert all(track.state is HeadState.TRACKED for track in followed)
    assert all(track.yaw_rad is None for track in followed)
    assert np.median(errors_m(followed, 2.5 - 40 * DT_S)) < 0.06


def test_furniture_that_is_moved_into_the_room_is_no_head() -> None:
    def box(t_s: float) -> tuple[Ball, ...]:
        return (Ball(walking(t_s), 0.45, has_face=False),)

    cameras = narrow_pair()
    tracker = HeadTracker(cameras, STATURE_M, blind_cascade())
    tracks = run(tracker, cameras, box, 1.5, knows_background=True)
    assert {track.state for track in tracks} == {HeadState.LOST}
