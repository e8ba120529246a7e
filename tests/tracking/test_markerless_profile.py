"""The profile `markerless` as its users notice it: it starts by itself, follows, and goes when they go."""

from dataclasses import replace
from itertools import count, cycle

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.tracking.base import Track
from mocapd.tracking.cues.clothes import clothes_cue
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import FrameSet, Tracking
from tests.tracking.plain_film import N_EMPTY, PERIOD_NS, PlainFilm, plain_film
from tests.tracking.profiles import markerless_tracker
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels
LEGS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerLeg", "Foot")]
ARMS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerArm", "Hand")]


@pytest.fixture(scope="module")
def film() -> PlainFilm:
    return plain_film()


@pytest.fixture
def tracker(film: PlainFilm) -> Stepping:
    return Stepping(markerless_tracker(film.known), wearer_shape(film.known))


def run(tracker: Stepping, frames: list[FrameSet]) -> list[Track]:
    return [tracker.step(one) for one in frames]


def off_m(track: Track, truth: np.ndarray | None) -> np.ndarray:
    assert track.body.joints_m is not None
    assert truth is not None
    return np.asarray(np.linalg.norm(track.body.joints_m - truth, axis=1))


def is_live(track: Track) -> bool:
    return track.body.tracking is Tracking.LIVE


def test_somebody_who_walks_in_is_followed_from_head_to_foot_and_lost_on_leaving(
    film: PlainFilm, tracker: Stepping
) -> None:
    """Nothing of them stays behind."""
    tracks = run(tracker, film.frames)
    assert all(t.body.tracking is Tracking.LOST for t in tracks[:N_EMPTY])
    live = [i for i, t in enumerate(tracks) if is_live(t)]
    assert live[0] - N_EMPTY < 15  # half a second
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i - N_EMPTY]) for i in live])
    assert np.sqrt((away**2).mean()) < 0.10
    assert np.median(away[:, LEGS]) < 0.08
    assert np.median(away[:, ARMS]) < 0.10
    assert tracks[-1].quality > 0.6
    assert np.median(tracks[-1].body.confidence[LEGS]) > 0.3
    gone = run(tracker, film.empty)
    assert all(t.body.tracking is Tracking.LOST for t in gone[20:])
    assert not any(t.body.tracking is Tracking.LIVE for t in gone[2:])


def test_on_a_slow_machine_a_look_goes_on_over_some_frames(film: PlainFilm) -> None:
    slow = Stepping(
        markerless_tracker(film.known, now_ns=count(step=1_000_000_000).__next__),
        wearer_shape(film.known),
    )
    tracks = run(slow, film.frames)
    live = [i for i, t in enumerate(tracks) if is_live(t)]
    assert live[0] - N_EMPTY < 40  # one fit at each
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i - N_EMPTY]) for i in live])
    assert np.median(away) < 0.08


@pytest.mark.parametrize("gone", ["left", "right"])
def test_a_look_that_goes_on_without_a_camera_looks_in_the_other(
    film: PlainFilm, gone: str
) -> None:
    slow = Stepping(
        markerless_tracker(film.known, now_ns=count(step=1_000_000_000).__next__),
        wearer_shape(film.known),
    )
    tracks = run(slow, film.frames[:N_EMPTY])
    for k, one in enumerate(film.frames[N_EMPTY:]):
        shown = dict(one.frames)
        if k % 4 == 3 and not is_live(tracks[-1]):
            del shown[gone]
        tracks.append(slow.step(replace(one, frames=shown)))
    assert is_live(tracks[-1])
    assert np.median(off_m(tracks[-1], film.joints_m[-1])) < 0.08


def test_a_look_that_takes_seconds_does_not_throw_away_whom_it_finds(film: PlainFilm) -> None:
    """Beside programs that leave it little, the next picture is newer than a track lasts without evidence."""
    t_ns, looked = film.frames[0].t_ns, False

    def now_ns() -> int:  # read before and after each fit
        nonlocal t_ns, looked
        t_ns, looked = t_ns + 50_000_000, True
        return t_ns

    slow = Stepping(markerless_tracker(film.known, now_ns=now_ns), wearer_shape(film.known))

    def shown(frames: FrameSet) -> Tracking:
        nonlocal t_ns, looked
        at = {name: replace(frame, t_ns=t_ns) for name, frame in frames.frames.items()}
        tracking = slow.step(FrameSet(t_ns, at)).body.tracking
        t_ns, looked = t_ns + (1_100_000_000 if looked else PERIOD_NS), False
        return tracking

    assert {shown(one) for one in film.frames[:N_EMPTY]} == {Tracking.LOST}
    moves = cycle(film.frames[N_EMPTY:] + film.frames[:N_EMPTY:-1])
    assert any(shown(next(moves)) is Tracking.LIVE for _ in range(1000))
    assert {shown(next(moves)) for _ in range(20)} == {Tracking.LIVE}


def test_a_camera_that_is_unplugged_leaves_the_other(film: PlainFilm, tracker: Stepping) -> None:
    tracks = run(tracker, film.frames[:-15])
    alone = [replace(f, frames={"left": f.frames["left"]}) for f in film.frames[-15:]]
    tracks = run(tracker, alone)
    assert all(t.body.tracking is Tracking.LIVE for t in tracks)
    assert tracks[-1].body.cameras == ("left",)


def test_a_camera_that_is_plugged_in_later_joins_without_a_gap() -> None:
    film = plain_film(has_third=True)
    tracker = Stepping(markerless_tracker(film.known), wearer_shape(film.known))
    joins = N_EMPTY + 20
    early = [
        replace(one, frames={n: f for n, f in one.frames.items() if n != "back"})
        for one in film.frames[:joins]
    ]
    assert is_live(run(tracker, early)[-1])
    tracks = run(tracker, film.frames[joins:])
    assert all(is_live(track) for track in tracks)
    assert "back" in tracks[-1].body.cameras
    assert np.median(off_m(tracks[-1], film.joints_m[-1])) < 0.08


def test_a_recording_that_never_shows_the_room_empty_tells_it_all_the_same() -> None:
    film = plain_film(to_m=(0.6, 0.2))
    never_empty = film.frames[N_EMPTY:]
    shape = wearer_shape(film.known)
    tracker = markerless_tracker(film.known)
    tracker.learn_room(never_empty)
    tracks = [tracker.step(one, shape) for one in never_empty]
    live = [i for i, t in enumerate(tracks) if t.body.tracking is Tracking.LIVE]
    assert live[0] < 15
    assert live == list(range(live[0], len(tracks)))
    away = np.array([off_m(tracks[i], film.joints_m[i]) for i in live])
    assert np.median(away) < 0.10
    # without it the person is a part of the room, or their trace is
    tracker.reset()
    alone = [tracker.step(one, shape) for one in never_empty]
    assert sum(t.body.tracking is Tracking.LIVE for t in alone) < len(live) // 2


def test_before_three_cameras_nobody_is_pulled_to_keypoints_and_let_go_at_half_the_frame_rate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They are detected in every second frame set, and shared with the next."""
    film = plain_film(has_third=True)

    def trembling_mm() -> float:
        tracker = Stepping(markerless_tracker(film.known), wearer_shape(film.known))
        tracks = run(tracker, film.frames)
        off = [off_m(t, film.joints_m[i]) for i, t in enumerate(tracks[N_EMPTY:]) if is_live(t)]
        return float(1e3 * np.abs(np.diff(off, 2, axis=0)).mean())

    shared_mm = trembling_mm()
    monkeypatch.setattr(clothes_cue, "_SHARED_FROM", 99)
    assert shared_mm < 0.6 * trembling_mm()
