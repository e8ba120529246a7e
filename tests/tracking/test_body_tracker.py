"""Which cues carry the body and when, and what is published meanwhile: on cues that find what a script says."""

from dataclasses import replace
from itertools import groupby, pairwise

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.tracking.base import LostReason
from mocapd.tracking.body_tracker import BodyTrackerParams
from mocapd.tracking.cue_trust import CLOTHES_TRUST, SHIRT_TRUST
from mocapd.tracking.pose_filter import PoseFilterParams
from mocapd.tracking.trunk_and_legs import LOWER_BONES
from mocapd.types import BodyState, FrameSet, Tracking
from tests.tracking.scripted import (
    ALWAYS,
    NEVER,
    Sight,
    at,
    frame_set,
    joints_of,
    scene,
    true_joints_m,
)

PARAMS = BodyTrackerParams()
FRAME_S = 1 / 30
LOOK_S = 0.2  # from one look for the shirt to the next while clothes carry the body
BOTH, SHIRT, CLOTHES, NOBODY = "shirt+clothes", "shirt", "clothes", "auto"
POOR, BETWEEN = 0.3, 0.5 * (SHIRT_TRUST.good + SHIRT_TRUST.poor)
LEGS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerLeg", "Foot")]
JACKET = (Sight(0.0), Sight(1.0, None), Sight(3.0))
HANDS = ("leftHand", "rightHand")
ARM_NOISE_M = 0.005  # an arm that hardly moves is not followed nearer than what is found trembles
RATES = pytest.mark.parametrize("hz", [15.0, 30.0, 60.0])


def carriers(bodies: list[BodyState]) -> list[str]:
    """What carried the body, each once in a row."""
    return [name for name, _ in groupby(bodies, key=lambda body: body.tracker)]


def steps_m(bodies: list[BodyState]) -> np.ndarray:
    """The farthest that a joint went in each frame beyond its true motion."""
    known = [body for body in bodies if body.pose is not None]
    off_m = np.array([joints_of(body) - true_joints_m(body.t_ns) for body in known])
    return np.asarray(np.linalg.norm(np.diff(off_m, axis=0), axis=2).max(axis=1))


# --- one body of both cues ---


def test_the_trunk_is_the_shirts_and_the_legs_are_the_clothes() -> None:
    one = scene(ALWAYS, (Sight(0.0, off_m=0.05, knees_rad=0.5),))
    bodies = one.run(2.0)
    assert carriers(bodies) == [NOBODY, BOTH]
    joints_m, true_m = joints_of(bodies[-1]), true_joints_m(bodies[-1].t_ns)
    trunk, hands = [INDEX[n] for n in ("hips", "upperChest", "neck")], [INDEX[n] for n in HANDS]
    np.testing.assert_allclose(joints_m[trunk], true_m[trunk], atol=1e-6)
    np.testing.assert_allclose(joints_m[hands], true_m[hands], atol=ARM_NOISE_M)
    assert (np.linalg.norm(joints_m - true_m, axis=1)[LEGS[1::2]] > 0.1).all()  # as bent as seen
    assert bodies[-1].cameras == ("cam0", "cam1")
    assert (bodies[-1].confidence[LOWER_BONES] > 0.3).all()


@pytest.mark.parametrize(
    ("shirt", "clothes", "name"), [(ALWAYS, None, SHIRT), (None, ALWAYS, CLOTHES)]
)
def test_one_cue_does_where_there_is_no_other(
    shirt: tuple[Sight, ...] | None, clothes: tuple[Sight, ...] | None, name: str
) -> None:
    bodies = scene(shirt, clothes).run(1.0, cameras=lambda _: 2)
    assert carriers(bodies) == [NOBODY, name]
    assert bodies[-1].tracking is Tracking.LIVE


def test_of_the_shirt_alone_legs_hang_down_and_are_not_believed() -> None:
    body = scene(ALWAYS, NEVER).run(1.0)[-1]
    assert body.tracker == SHIRT
    assert not body.confidence[LEGS].any()
    hips_m, feet_m = joints_of(body)[0], joints_of(body)[LEGS[1::2]]
    assert (np.abs(feet_m[:, 2] - hips_m[2]) < 0.1).all()


