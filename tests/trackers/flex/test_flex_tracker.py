"""The tracker without a shirt as its users notice it: it starts by itself, follows, goes when they go, and can be led."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.trackers.base import Track
from mocapd.trackers.flex.build import build_flex_tracker
from mocapd.trackers.known import known_shape
from mocapd.types import FrameSet, Tracking
from tests.trackers.flex.plain_film import N_EMPTY, PlainFilm, plain_film
from tests.trackers.stepping import Stepping

pytestmark = pytest.mark.kernels
LEGS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerLeg", "Foot")]
ARMS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerArm", "Hand")]


@pytest.fixture(scope="module")
def film() -> PlainFilm:
    return plain_film()


@pytest.fixture
def tracker(film: PlainFilm) -> Stepping:
    return Stepping(build_flex_tracker(film.known), known_shape(film.known))


def run(tracker: Stepping, frames: list[FrameSet]) -> list[Track]:
    return [tracker.step(one) for one in frames]


def off_m(track: Track, truth: np.ndarray | None) -> np.ndarray:
    assert track.body.joints_m is not None
    assert truth is not None
    return np.asarray(np.linalg.norm(track.body.joints_m - truth, axis=1))


def test_somebody_who_walks_in_is_followed_from_head_to_foot(
    film: PlainFilm, tracker: Stepping
) -> None:
    tracks = run(tracker, film.frames)
    assert all(t.body.tracking is Tracking.LOST for t in tracks[:N_EMPTY])
    live = [i for i, t in enumerate(tracks) if t.body.tracking is Tracking.LIVE]
    assert live[0] - N_EMPTY < 15  # half a second
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i - N_EMPTY]) for i in live])
    assert np.sqrt((away**2).mean()) < 0.10
    assert np.median(away[:, LEGS]) < 0.08
    assert np.median(away[:, ARMS]) < 0.10
    assert tracks[-1].quality > 0.6
    assert np.median(tracks[-1].body.confidence[LEGS]) > 0.3


def test_on_a_slow_machine_a_look_goes_on_over_some_frames(film: PlainFilm) -> None:
    slow = Stepping(
        build_flex_tracker(film.known, now_ns=count(step=1_000_000_000).__next__),
        known_shape(film.known),
    )
    tracks = run(slow, film.frames)
    live = [i for i, t in enumerate(tracks) if t.body.tracking is Tracking.LIVE]
    assert live[0] - N_EMPTY < 40  # one fit at each
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i - N_EMPTY]) for i in live])
    assert np.median(away) < 0.08


def test_who_leaves_is_lost_and_nothing_stays_behind(film: PlainFilm, tracker: Stepping) -> None:
    assert run(tracker, film.frames)[-1].body.tracking is Tracking.LIVE
    gone = run(tracker, film.empty)
    assert all(t.body.tracking is Tracking.LOST for t in gone[20:])
    assert not any(t.body.tracking is Tracking.LIVE for t in gone[2:])


def test_a_camera_that_is_unplugged_leaves_the_other(film: PlainFilm, tracker: Stepping) -> None:
    tracks = run(tracker, film.frames[:-15])
    alone = [replace(f, frames={"left": f.frames["left"]}) for f in film.frames[-15:]]
    tracks = run(tracker, alone)
    assert all(t.body.tracking is Tracking.LIVE for t in tracks)
    assert tracks[-1].body.cameras == ("left",)


def test_led_by_another_tracker_it_keeps_the_upper_body_and_adds_the_legs(
    film: PlainFilm, tracker: Stepping
) -> None:
    guides = [t.body for t in run(tracker, film.frames)]
    flex, shape = build_flex_tracker(film.known), known_shape(film.known)
    upper = [INDEX[n] for n in ("hips", "leftLowerArm", "rightHand", "upperChest")]
    for number, (frame, guide) in enumerate(zip(film.frames, guides, strict=True)):
        if guide.pose is None:
            flex.step(frame, shape)
            continue
        # the guide knows nothing of legs
        quats = guide.pose.quats_xyzw.copy()
        quats[LEGS] = quats[0]
        known = replace(guide, pose=replace(guide.pose, quats_xyzw=quats))
        track = flex.step_guided(frame, shape, known)
        if number > N_EMPTY + 12:
            assert track.body.tracking is Tracking.LIVE
            apart = off_m(track, guide.joints_m)
            assert apart[upper].max() < 0.06
            assert np.median(off_m(track, film.joints_m[number - N_EMPTY])[LEGS]) < 0.10


def test_prepared_before_its_guide_is_known_it_finds_the_same(
    film: PlainFilm, tracker: Stepping
) -> None:
    guides = [t.body for t in run(tracker, film.frames)]
    shape = known_shape(film.known)
    at_once, prepared = build_flex_tracker(film.known), build_flex_tracker(film.known)
    led = 0
    for frame, guide in zip(film.frames, guides, strict=True):
        if guide.pose is None:
            for flex in (at_once, prepared):
                flex.step(frame, shape)
            continue
        prepared.prepare(frame)
        tracks = [flex.step_guided(frame, shape, guide) for flex in (at_once, prepared)]
        assert tracks[1].body.tracking is tracks[0].body.tracking
        if led > 12:
            assert off_m(tracks[1], tracks[0].body.joints_m).max() < 0.10
        led += 1
    # whoever led it is gone, and it was prepared all the same
    prepared.prepare(film.frames[-1])
    assert prepared.step(film.frames[-1], shape).body.tracking is Tracking.LIVE


def test_after_it_was_led_it_goes_on_alone(film: PlainFilm, tracker: Stepping) -> None:
    guides = [t.body for t in run(tracker, film.frames)]
    flex, shape = build_flex_tracker(film.known), known_shape(film.known)
    half = N_EMPTY + 25
    for frame, guide in zip(film.frames[:half], guides, strict=False):
        track = (
            flex.step(frame, shape) if guide.pose is None else flex.step_guided(frame, shape, guide)
        )
    for number in range(half, len(film.frames)):
        track = flex.step(film.frames[number], shape)
        assert track.body.tracking is Tracking.LIVE
    assert np.sqrt((off_m(track, film.joints_m[-1]) ** 2).mean()) < 0.12


def test_a_recording_that_never_shows_the_room_empty_tells_it_all_the_same() -> None:
    film = plain_film(to_m=(0.6, 0.2))
    never_empty = film.frames[N_EMPTY:]
    shape = known_shape(film.known)
    flex = build_flex_tracker(film.known)
    flex.learn_room(never_empty)
    tracks = [flex.step(one, shape) for one in never_empty]
    live = [i for i, t in enumerate(tracks) if t.body.tracking is Tracking.LIVE]
    assert live[0] < 15
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i]) for i in live])
    assert np.median(away) < 0.10
    # without it the person is a part of the room, or their trace is
    flex.reset()
    alone = [flex.step(one, shape) for one in never_empty]
    assert sum(t.body.tracking is Tracking.LIVE for t in alone) < len(live) // 2


def test_a_guide_without_a_pose_is_a_defect(film: PlainFilm) -> None:
    tracker = build_flex_tracker(film.known)
    nobody = tracker.step(film.frames[0], known_shape(film.known)).body
    with pytest.raises(ValueError, match="no pose"):
        tracker.step_guided(film.frames[1], known_shape(film.known), nobody)
