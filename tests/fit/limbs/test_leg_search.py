"""A leg that the pictures do not confirm is found again, however far it is."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import SIDES, full_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import TICK_S, FitParams, LegSearchParams
from mocapd.fit.limbs.leg_search import LegSearch, confirmed_share
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.pose_prior import seldom
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import region_labels
from tests.geometry.rigs import ring

pytestmark = pytest.mark.kernels

BODY = build_model(1.75, full_body())
FITTER = Fitter(BODY, region_labels(BODY), ring(2), [2, 2], FitParams())
PARAMS = LegSearchParams()
OUTER = np.array([INDEX[side + "Foot"] for side in SIDES])


def posed(side: str, thigh_rad: float, knee_rad: float) -> MotionState:
    """Somebody upright with one thigh raised forwards and its knee bent."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[INDEX[side + "UpperLeg"]] = rotations.exp(np.array([-thigh_rad, 0.0, 0.0]))
    local[INDEX[side + "LowerLeg"]] = rotations.exp(np.array([knee_rad, 0.0, 0.0]))
    return MotionState(
        BODY.rest_m[0].copy(), local, np.zeros(BODY.n_pose), np.ones(BODY.n_shape),
        initial_information(BODY.space),
    )  # fmt: skip


def views_of(truth: MotionState) -> list[View]:
    """What ideal pictures show."""
    out = []
    for i, drawing in enumerate(FITTER.drawings):
        w, h = (n // drawing.image_scale for n in drawing.camera.size_px)
        ids = drawing.render(truth, 0.0, (0, 0, w, h)).copy()
        out.append(View(i, (0, 0, w, h), ids, np.full(ids.shape, 255, np.uint8), 0.0))
    return out


@pytest.mark.parametrize("side", SIDES)
def test_a_knee_that_came_up_unseen_is_found(side: str) -> None:
    views = views_of(posed(side, 1.4, 1.8))
    there = FITTER.joints(posed(side, 1.4, 1.8))[0]
    search = LegSearch(FITTER, PARAMS)
    fit = FITTER.fit(posed(side, 0.0, 0.0), views, TICK_S, 4)
    missed_m = np.linalg.norm(FITTER.joints(fit.state)[0][OUTER] - there[OUTER], axis=1).max()
    assert confirmed_share(side, fit) < PARAMS.uncertain
    changed: set[str] = set()
    for turn in range(6):
        fit, sides = search.improve(fit, views, TICK_S, turn)
        changed.update(sides)
        fit = FITTER.fit(fit.state, views, TICK_S, 4)
    found_m = np.linalg.norm(FITTER.joints(fit.state)[0][OUTER] - there[OUTER], axis=1).max()
    assert side in changed
    assert missed_m > 0.3
    assert found_m < 0.08


def test_legs_that_are_where_they_are_seen_stay_there() -> None:
    truth = posed("left", 0.7, 1.0)
    views = views_of(truth)
    fit = FITTER.fit(truth, views, TICK_S, 4)
    search = LegSearch(FITTER, PARAMS)
    for turn in range(6):
        fit, sides = search.improve(fit, views, TICK_S, turn)
        assert not sides


def test_a_deep_squat_with_the_knees_out_is_found() -> None:
    truth = posed("left", 0.0, 0.0)
    local = truth.local_xyzw.copy()
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        local[INDEX[side + "UpperLeg"]] = rotations.exp(np.array([-1.2, 0.5 * mirror, mirror]))
        local[INDEX[side + "LowerLeg"]] = rotations.exp(np.array([2.2, 0.0, 0.0]))
    squat = replace(truth, local_xyzw=local)
    views, there = views_of(squat), FITTER.joints(squat)[0]
    local = local.copy()
    for side, mirror in (("left", 1.0), ("right", -1.0)):  # as somebody kneels
        local[INDEX[side + "UpperLeg"]] = rotations.exp(np.array([-0.4, 0.0, 0.2 * mirror]))
    search = LegSearch(FITTER, PARAMS)
    fit = FITTER.fit(replace(squat, local_xyzw=local), views, TICK_S, 4)
    for turn in range(12):
        fit, _ = search.improve(fit, views, TICK_S, turn)
        fit = FITTER.fit(fit.state, views, TICK_S, 4)
    found_m = np.linalg.norm(FITTER.joints(fit.state)[0][OUTER] - there[OUTER], axis=1)
    assert found_m.max() < 0.12


def test_what_is_seldom_counts_as_usual_at_first_and_ever_less_beyond() -> None:
    squared = np.linspace(0.0, 400.0, 200)
    costs = seldom(squared, 25.0)
    assert costs[0] == 0.0
    assert (np.diff(costs) > 0.0).all()
    assert (np.diff(costs, 2) < 0.0).all()
    assert seldom(np.array([1.0]), 25.0)[0] == pytest.approx(1.0, rel=0.03)


def test_a_leg_does_not_settle_on_the_other_one() -> None:
    """Both are of one colour; where the other leg is drawn already, nothing more is explained."""
    truth = posed("left", 0.0, 0.0)
    local = truth.local_xyzw.copy()
    local[INDEX["leftUpperLeg"]] = rotations.exp(np.array([0.0, 0.0, 0.5]))
    views = views_of(replace(truth, local_xyzw=local))
    there = FITTER.joints(replace(truth, local_xyzw=local))[0]
    local = local.copy()
    local[INDEX["leftUpperLeg"]] = rotations.exp(np.array([0.0, 0.0, -0.12]))  # onto the right one
    fit = FITTER.fit(replace(truth, local_xyzw=local), views, TICK_S, 1)
    search = LegSearch(FITTER, PARAMS)
    for turn in range(6):
        fit, _ = search.improve(fit, views, TICK_S, turn)
    apart_m = np.linalg.norm(FITTER.joints(fit.state)[0][OUTER] - there[OUTER], axis=1)
    assert apart_m.max() < 0.08


def test_a_leg_out_of_every_picture_is_not_asked() -> None:
    truth = posed("left", 0.0, 0.0)
    views = []
    for one in views_of(truth):
        x0, y0, x1, y1 = one.roi
        waist = int(0.5 * (y1 - y0))
        seen = (x0, y0, x1, y0 + waist)
        views.append(replace(one, roi=seen, ids=np.ascontiguousarray(one.ids[:waist]),
                             pixel_weight=np.ascontiguousarray(one.pixel_weight[:waist])))  # fmt: skip
    fit = FITTER.fit(truth, views, TICK_S, 2)
    assert fit.visible.sum() > 0.0
    assert all(confirmed_share(side, fit) >= PARAMS.uncertain for side in SIDES)
