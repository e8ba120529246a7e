"""Other poses of an uncertain arm: candidates, their scores, and the arm that is found again."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mocapd.body.arrays import camera_arrays
from mocapd.body.joint_limits import swing_twist
from mocapd.body.model import shaped
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import HEAD, LEFT_ARM, RIGHT_ARM
from mocapd.fit.fit_params import LimbSearchParams
from mocapd.fit.limbs.arm_samples import arm_of, place_samples
from mocapd.fit.limbs.arm_search import ArmSearch, arm_library, is_uncertain
from mocapd.fit.limbs.limb_candidates import best_poses, candidates
from mocapd.fit.limbs.limb_scores import score_arms_and_hands, score_hand_places
from mocapd.fit.limbs.limb_search_kernels import score_arms
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project, rays
from mocapd.types import Floats
from tests.fit.synthetic import FACTOR, LABELS, MODEL, fitter, standing, views_of

pytestmark = pytest.mark.kernels

NO_DEPTHS = np.empty((0, 0), np.float32)
EMPTY = 0.25  # share of an arm before background that denies it
NO_CLOUD, NO_LIBRARY = np.empty((0, 6)), np.empty((0, 3, 4))
BONES = ("Shoulder", "UpperArm", "LowerArm")


def arm_joints(by: Fitter, state: MotionState, side: str) -> Floats:
    """Shoulder, elbow and wrist (3,3) [m]."""
    return by.joints(state)[0][[INDEX[side + b] for b in ("UpperArm", "LowerArm", "Hand")]]


def with_arm(state: MotionState, side: str, local: Floats) -> MotionState:
    out = state.local_xyzw.copy()
    out[[INDEX[side + bone] for bone in BONES]] = local
    return replace(state, local_xyzw=out)


def swapped(state: MotionState, side: str, other: MotionState) -> MotionState:
    """The state with one arm of another."""
    return with_arm(state, side, other.local_xyzw[[INDEX[side + bone] for bone in BONES]])


# --- candidates ------------------------------------------------------------------------------


@pytest.mark.parametrize("side", SIDES)
def test_candidates_hold_the_mirror_images_in_depth(side: str) -> None:
    """The two poses of a segment that project alike: a bone turned over in the plane that its end
    and the ray span. At the camera's distance perspective leaves a few pixels of difference."""
    by, state = fitter(1), standing("forward", "forward")
    arm, views = arm_of(MODEL, LABELS, side), views_of(by, state)
    found = candidates(by, state, arm, views, NO_CLOUD, NO_LIBRARY)
    assert len(found) == 4
    camera = by.drawings[0].camera
    here = arm_joints(by, state, side)
    np.testing.assert_allclose(
        found[0], state.local_xyzw[[INDEX[side + bone] for bone in BONES]], atol=1e-12
    )
    _, ray = rays(camera, project(camera, here[1]))
    bones, depth_m = np.diff(here, axis=0), []
    for local, flips in zip(found[1:], ((0, 1), (1, 0), (1, 1)), strict=True):
        there = arm_joints(by, with_arm(state, side, local), side)
        for bone, before, flip in zip(np.diff(there, axis=0), bones, flips, strict=True):
            wanted = before - 2 * flip * (before @ ray) * ray
            np.testing.assert_allclose(bone, wanted, atol=1e-9)
        apart = np.linalg.norm(project(camera, there) - project(camera, here), axis=1)
        depth_m.append(float(np.abs((there - here) @ ray).max()))
        across = np.linalg.norm((there - here) - ((there - here) @ ray)[:, None] * ray, axis=1)
        assert across.max() < 1e-9  # and the same picture, but for perspective
        assert apart.max() < 60.0
    assert max(depth_m) > 0.3  # quite another pose