# --- the beginning ---


def test_without_the_shirt_clothes_begin_once_the_first_looks_are_over() -> None:
    one = scene(NEVER, ALWAYS)
    bodies = one.run(3.0)
    assert carriers(bodies) == [NOBODY, CLOTHES]
    first = next(body for body in bodies if body.tracker == CLOTHES)
    assert PARAMS.arrive_s <= first.t_ns / 1e9 < PARAMS.arrive_s + 0.15
    assert one.shirt is not None
    looked_s = (
        np.array(one.shirt.looked_ns) / 1e9
    )  # and the shirt is looked for, the less often the longer it is missing
    pauses_s, missing_s = np.diff(looked_s), looked_s[:-1] - looked_s[0]
    usual_s = np.maximum(LOOK_S, one.shirt.params.covered_share * missing_s)
    assert (np.abs(pauses_s - usual_s) < 1.1 * FRAME_S).all()


def test_a_first_look_is_not_published_where_the_shirt_is_seen_a_moment_later() -> None:
    bodies = scene((Sight(0.0, None), Sight(0.8 * PARAMS.arrive_s)), ALWAYS).run(1.0)
    assert carriers(bodies) == [NOBODY, BOTH]


def test_the_shirt_carries_soon_while_clothes_are_not_believed_yet() -> None:
    soon_s = 0.5 * CLOTHES_TRUST.confirm_s
    bodies = scene((Sight(0.0, None), Sight(soon_s)), ALWAYS).run(1.0)
    assert carriers(bodies) == [NOBODY, CLOTHES, BOTH]
    assert at(bodies, soon_s + LOOK_S + 1.1 * FRAME_S).tracker == BOTH


def test_an_empty_frame_set_at_first_is_nobody() -> None:
    body = scene(ALWAYS, ALWAYS).step(FrameSet(0, {})).body
    assert (body.tracking, body.tracker, body.pose) == (Tracking.LOST, NOBODY, None)


def test_why_nobody_is_tracked_is_passed_on() -> None:
    one = scene(NEVER, (Sight(0.0, None), Sight(1.0)), LostReason.UNRECOGNISED)
    tracks = [one.step(frame_set(k * 100_000_000, 2)) for k in range(20)]
    assert {track.lost_reason for track in tracks[:10]} == {LostReason.UNRECOGNISED}
    assert tracks[-1].lost_reason is None


# --- a jacket ---


@RATES
@pytest.mark.parametrize("covered", [Sight(1.0, None), Sight(1.0, POOR)])
def test_under_a_jacket_clothes_carry_until_the_shirt_is_seen_again(
    hz: float, covered: Sight
) -> None:
    bodies = scene((Sight(0.0), covered, Sight(2.0)), ALWAYS).run(3.5, hz=hz)
    assert carriers(bodies) == [NOBODY, BOTH, CLOTHES, BOTH]
    found = [body for body in bodies if body.t_ns > nanoseconds(0.2)]
    assert {body.tracking for body in found} == {Tracking.LIVE}
    assert at(bodies, 1.0 + SHIRT_TRUST.doubt_s + 1.1 / hz).tracker == CLOTHES
    assert at(bodies, 2.0 + LOOK_S + SHIRT_TRUST.confirm_s + 2.1 / hz).tracker == BOTH


def test_a_shirt_that_is_lost_while_legs_rest_costs_no_frame() -> None:
    one = scene((Sight(0.0), Sight(1.0, None)), ALWAYS)
    assert one.clothes is not None
    one.clothes.rests_below_the_shirt = True
    bodies = one.run(2.0)
    assert carriers(bodies) == [NOBODY, BOTH, CLOTHES]
    assert {len(body.cameras) for body in bodies if body.t_ns > nanoseconds(0.2)} == {2}


def test_a_flash_of_the_shirt_changes_nothing() -> None:
    flash = scene((Sight(0.0, None), Sight(1.0), Sight(1.2, None)), ALWAYS)
    assert carriers(flash.run(3.0)) == [NOBODY, CLOTHES]


