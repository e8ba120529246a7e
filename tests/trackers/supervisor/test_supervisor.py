"""Who speaks and when, and what is told meanwhile: on trackers that say what a script tells them."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.clock import nanoseconds
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.trackers.base import Track, unprobed
from mocapd.trackers.lost_reason import LostReason
from mocapd.trackers.supervisor.joining import LOWER_BONES, LOWER_JOINTS
from mocapd.trackers.supervisor.kinds import KINDS, Kind
from mocapd.trackers.supervisor.params import Params
from mocapd.trackers.supervisor.supervisor import Candidate, Supervisor
from mocapd.types import BodyState, FrameSet, Tracking
from tests.trackers.supervisor.scripted import (
    LOST,
    SHAPE,
    ScriptedTracker,
    Word,
    at,
    frame_set,
    joints_of,
    scene,
    true_pose,
)

PARAMS = Params()
FRAME_S = 1 / 30
ALL_WELL = (Word(0.0),)
BOTH = "colour+flex"


def speakers(bodies: list[BodyState]) -> list[str]:
    """Who spoke, each once in a row."""
    return [
        b.tracker
        for a, b in zip([None, *bodies], bodies, strict=False)
        if a is None or a.tracker != b.tracker
    ]


def test_the_shirt_and_what_needs_none_are_one_body() -> None:
    one = scene(ALL_WELL, (Word(0.0, off_m=0.05),))
    bodies = one.run(1.0)
    assert speakers(bodies) == [BOTH]
    body = bodies[-1]
    assert body.pose is not None
    true = true_pose(body.t_ns)
    assert np.allclose(body.pose.root_m, true.root_m)  # colour's place, not flex's
    assert np.allclose(body.pose.quats_xyzw, rotations.canonical(true.quats_xyzw))
    assert np.allclose(joints_of(body), joint_positions(skeleton_of(SHAPE), true))
    legs_and_head = np.isin(np.arange(len(body.confidence)), LOWER_JOINTS)
    assert np.array_equal(body.confidence, np.where(legs_and_head, 0.5, 0.9))
    assert set(LOWER_JOINTS) < set(LOWER_BONES)
    assert INDEX["neck"] in LOWER_BONES
    assert INDEX["hips"] not in LOWER_BONES
    # led by colour's body of the same frame
    assert [one.flex.guided_by[b.t_ns].tracker for b in bodies] == ["colour"] * len(bodies)


def test_where_nobody_else_can_run_the_shirt_is_all() -> None:
    colour = ScriptedTracker("colour", ALL_WELL, 0.9)
    auto = Supervisor([Candidate(colour, KINDS["colour"])])
    bodies = [auto.step(frame_set(k * 33_333_333, 1), SHAPE).body for k in range(10)]
    assert speakers(bodies) == ["colour"]


def test_why_nobody_is_tracked_is_passed_on() -> None:
    unseen = Word(0.0, LOST, lost_reason=LostReason.UNRECOGNISED)
    colour, flex = (
        ScriptedTracker(name, script, 0.9)
        for name, script in (("colour", (Word(0.0, LOST),)), ("flex", (unseen, Word(1.0))))
    )
    auto = Supervisor([Candidate(one, KINDS[one.name]) for one in (colour, flex)])
    tracks = [auto.step(frame_set(k * 100_000_000, 2), SHAPE) for k in range(20)]
    assert {one.lost_reason for one in tracks[:10]} == {LostReason.UNRECOGNISED}
    assert tracks[-1].lost_reason is None


def test_without_a_shirt_the_other_speaks_alone_and_the_search_is_spared() -> None:
    one = scene((Word(0.0, LOST),), ALL_WELL)
    bodies = one.run(3.0)
    assert speakers(bodies) == ["auto", "flex"]
    assert at(bodies, PARAMS.arrive_s + FRAME_S).tracker == "flex"
    assert len(one.flex.stepped_ns) == 90
    assert not one.flex.guided_by
    # until the other is believed both are asked
    assert len(one.colour.stepped_ns) <= 3.0 / PARAMS.search_every_s + 30 * PARAMS.confirm_s + 3
    pauses_ns = np.diff(one.colour.stepped_ns)
    assert pauses_ns.max() < 1.5e9 * PARAMS.search_every_s  # and yet it goes on


@pytest.mark.parametrize("hz", [15.0, 30.0, 60.0])
@pytest.mark.parametrize(
    "covered", [Word(1.0, LOST), Word(1.0, Tracking.COASTING), Word(1.0, quality=0.3)]
)
def test_a_covered_shirt_is_gone_on_from_and_taken_up_again(hz: float, covered: Word) -> None:
    one = scene((Word(0.0), covered, Word(2.0)), ALL_WELL)
    bodies = one.run(3.0, hz=hz)
    assert speakers(bodies) == [BOTH, "flex", BOTH]
    assert all(body.tracking is not LOST for body in bodies)
    assert at(bodies, 1.0 + PARAMS.doubt_s + 1.1 / hz).tracker == "flex"
    back_s = 2.0 + PARAMS.search_every_s + PARAMS.confirm_s + 2.1 / hz
    assert at(bodies, back_s).tracker == BOTH


def test_a_frame_that_fails_and_a_flash_of_the_shirt_change_nothing() -> None:
    step = 1.01 * FRAME_S
    failing = scene((Word(0.0), Word(1.0, Tracking.COASTING), Word(1.0 + step)), ALL_WELL)
    assert speakers(failing.run(2.0)) == [BOTH]
    flash = scene((Word(0.0, LOST), Word(1.0), Word(1.2, LOST)), ALL_WELL)
    assert speakers(flash.run(3.0)) == ["auto", "flex"]


def test_quality_between_the_limits_changes_nothing() -> None:
    kind = KINDS["colour"]
    between = 0.5 * (kind.poor + kind.good)
    assert speakers(scene((Word(0.0), Word(1.0, quality=between)), ALL_WELL).run(3.0)) == [BOTH]
    covered = (Word(0.0), Word(1.0, LOST), Word(2.0, quality=between))
    assert speakers(scene(covered, ALL_WELL).run(4.0)) == [BOTH, "flex"]


def test_who_is_preferred_speaks_at_once_while_the_other_is_not_believed_yet() -> None:
    soon_s = 0.5 * PARAMS.confirm_s
    bodies = scene((Word(0.0, LOST), Word(soon_s)), ALL_WELL).run(1.0)
    assert speakers(bodies) == ["auto", "flex", BOTH]
    assert at(bodies, soon_s).tracker == BOTH


def test_the_first_look_at_who_walks_in_is_not_told_where_the_shirt_is_seen_a_moment_later() -> (
    None
):
    bodies = scene((Word(0.0, LOST), Word(0.8 * PARAMS.arrive_s)), ALL_WELL).run(1.0)
    assert speakers(bodies) == ["auto", BOTH]


def test_nobody_begins_with_a_body_of_a_moment_ago() -> None:
    coasting = (Word(0.0, LOST), Word(1.9, Tracking.COASTING))
    bodies = scene(coasting, (Word(0.0), Word(2.0, LOST))).run(2.5)
    assert speakers(bodies) == ["auto", "flex", "auto"]


def test_a_doubtful_upper_body_leads_nobody() -> None:
    one = scene((Word(0.0), Word(1.0, quality=0.3), Word(1.07)), ALL_WELL)
    bodies = one.run(2.0)
    assert speakers(bodies) == [BOTH]
    led = [body.t_ns in one.flex.guided_by for body in bodies]
    assert led == [not 1.0 <= body.t_ns / 1e9 < 1.07 for body in bodies]


def test_a_third_kind_is_asked_now_and_then_until_it_is_needed() -> None:
    kind = Kind(upper_only=False, least_cameras=3, good=0.5, poor=0.4)
    colour = ScriptedTracker("colour", (Word(0.0), Word(2.0, LOST)), 0.9)
    flex = ScriptedTracker("flex", (Word(0.0), Word(2.5, LOST)), 0.5)
    third = ScriptedTracker("third", ALL_WELL, 0.5)
    kinds = (KINDS["colour"], KINDS["flex"], kind)
    auto = Supervisor([Candidate(*pair) for pair in zip((colour, flex, third), kinds, strict=True)])
    bodies = [auto.step(frame_set(k * 33_333_333, 3), SHAPE).body for k in range(120)]
    assert speakers(bodies) == [BOTH, "flex", "third"]
    asked = [t_ns for t_ns in third.stepped_ns if 0.5e9 < t_ns < 2.0e9]
    assert len(asked) <= 1.5 / PARAMS.search_every_s + 1
    assert len([t_ns for t_ns in third.stepped_ns if t_ns > 2.6e9]) == sum(
        body.t_ns > 2.6e9 for body in bodies
    )


def test_the_motion_between_two_speakers_frames_is_not_held_back() -> None:
    """A decimetre and more between frames, and both trackers are right, each of which was asked in the frame before."""
    bodies = scene((Word(0.0), Word(1.0, LOST), Word(3.0)), ALL_WELL).run(5.0, hz=4.0)
    assert speakers(bodies) == [BOTH, "flex", BOTH]
    moved_m = [
        np.linalg.norm(joints_of(b) - joints_of(a), axis=1).max() for a, b in pairwise(bodies)
    ]
    assert max(moved_m) > 0.1
    back = next(i for i in range(10, 20) if bodies[i].tracker == BOTH)
    for body in bodies[back - 2 : back + 1]:
        true = joint_positions(skeleton_of(SHAPE), true_pose(body.t_ns))
        assert np.allclose(joints_of(body), true, atol=1e-9)


def test_legs_that_are_lost_leave_the_upper_body() -> None:
    one = scene(ALL_WELL, (Word(0.0), Word(1.0, LOST)))
    assert speakers(one.run(2.0)) == [BOTH, "colour"]


def test_when_both_are_lost_nobody_is_there() -> None:
    one = scene((Word(0.0), Word(1.0, LOST)), (Word(0.0), Word(1.5, LOST)))
    bodies = one.run(2.0)
    assert speakers(bodies) == [BOTH, "flex", "auto"]
    assert at(bodies, 1.5).tracking is LOST
    assert at(bodies, 1.5).pose is None


def test_an_empty_frame_set_at_first_is_nobody() -> None:
    body = scene((Word(0.0, LOST),), (Word(0.0, LOST),)).auto.step(FrameSet(0, {}), SHAPE).body
    assert (body.tracking, body.tracker) == (LOST, "auto")


def test_who_is_lost_is_offered_the_body_that_is_told() -> None:
    one = scene((Word(0.0), Word(1.0, LOST)), ALL_WELL)
    one.run(1.0 + PARAMS.offer_after_s + 2 * PARAMS.search_every_s + 2.0 * PARAMS.offer_every_s)
    offers = [near for near in one.colour.offers[1:] if near is not None]
    assert [near.tracker for near in offers] == ["flex"] * len(offers)
    assert offers[0].t_ns >= nanoseconds(1.0 + PARAMS.offer_after_s)
    assert 2 <= len(offers) <= 3
    assert one.flex.offers == [None]


@pytest.mark.parametrize("lost", [True, False])
def test_who_is_led_is_offered_a_body_when_it_is_lost_all_the_same(lost: bool) -> None:
    """And then looks for it whole, once, before it is led again."""
    script = (Word(0.0), Word(1.0, LOST)) if lost else (Word(0.0), Word(1.0, off_m=0.2))
    led = scene(ALL_WELL, script)
    led.run(4.0)
    assert len(led.flex.offers) == (3 if lost else 1)
    by_itself = [t_ns for t_ns in led.flex.stepped_ns if t_ns not in led.flex.guided_by]
    offered = [near.t_ns for near in led.flex.offers if near is not None]
    assert by_itself == [t_ns + round(1e9 / 30) for t_ns in offered]


def test_who_cannot_be_led_is_offered_a_body() -> None:
    script = (Word(0.0), Word(1.0, LOST))
    alone = ScriptedTracker("flex", script, 0.5)
    other = ScriptedTracker("colour", ALL_WELL, 0.9)
    auto = Supervisor([Candidate(one, KINDS[one.name]) for one in (other, alone)])
    for k in range(120):
        auto.step(frame_set(k * 33_333_333, 2), SHAPE)
    assert [near is not None and near.tracker for near in alone.offers] == [
        False,
        "colour",
        "colour",
    ]


def test_no_body_is_offered_that_nobody_believes() -> None:
    one = scene((Word(0.0, LOST),), (Word(0.0, quality=0.3),))
    one.run(3.0)
    assert one.colour.offers == [None]


def test_a_shirt_somewhere_else_speaks_only_when_it_stays() -> None:
    """Offered the body that is told, it comes back to its own place: then the shirt is the surer sign."""
    one = scene((Word(0.0, LOST), Word(1.0, off_m=1.0)), (Word(0.0), Word(8.0)))
    bodies = one.run(5.0)
    assert speakers(bodies)[:3] == [
        "auto",
        "flex",
        "colour",
    ]  # its legs are elsewhere: they are not joined
    first = next(body for body in bodies if body.tracker == "colour")
    assert first.t_ns / 1e9 == pytest.approx(1.0 + PARAMS.overrule_s, abs=2 * PARAMS.search_every_s)
    assert any(near is not None and near.tracker == "flex" for near in one.colour.offers)


def test_a_shirt_somewhere_else_for_a_moment_does_not_speak() -> None:
    elsewhere = (
        Word(0.0, LOST),
        Word(1.0, off_m=1.0),
        Word(1.8, LOST),
        Word(3.0, off_m=1.0),
        Word(3.8, LOST),
    )
    assert speakers(scene(elsewhere, ALL_WELL).run(5.0)) == ["auto", "flex"]


def test_with_too_few_cameras_it_is_not_begun_with_but_gone_on_with() -> None:
    """A pair's tracker is not believed anew by one camera's word."""
    covered = (Word(0.0), Word(2.0, quality=0.3))
    late = scene(covered, (Word(0.0, LOST), Word(1.0)))
    assert "flex" not in speakers(late.run(4.0, cameras=lambda t_s: 1))
    before = scene(covered, ALL_WELL)
    assert speakers(before.run(4.0, cameras=lambda t_s: 2 if t_s < 1.0 else 1)) == [BOTH, "flex"]


@pytest.mark.parametrize("hz", [30.0, 60.0])
def test_no_joint_jumps_when_another_speaks(hz: float) -> None:
    covered = (Word(0.0), Word(1.0, LOST), Word(3.0))
    one = scene(covered, (Word(0.0, off_m=0.25, arms_rad=0.8),))
    bodies = one.run(5.0, hz=hz)
    assert speakers(bodies) == [BOTH, "flex", BOTH]
    truth = [joint_positions(skeleton_of(SHAPE), true_pose(b.t_ns)) for b in bodies]
    off = np.array([joints_of(b) for b in bodies]) - truth
    steps_m = np.linalg.norm(np.diff(off, axis=0), axis=2).max(axis=1)
    assert steps_m.max() <= 0.10
    assert steps_m.max() > 0.02  # there was something to glide over
    for since_s in (1.0 + PARAMS.doubt_s, 3.0 + PARAMS.search_every_s + PARAMS.confirm_s):
        arrived = at(bodies, since_s + 12 / 30)  # found out, and ten frames
        assert np.allclose(
            steps_m[bodies.index(arrived) : bodies.index(arrived) + 5], 0.0, atol=0.02
        )
    assert np.allclose(off[-1], 0.0, atol=1e-9)


def test_legs_do_not_jump_when_who_sees_them_is_lost_and_found() -> None:
    one = scene(ALL_WELL, (Word(0.0, knees_rad=0.8), Word(1.0, LOST), Word(2.0, knees_rad=0.8)))
    bodies = one.run(3.0)
    assert speakers(bodies) == [BOTH, "colour", BOTH]
    steps_m = [
        np.linalg.norm(joints_of(b) - joints_of(a), axis=1).max() for a, b in pairwise(bodies)
    ]
    assert max(steps_m) <= 0.10 + 0.03  # and half a second of walking
    knees = [INDEX["leftFoot"], INDEX["rightFoot"]]
    bent_m = [
        np.linalg.norm(joints_of(at(bodies, t_s))[knees] - joints_of(at(bodies, 1.9))[knees])
        for t_s in (0.9, 2.9)
    ]
    assert min(bent_m) > 0.3


def test_legs_are_told_once_they_have_been_known_for_a_moment() -> None:
    """The first looks are the worst, how they move is not known at the first, and what is told must go over to it."""
    bodies = scene(ALL_WELL, (Word(0.0), Word(1.0, LOST), Word(2.0))).run(3.0)
    joined = next(body for body in bodies if body.t_ns >= nanoseconds(1.5) and body.tracker == BOTH)
    assert joined.t_ns == pytest.approx(
        nanoseconds(2.0 + PARAMS.arrive_s), abs=nanoseconds(FRAME_S / 2)
    )


def test_what_still_glides_is_less_certain() -> None:
    covered = (Word(0.0), Word(1.0, LOST))
    bodies = scene(covered, (Word(0.0, off_m=0.25),)).run(2.0)
    first = next(body for body in bodies if body.tracker == "flex")
    assert first.uncertainty_m[INDEX["hips"]] > 0.05
    assert np.allclose(bodies[-1].uncertainty_m, 0.02)


def test_nothing_is_left_to_glide_from_after_a_pause() -> None:
    one = scene((Word(0.0), Word(1.0, LOST)), (Word(0.0, off_m=0.25),))
    one.run(1.0)
    body = one.auto.step(frame_set(nanoseconds(5.0), 2), SHAPE).body
    assert body.tracker == "flex"
    assert body.pose is not None
    assert np.allclose(body.pose.root_m, true_pose(body.t_ns).root_m + (0.25, 0.0, 0.0))


def test_the_same_frames_after_reset_give_the_same_bodies() -> None:
    one = scene((Word(0.0), Word(1.0, LOST), Word(2.0)), (Word(0.0, off_m=0.2),))
    first = one.run(3.0)
    one.auto.reset()
    for a, b in zip(first, one.run(3.0), strict=True):
        assert a.tracker == b.tracker
        assert np.array_equal(joints_of(a), joints_of(b))


def test_all_are_offered_another_daemons_body() -> None:
    one = scene(ALL_WELL, ALL_WELL)
    near = one.run(0.1)[-1]
    one.auto.reset(near)
    assert one.colour.offers[-1] is near
    assert one.flex.offers[-1] is near


def test_one_shape_for_all_and_stages_under_their_trackers_name() -> None:
    one = scene(ALL_WELL, ALL_WELL)
    heard: list[str] = []
    one.auto.probe = heard.append
    one.run(0.1)
    one.auto.probe = unprobed
    assert {"colour.look", "flex.look"} <= set(heard)
    assert all(shape is SHAPE for shape in one.colour.shapes + one.flex.shapes)


def test_who_is_led_is_prepared_before_each_frame_in_which_that_goes_on() -> None:
    one = scene((Word(0.0), Word(0.5, LOST), Word(1.0)), ALL_WELL)
    one.run(1.5)
    led = sorted(one.flex.guided_by)
    after_led = [
        t
        for t in one.flex.stepped_ns
        if any(0 < t - before < 1.5 * FRAME_S * 1e9 for before in led)
    ]
    assert one.flex.prepared == after_led
    assert len(led) - 3 < len(one.flex.prepared) < len(one.flex.stepped_ns)


def test_what_goes_wrong_aside_is_raised_where_the_frame_is_stepped() -> None:
    one = scene(ALL_WELL, ALL_WELL)
    one.flex.fails_at_s = 0.5
    with pytest.raises(ConfigError, match="another size"):
        one.run(1.0)
    assert one.colour.stepped_ns[-1] < nanoseconds(0.5 + 1.5 * FRAME_S)


def test_nothing_goes_on_aside_when_a_frame_is_over_whoever_failed() -> None:
    waited: list[str] = []

    def aside(work: Callable[[], None]) -> Callable[[], None]:
        waited.append("begun")
        return lambda: waited.append("ended")

    one = scene(ALL_WELL, ALL_WELL)
    auto = Supervisor(one.auto.candidates, PARAMS, aside)

    def fails(frames: FrameSet, shape: BodyShape) -> Track:
        raise ConfigError("a frame of another size", "colour", "calibrate again")

    for k in range(5):
        auto.step(frame_set(round(k * FRAME_S * 1e9), 2), SHAPE)
    one.colour.step = fails  # type: ignore[method-assign]
    with pytest.raises(ConfigError):
        auto.step(frame_set(round(5 * FRAME_S * 1e9), 2), SHAPE)
    assert waited == ["begun", "ended"] * 5
