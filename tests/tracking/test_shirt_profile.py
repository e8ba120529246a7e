"""The profile `shirt` on simulated pictures: found, followed, lost, found again."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, PARENTS, joint_positions
from mocapd.errors import ConfigError
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.base import Track
from mocapd.types import BodyState, Bytes, Floats, FrameSet, Tracking
from tests.tracking.shirt_film import Filmed, Pictures, film, tracker_of
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

UPPER = [
    j for name, j in INDEX.items() if not any(s in name for s in ("Leg", "Foot", "Toes", "head"))
]
WRISTS = [INDEX["leftHand"], INDEX["rightHand"]]
CONFIRM = 2  # frames that a return is looked at before it is believed


@pytest.fixture(scope="module")
def filmed() -> Filmed:
    return film()


@pytest.fixture(scope="module")
def built(filmed: Filmed, pose_database: PoseDatabase) -> Stepping:
    return tracker_of(filmed, pose_database)


@pytest.fixture
def tracker(built: Stepping) -> Stepping:
    built.reset()
    return built


def run(tracker: Stepping, frames: Sequence[FrameSet]) -> list[BodyState]:
    return [tracker.step(frame).body for frame in frames]


def error_m(body: BodyState, truth_m: Floats) -> float:
    """RMS over the upper joints."""
    assert body.joints_m is not None
    apart = np.linalg.norm(body.joints_m - truth_m, axis=1)[UPPER]
    return float(np.sqrt((apart**2).mean()))


def first_live(bodies: Sequence[BodyState]) -> int:
    return next(i for i, body in enumerate(bodies) if body.tracking is Tracking.LIVE)


def dark(pictures: Pictures) -> Pictures:
    return {name: np.zeros_like(pixels) for name, pixels in pictures.items()}


def test_it_finds_the_person_and_follows_within_five_centimetres(
    tracker: Stepping, filmed: Filmed
) -> None:
    shown = filmed.empty[:6] + filmed.pictures
    bodies = run(tracker, filmed.frame_sets(shown))[6:]
    found = first_live(bodies)
    assert found <= 5 + CONFIRM
    for body, truth in zip(bodies[found:], filmed.joints_m[found:], strict=True):
        assert body.tracking is Tracking.LIVE
        assert error_m(body, truth) < 0.05
        assert set(body.cameras) == {"left", "right"}
        assert body.confidence[UPPER].mean() > 0.5


def test_a_body_is_one_pose_of_its_skeleton(tracker: Stepping, filmed: Filmed) -> None:
    for frame in filmed.frame_sets(filmed.pictures[:12]):
        body = tracker.step(frame).body
        if body.pose is None or body.joints_m is None:
            continue
        np.testing.assert_allclose(np.linalg.norm(body.pose.quats_xyzw, axis=1), 1.0, atol=1e-9)
        assert (body.pose.quats_xyzw[:, 3] >= 0.0).all()
        posed = joint_positions(tracker.skeleton, body.pose)
        np.testing.assert_allclose(body.joints_m, posed, atol=1e-9)
    rest = tracker.skeleton.rest_m
    lengths = np.linalg.norm(rest[1:] - rest[PARENTS[1:]], axis=1)
    true = np.linalg.norm(filmed.joints_m[0][1:] - filmed.joints_m[0][PARENTS[1:]], axis=1)
    np.testing.assert_allclose(lengths, true, atol=0.04)


def test_an_empty_room_is_lost_throughout(tracker: Stepping, filmed: Filmed) -> None:
    for frame in filmed.frame_sets(filmed.empty):
        track = tracker.step(frame)
        body = track.body
        assert body.tracking is Tracking.LOST
        assert body.pose is None
        assert body.joints_m is None
        assert not body.confidence.any()
        assert body.cameras == ()
        assert body.t_ns == frame.t_ns


@pytest.mark.parametrize("gone", ["away", "dark"])
def test_who_is_gone_is_lost_and_found_again_within_five_frames(
    tracker: Stepping, filmed: Filmed, gone: str
) -> None:
    absent = [
        filmed.empty[i % 10] if gone == "away" else dark(filmed.pictures[0]) for i in range(20)
    ]
    there, back = filmed.pictures[:16], filmed.pictures[16:30]
    bodies = run(tracker, filmed.frame_sets(filmed.empty[:6] + there + absent + back))
    before, during, after = bodies[6:22], bodies[22:42], bodies[42:]
    assert before[-1].tracking is Tracking.LIVE
    # the pose is predicted for half a second, believed less and less, and then nobody is there
    states = [body.tracking for body in during]
    coasted = states.count(Tracking.COASTING)
    assert states == [Tracking.COASTING] * coasted + [Tracking.LOST] * (len(states) - coasted)
    assert 10 <= coasted <= 15
    trust = [body.confidence.max() for body in during[:coasted]]
    assert trust == sorted(trust, reverse=True)
    assert all(error_m(body, filmed.joints_m[15]) < 0.3 for body in during[:coasted])
    found = first_live(after)
    assert found <= 5 + CONFIRM
    assert error_m(after[-1], filmed.joints_m[29]) < 0.05


def test_one_camera_goes_missing_for_a_while(tracker: Stepping, filmed: Filmed) -> None:
    shown: list[Pictures] = []
    for i, pictures in enumerate(filmed.pictures):
        alone = {"left": pictures["left"]} if 14 <= i < 20 else {"right": pictures["right"]}
        shown.append(alone if 14 <= i < 24 else pictures)
    shown[26] = {}
    bodies = run(tracker, filmed.frame_sets(shown))
    both, one, none = bodies[13], bodies[14:24], bodies[26]
    for i, body in enumerate(one, start=14):
        assert body.tracking is Tracking.LIVE
        assert body.cameras == (("left",) if i < 20 else ("right",))
        assert error_m(body, filmed.joints_m[i]) < 0.15  # distance is a guess
        assert body.confidence[WRISTS].max() < both.confidence[WRISTS].max()
    assert none.tracking is Tracking.COASTING
    assert none.cameras == ()
    for body, truth in zip(bodies[28:], filmed.joints_m[28:], strict=True):
        assert body.tracking is Tracking.LIVE
        assert error_m(body, truth) < 0.05


def same(a: Track, b: Track) -> bool:
    if a.body.tracking is not b.body.tracking or a.evidence.keys() != b.evidence.keys():
        return False
    arrays: list[tuple[Floats | Bytes, Floats | Bytes]] = [(a.body.confidence, b.body.confidence)]
    arrays += [(a.evidence[name], b.evidence[name]) for name in a.evidence]
    if a.body.joints_m is not None and b.body.joints_m is not None:
        arrays.append((a.body.joints_m, b.body.joints_m))
    if a.body.pose is not None and b.body.pose is not None:
        arrays.append((a.body.pose.quats_xyzw, b.body.pose.quats_xyzw))
    return all(np.array_equal(x, y) for x, y in arrays)


def test_the_same_frames_after_reset_give_the_same(tracker: Stepping, filmed: Filmed) -> None:
    shown = filmed.empty[:3] + filmed.pictures[:14] + filmed.empty[3:6] + filmed.pictures[14:20]
    frames = filmed.frame_sets(shown)
    first = [tracker.step(frame) for frame in frames]
    tracker.reset()
    again = [tracker.step(frame) for frame in frames]
    assert all(same(a, b) for a, b in zip(first, again, strict=True))
    assert first[-1].body.tracking is Tracking.LIVE


def test_evidence_shows_the_shirt_where_the_person_is(tracker: Stepping, filmed: Filmed) -> None:
    track = [tracker.step(frame) for frame in filmed.frame_sets(filmed.pictures[:10])][-1]
    assert set(track.evidence) == {"left", "right"}
    for name, ids in track.evidence.items():
        x0, y0, x1, y1 = track.roi_px[name]
        assert ids.shape == (y1 - y0, x1 - x0)
        assert len(np.unique(ids)) >= 8
        assert ids.max() <= 10


def test_a_picture_of_another_size_is_told(tracker: Stepping, filmed: Filmed) -> None:
    frame = filmed.frame_sets(filmed.pictures[:1])[0]
    small = replace(frame.frames["left"], picture=np.zeros((120, 160, 3), np.uint8))
    with pytest.raises(ConfigError, match=r"160x120.*320x240"):
        tracker.step(replace(frame, frames={"left": small}))