@pytest.mark.parametrize(
    ("quality", "frames"),
    [
        (None, 1),
        (None, 2),
        (POOR, 2),
    ],
)
def test_a_moment_without_the_shirt_costs_no_more_than_that_moment(
    quality: float | None, frames: int
) -> None:
    script = (Sight(0.0), Sight(1.0, quality), Sight(1.0 + (frames - 0.5) * FRAME_S))
    bodies = scene(script, ALWAYS).run(2.0)
    others = [b for b in bodies if b.t_ns > nanoseconds(0.2) and b.tracker != BOTH]
    assert len(others) <= (frames if quality is None else 0)
    assert steps_m(bodies).max() < 0.02


def test_quality_between_the_limits_changes_nothing() -> None:
    falls = scene((Sight(0.0), Sight(1.0, BETWEEN)), ALWAYS)
    assert carriers(falls.run(3.0)) == [NOBODY, BOTH]
    rises = scene((Sight(0.0), Sight(1.0, None), Sight(2.0, BETWEEN)), ALWAYS)
    assert carriers(rises.run(4.0)) == [NOBODY, BOTH, CLOTHES]


@RATES
@pytest.mark.parametrize(("off_m", "arms_rad"), [(0.25, 0.8), (0.25, 0.0), (0.0, 0.8)])
def test_no_joint_jumps_when_the_cues_change(hz: float, off_m: float, arms_rad: float) -> None:
    bodies = scene(JACKET, (Sight(0.0, off_m=off_m, arms_rad=arms_rad),)).run(5.0, hz=hz)
    assert carriers(bodies) == [NOBODY, BOTH, CLOTHES, BOTH]
    assert 0.02 < steps_m(bodies).max() <= PoseFilterParams().step_m + 0.005


@RATES
def test_after_a_change_the_body_arrives_where_the_cues_find_it(hz: float) -> None:
    bodies = scene(JACKET, (Sight(0.0, off_m=0.25, arms_rad=0.8),)).run(5.0, hz=hz)
    assert steps_m(bodies).max() < 0.15
    steps = steps_m([b for b in bodies if b.t_ns > nanoseconds(1.0 + SHIRT_TRUST.doubt_s + 0.6)])
    assert steps[: round(hz)].max() < 0.02
    off_m = np.linalg.norm(joints_of(bodies[-1]) - true_joints_m(bodies[-1].t_ns), axis=1)
    assert off_m[INDEX["hips"]] < 1e-6
    assert off_m[[INDEX[name] for name in HANDS]].max() < ARM_NOISE_M


# --- legs, cameras, leaving ---


def test_legs_that_are_lost_leave_the_trunk_and_are_found_again() -> None:
    bent = 0.8
    script = (Sight(0.0, knees_rad=bent), Sight(1.0, None), Sight(2.5, knees_rad=bent))
    bodies = scene(ALWAYS, script).run(4.0)
    assert carriers(bodies) == [NOBODY, BOTH, SHIRT, BOTH]
    assert at(bodies, 1.0 + PARAMS.legs_last_s - 2 * FRAME_S).tracker == BOTH  # a moment is bridged
    assert at(bodies, 1.0 + PARAMS.legs_last_s + 2 * FRAME_S).tracker == SHIRT
    assert {body.tracking for body in bodies[6:]} == {Tracking.LIVE}
    moved_m = [
        np.linalg.norm(joints_of(b) - joints_of(a), axis=1).max() for a, b in pairwise(bodies[6:])
    ]
    assert max(moved_m) <= PoseFilterParams().step_m + 0.05  # and a frame of walking


@RATES
def test_when_both_are_lost_the_body_coasts_and_then_nobody_is_there(hz: float) -> None:
    bodies = scene((Sight(0.0), Sight(1.0, None)), (Sight(0.0), Sight(1.0, None))).run(2.5, hz=hz)
    states = [body.tracking for body in bodies if body.t_ns > nanoseconds(0.5)]
    assert [state for state, _ in groupby(states)] == [
        Tracking.LIVE,
        Tracking.COASTING,
        Tracking.LOST,
    ]
    assert at(bodies, 1.0 + 0.3).cameras == ()
    confidence = [b.confidence.max() for b in bodies if 1.0 <= b.t_ns / 1e9 <= 1.4]
    assert confidence == sorted(confidence, reverse=True)
    assert (at(bodies, 2.0).tracker, at(bodies, 2.0).pose) == (NOBODY, None)


