"""Arms that no picture confirms do not flail; all else of an upper body is told as it was found."""

from dataclasses import replace

import numpy as np

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions, standard_skeleton
from mocapd.clock import nanoseconds
from mocapd.trackers.base import Track, lost_body
from mocapd.trackers.steadying import Told
from mocapd.trackers.supervisor.params import Params
from mocapd.trackers.supervisor.steady_arms import with_steady_arms
from mocapd.types import Floats, Tracking
from tests.body.random_poses import pose_of, random_local, random_root

SKELETON = standard_skeleton(1.75)
SHAPE: BodyShape = mean_shape(1.75)
HANDS = [INDEX["leftHand"], INDEX["rightHand"]]
TRUNK = [INDEX["hips"], INDEX["chest"], INDEX["neck"]]


def track(frame: int, seed: int, confidence: float) -> Track:
    pose = pose_of(SKELETON, random_root(0), random_local(seed, 0.4))
    body = replace(
        lost_body(nanoseconds(frame / 30), "colour"), tracking=Tracking.LIVE, pose=pose,
        joints_m=joint_positions(SKELETON, pose), confidence=np.full(N_JOINTS, confidence),
        uncertainty_m=np.zeros(N_JOINTS),
    )  # fmt: skip
    return Track(body, SHAPE)


def told_after_a_second(confidence: float) -> tuple[Track, Track]:
    """Found and told in the frame in which somebody is otherwise all at once."""
    told: Told | None = None
    for frame in range(30):
        _, told = with_steady_arms(track(frame, 1, confidence), SHAPE, told, Params().steadying)
    found = track(30, 2, confidence)
    return found, with_steady_arms(found, SHAPE, told, Params().steadying)[0]


def places(one: Track) -> Floats:
    assert one.body.joints_m is not None
    return one.body.joints_m


def test_what_is_confirmed_is_told_as_it_was_found() -> None:
    found, told = told_after_a_second(0.9)
    assert np.allclose(places(found), places(told), atol=1e-9)


def test_hands_that_are_not_go_part_of_the_way_and_say_that_they_are_less_certain() -> None:
    found, told = told_after_a_second(0.05)
    before = places(track(29, 1, 0.05))
    way = np.linalg.norm(places(found) - before, axis=1)
    gone = np.linalg.norm(places(told) - before, axis=1)
    assert (gone[HANDS] < 0.8 * way[HANDS]).all()
    assert (told.body.uncertainty_m[HANDS] > 0.0).all()
    assert np.allclose(places(found)[TRUNK], places(told)[TRUNK], atol=1e-9)


def test_nobody_is_told_as_nobody_and_nothing_is_remembered() -> None:
    lost = Track(lost_body(0, "colour"), SHAPE)
    assert with_steady_arms(lost, SHAPE, None, Params().steadying) == (lost, None)