def test_every_camera_adds_its_own_mirror_images_and_the_rest_follow() -> None:
    by, state = fitter(2), standing()
    arm, views = arm_of(MODEL, LABELS, "left"), views_of(by, state)
    cloud, library = (
        np.random.default_rng(0).normal(0, 0.5, (5, 6)),
        arm_library(MODEL.space, 7, "left"),
    )
    found = candidates(by, state, arm, views, cloud, library)
    assert len(found) == 1 + 2 * 3 + 5 + 7
    np.testing.assert_allclose(np.linalg.norm(found, axis=2), 1.0, atol=1e-9)
    np.testing.assert_array_equal(found[-7:], library)
    for tried, turn in zip(found[7:12], cloud, strict=True):
        np.testing.assert_array_equal(tried[0], found[0, 0])
        for place, angle in ((1, turn[:3]), (2, turn[3:])):
            moved = rotations.multiply(tried[place], rotations.inverse(found[0, place]))
            assert rotations.angle_rad(moved, rotations.exp(angle)) < 1e-9


@pytest.mark.parametrize("side", SIDES)
def test_the_library_fills_the_joint_limits(side: str) -> None:
    library, limits = arm_library(MODEL.space, 500, side), MODEL.space.limits
    for place in (1, 2):
        group = MODEL.space.group(side + BONES[place])
        assert limits.joint[group] == INDEX[side + BONES[place]]
        angles = swing_twist(library[:, place], int(limits.axis[group]))
        low, high = limits.lower_rad[group], limits.upper_rad[group]
        inside = ((angles > low - 1e-6) & (angles < high + 1e-6)).all(axis=1)
        # a swing to both ends at once is over half a turn, which is a shorter one the other way
        assert inside.mean() > 0.98
        angles = angles[inside]
        # in each direction it comes near both ends
        assert (angles.min(axis=0) < low + 0.1 * (high - low)).all()
        assert (angles.max(axis=0) > high - 0.1 * (high - low)).all()


# --- scores ----------------------------------------------------------------------------------


def naive_score(by: Fitter, state: MotionState, view: View, side: str) -> float:
    """Area of the samples seen where the picture has their colour and the rest of the body explains it not, less half
    of what the picture denies, and all of it where the rest of the body is seen."""
    arm, camera = arm_of(MODEL, LABELS, side), by.drawings[view.index].camera
    base = by.drawings[view.index].render_parts(state, view.dt_s, view.roi, arm.others)
    nearest = base.zbuffer.copy()
    corners = shaped(MODEL, state.factors)[0][arm.labelled.corners]
    rest = MODEL.rest_m
    joints, turned = by.joints(state)
    score = 0.0
    for s in range(len(arm.labelled.triangle)):
        middle = corners[s].mean(axis=0)
        normal = 0.5 * np.cross(corners[s, 1] - corners[s, 0], corners[s, 2] - corners[s, 0])
        point, posed_normal = np.zeros(3), np.zeros(3)
        for place, weight in zip(arm.labelled.link[s], arm.labelled.weights[s], strict=True):
            bone = arm.chain[place]
            point += weight * (joints[bone] + rotations.rotate(turned[bone], middle - rest[bone]))
            posed_normal += weight * rotations.rotate(turned[bone], normal)
        seen_from = camera.R @ point + camera.t_m
        facing = -float((camera.R @ posed_normal) @ seen_from / np.linalg.norm(seen_from))
        if facing <= 0.0:
            continue
        work = (project(camera, point) + 0.5) / FACTOR - 0.5 - np.array(view.roi[:2])
        x, y = (int(v) for v in np.round(work))
        if not (0 <= y < view.ids.shape[0] and 0 <= x < view.ids.shape[1]):
            continue
        if seen_from[2] > nearest[y, x] + 0.02:
            continue
        have = view.ids[y, x]
        beside = base.ids[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3]
        if have == arm.labelled.label[s]:
            score += 0.0 if (beside == have).any() else facing
        elif have and have == base.ids[y, x]:
            score -= facing
        elif have:
            score -= 0.5 * facing
        else:
            score -= EMPTY * facing * view.pixel_weight[y, x] / 255.0
    return score