def test_one_camera_is_enough_to_go_on_but_not_to_begin_with_clothes() -> None:
    jacket = (Sight(0.0), Sight(2.0, POOR))
    late = scene(jacket, (Sight(0.0, None), Sight(1.0))).run(4.0, cameras=lambda _: 1)
    assert CLOTHES not in carriers(late)
    before = scene(jacket, ALWAYS).run(4.0, cameras=lambda t_s: 2 if t_s < 1.0 else 1)
    assert carriers(before) == [NOBODY, BOTH, CLOTHES]


def test_clothes_seen_from_one_place_follow_below_the_shirt_and_never_alone() -> None:
    jacket = (Sight(0.0, None), Sight(1.0), Sight(2.0, None), Sight(5.0))
    bodies = scene(jacket, ALWAYS, alone=False).run(7.0)
    assert [name for name in carriers(bodies) if name != NOBODY] == [BOTH, BOTH]
    assert at(bodies, 4.5).tracking is Tracking.LOST


def test_no_frames_for_a_while_start_anew() -> None:
    one = scene((Sight(0.0), Sight(1.0, None)), (Sight(0.0, off_m=0.25),))
    one.run(1.0)
    bodies = one.run(6.0, from_s=5.0)
    assert carriers(bodies) == [NOBODY, CLOTHES]
    first = next(body for body in bodies if body.pose is not None)
    assert np.allclose(
        joints_of(first)[0], true_joints_m(first.t_ns)[0] + (0.25, 0.0, 0.0), atol=1e-6
    )


# --- the shirt somewhere else ---


def test_a_shirt_somewhere_else_carries_only_when_it_stays_there() -> None:
    bodies = scene((Sight(0.0, None), Sight(1.0, off_m=1.0)), (Sight(0.0), Sight(8.0))).run(5.0)
    assert carriers(bodies)[:3] == [NOBODY, CLOTHES, SHIRT]  # the legs are of somebody else
    first = next(body for body in bodies if body.tracker == SHIRT)
    assert first.t_ns / 1e9 == pytest.approx(1.0 + PARAMS.overrule_s, abs=1.5 * LOOK_S)


def test_a_shirt_somewhere_else_for_a_moment_does_not() -> None:
    elsewhere = (
        Sight(0.0, None),
        Sight(1.0, off_m=1.0),
        Sight(2.5, None),
        Sight(4.0, off_m=1.0),
        Sight(5.5, None),
    )
    assert carriers(scene(elsewhere, ALWAYS).run(7.0)) == [NOBODY, CLOTHES]


# --- reset ---


def test_the_same_frames_after_reset_give_the_same_bodies() -> None:
    one = scene((Sight(0.0), Sight(1.0, None), Sight(2.0)), (Sight(0.0, off_m=0.2),))
    first = one.run(3.0)
    one.tracker.reset()
    for a, b in zip(first, one.run(3.0), strict=True):
        assert (a.tracker, a.tracking) == (b.tracker, b.tracking)
        assert a.pose is b.pose or np.array_equal(joints_of(a), joints_of(b))


@pytest.mark.parametrize(
    ("shirt", "clothes", "name"),
    [(ALWAYS, ALWAYS, BOTH), (NEVER, ALWAYS, CLOTHES), (ALWAYS, NEVER, SHIRT)],
)
def test_it_goes_on_from_another_trackers_body_at_once(
    shirt: tuple[Sight, ...], clothes: tuple[Sight, ...], name: str
) -> None:
    one = scene(shirt, clothes)
    near = one.run(1.0)[-1]
    one.tracker.reset(replace(near, tracker="another"))
    bodies = one.run(1.5, from_s=1.0)
    assert carriers(bodies) == [name]
    assert {body.tracking for body in bodies} == {Tracking.LIVE}


def test_a_body_of_long_ago_is_not_gone_on_from() -> None:
    one = scene(NEVER, ALWAYS)
    near = one.run(1.0)[-1]
    one.tracker.reset(replace(near, tracker="another"))
    assert one.run(5.1, from_s=5.0)[0].tracking is Tracking.LOST