def scores(by: Fitter, state: MotionState, view: View, side: str, hypotheses: Floats) -> Floats:
    arm, camera = arm_of(MODEL, LABELS, side), by.drawings[view.index].camera
    base = by.drawings[view.index].render_parts(state, view.dt_s, view.roi, arm.others)
    out = np.zeros(len(hypotheses))
    score_arms(
        hypotheses,
        place_samples(by.shaper(state.factors), arm, arm.labelled),
        MODEL.parents, base.posed, camera_arrays(camera),
        FACTOR * np.array([float(view.roi[0]), float(view.roi[1])]), 1.0 / FACTOR,
        base.zbuffer, base.ids, view.ids, view.pixel_weight, EMPTY, 1.0, NO_DEPTHS, 0.1, out,
    )  # fmt: skip
    return out


@pytest.mark.parametrize("side", SIDES)
def test_scores_equal_the_naive_twin(side: str) -> None:
    by, state = fitter(2), standing("guarding", "hand_on_belly")
    for view in views_of(by, standing("waving", "side_low")):
        soft = replace(view, pixel_weight=np.full_like(view.pixel_weight, 90))
        tries = [standing(pose, pose) for pose in ("guarding", "waving", "crossed", "raised")]
        # the hand keeps straight in a hypothesis, as it does in these poses
        bones = [INDEX[side + bone] for bone in BONES]
        hypotheses = np.array([of.local_xyzw[bones] for of in tries])
        got = scores(by, state, soft, side, hypotheses)
        wanted = [naive_score(by, swapped(state, side, of), soft, side) for of in tries]
        np.testing.assert_allclose(got, wanted, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("pose", ["goalpost", "forward_low", "hand_on_hip", "raised"])
def test_the_true_arm_scores_above_the_library(side: str, pose: str) -> None:
    by, truth = fitter(2), standing(pose, pose)
    views, library = views_of(by, truth), arm_library(MODEL.space, 400, side)
    mine = truth.local_xyzw[[INDEX[side + bone] for bone in BONES]]
    hypotheses = np.concatenate([library, mine[None]])
    total = sum(scores(by, truth, view, side, hypotheses) for view in views)
    assert np.argmax(total) == len(library)


def arm_px(*args: Any) -> Floats:
    return score_arms_and_hands(*args)[0]


def test_the_best_poses_are_apart_and_better_than_the_present_one() -> None:
    by, truth = fitter(2), standing("goalpost", "side_low")
    wrong = swapped(truth, "left", standing("hanging", "hanging"))
    arm, views = arm_of(MODEL, LABELS, "left"), views_of(by, truth)
    tries = candidates(by, wrong, arm, views, NO_CLOUD, arm_library(MODEL.space, 600, "left"))
    seen_px = arm_px(by, wrong, arm, views, tries, 0.0, EMPTY)
    best = best_poses(tries[:, 1:], seen_px, 3)
    assert 1 <= len(best) <= 3
    assert (seen_px[best] > seen_px[0]).all()
    hand = arm_joints(by, truth, "left")[2]
    found = [arm_joints(by, with_arm(wrong, "left", tries[n]), "left")[2] for n in best]
    off = np.linalg.norm(np.array(found) - hand, axis=1)
    assert off.min() < 0.25
    assert off.min() < 0.5 * np.linalg.norm(arm_joints(by, wrong, "left")[2] - hand)
    at_truth = candidates(by, truth, arm, views, NO_CLOUD, NO_LIBRARY)[:1]
    assert best_poses(at_truth[:, 1:], arm_px(by, truth, arm, views, at_truth, 0.0, EMPTY), 3) == []


def test_a_pose_farther_away_must_be_seen_more() -> None:
    by, truth = fitter(2), standing("goalpost", "side_low")
    arm, views = arm_of(MODEL, LABELS, "left"), views_of(by, truth)
    tries = candidates(by, truth, arm, views, NO_CLOUD, arm_library(MODEL.space, 50, "left"))
    freely, held = (arm_px(by, truth, arm, views, tries, px, EMPTY) for px in (0.0, 10.0))
    np.testing.assert_allclose(held[0], freely[0])
    angle_rad = 2.0 * np.arccos(np.minimum(np.abs((tries[:, 1:] * tries[0, 1:]).sum(axis=2)), 1.0))
    np.testing.assert_allclose(freely - held, 10.0 * (angle_rad**2).sum(axis=1), atol=1e-6)


def test_an_arm_in_the_trunk_is_worth_less() -> None:
    """What no picture shows, behind the body, must be possible all the same."""
    by, truth = fitter(1), standing("hanging", "hanging")
    arm, views = arm_of(MODEL, LABELS, "left"), views_of(by, truth)
    through = truth.local_xyzw[arm.chain[:3]].copy()
    through[1:] = rotations.exp(np.array([[0.0, 0.0, -1.35], [0.0, 0.0, -0.9]]))
    tries = np.stack([truth.local_xyzw[arm.chain[:3]], through])
    stiff = arm_px(by, truth, arm, views, tries, 0.0, EMPTY)
    soft_params = replace(by.params, collision_sd_m=10.0)
    soft = Fitter(MODEL, LABELS, [d.camera for d in by.drawings], [FACTOR], soft_params)
    assert stiff[1] < arm_px(soft, truth, arm, views, tries, 0.0, EMPTY)[1] - 1.0


def with_bare_skin(by: Fitter, state: MotionState, views: list[View]) -> list[View]:
    """The same views; face and hands are seen to be bare."""
    out = []
    for view in views:
        drawing = by.drawings[view.index]
        drawing.render(state, view.dt_s, view.roi)
        seen = drawing.last(view.roi)[1]
        skin = np.append(
            (LABELS.label == 0) & np.isin(MODEL.part, (LEFT_ARM, RIGHT_ARM, HEAD)), False
        )
        out.append(replace(view, bare=skin[seen]))
    return out


def hand_px(by: Fitter, state: MotionState, views: list[View], *poses: str) -> Floats:
    """What is seen of the left hand in these poses of its arm."""
    bones = [INDEX["left" + bone] for bone in BONES]
    tries = np.array([standing(pose).local_xyzw[bones] for pose in poses])
    return score_hand_places(by, state, arm_of(MODEL, LABELS, "left"), views, tries, EMPTY)


def test_a_hand_is_where_skin_is_seen_that_is_nobody_elses() -> None:
    by, truth = fitter(2), standing("guarding", "side_low")
    views = with_bare_skin(by, truth, views_of(by, truth))
    there, hanging, raised = hand_px(by, truth, views, "guarding", "hanging", "raised")
    assert there > 10.0
    assert max(hanging, raised) < 0.0
    # of the other hand and of the face nothing is for this one
    without = [
        replace(v, bare=v.bare & ~by_left_hand(by, truth, v)) for v in views if v.bare is not None
    ]
    assert hand_px(by, truth, without, "guarding")[0] <= 0.0


def test_a_hand_that_nobody_looked_for_counts_for_nothing() -> None:
    by, truth = fitter(2), standing("guarding", "side_low")
    assert not hand_px(by, truth, views_of(by, truth), "guarding", "hanging").any()


def by_left_hand(by: Fitter, state: MotionState, view: View) -> NDArray[np.bool_]:
    """Where the left hand is drawn (h,w)."""
    drawing = by.drawings[view.index]
    drawing.render(state, view.dt_s, view.roi)
    hand = np.append((LABELS.label == 0) & (MODEL.part == LEFT_ARM), False)
    out: NDArray[np.bool_] = hand[drawing.last(view.roi)[1]]
    return out


# --- the search ------------------------------------------------------------------------------


def test_an_arm_is_confirmed_where_the_pictures_show_it() -> None:
    by, truth = fitter(2), standing("t_pose", "t_pose")
    views = views_of(by, truth)
    right = by.fit(truth, views, 1 / 30, 1)
    moved = swapped(truth, "left", standing("hanging", "hanging"))
    wrong = by.fit(moved, views, 1 / 30, 1)
    for side in SIDES:
        assert right.confirmed_arms[side] > 0.9
    assert wrong.confirmed_arms["left"] < 0.4
    assert wrong.confirmed_arms["right"] > 0.9


def test_an_arm_counts_no_more_than_its_forearm_as_far_as_the_hand() -> None:
    by, truth = fitter(2), standing("t_pose", "t_pose")
    bent = truth.local_xyzw.copy()
    elbow = INDEX["leftLowerArm"]
    bent[elbow] = rotations.multiply(bent[elbow], rotations.exp(np.array([0.0, -1.5, 0.0])))
    wrong = by.fit(replace(truth, local_xyzw=bent), views_of(by, truth), 1 / 30, 1)
    assert wrong.confirmed_to_hands["left"] < 0.7 * wrong.confirmed_arms["left"]
    assert wrong.confirmed_to_hands["right"] > 0.9


def test_a_lost_arm_is_found_again_and_the_other_left_alone() -> None:
    params = LimbSearchParams()
    by, truth = fitter(2), standing("goalpost", "side_low")
    views, search = views_of(by, truth), ArmSearch(by, params)
    wrong = swapped(truth, "left", standing("hanging", "hanging"))
    # one iteration, so that the fit itself does not find back
    fit = by.fit(wrong, views, 1 / 30, 1)
    assert is_uncertain("left", fit, params)
    assert not is_uncertain("right", fit, params)
    changed: set[str] = set()
    for turn in range(4):
        fit, sides = search.improve(fit, views, 1 / 30, turn)
        changed |= set(sides)
    fit = by.fit(fit.state, views, 1 / 30, 8)
    assert changed == {"left"}
    assert not is_uncertain("left", fit, params)
    for side in SIDES:
        off = arm_joints(by, fit.state, side) - arm_joints(by, truth, side)
        assert np.linalg.norm(off, axis=1).max() < 0.04


def test_a_hidden_arm_goes_where_its_hand_is_seen() -> None:
    """No colour of the sleeve shows; the hand does, to both cameras."""
    by, truth = fitter(2), standing("hand_on_hip", "hanging", yaw_rad=-0.4)
    views = with_bare_skin(by, truth, views_of(by, truth))
    colours = np.unique(arm_of(MODEL, LABELS, "left").labelled.label)
    wrong = swapped(truth, "left", standing("hand_on_belly", "hand_on_belly"))
    hidden = [hidden_sleeve(by, truth, view, colours) for view in views]
    off = []
    for seen in (hidden, [replace(view, bare=None) for view in hidden]):
        fit, search = (
            by.fit(wrong, seen, 1 / 30, 1),
            ArmSearch(by, LimbSearchParams()),
        )
        for turn in range(8):
            fit, _ = search.improve(fit, seen, 1 / 30, turn)
        off_m = arm_joints(by, fit.state, "left")[2] - arm_joints(by, truth, "left")[2]
        off.append(float(np.linalg.norm(off_m)))
    assert off[0] < 0.12
    assert off[0] < 0.5 * off[1]


def hidden_sleeve(by: Fitter, state: MotionState, view: View, colours: NDArray[np.uint8]) -> View:
    """The left sleeve is behind something that is no shirt."""
    drawing = by.drawings[view.index]
    drawing.render(state, view.dt_s, view.roi)
    sleeve = np.append((LABELS.label > 0) & (MODEL.part == LEFT_ARM), False)
    ids, pixel_weight = view.ids.copy(), view.pixel_weight.copy()
    mine = sleeve[drawing.last(view.roi)[1]]
    assert set(np.unique(ids[mine])) <= set(colours.tolist())
    ids[mine], pixel_weight[mine] = 0, 60
    return replace(view, ids=ids, pixel_weight=pixel_weight)


def test_arms_that_agree_are_not_searched() -> None:
    params = LimbSearchParams()
    by, truth = fitter(2), standing()
    views = views_of(by, truth)
    fit = by.fit(truth, views, 1 / 30, 2)
    again, sides = ArmSearch(by, params).improve(fit, views, 1 / 30, 0)
    assert again is fit
    assert sides == ()
