"""Depths of two cameras beside each other: a body with texture is where it stands, and agrees with itself alone."""

import numpy as np
import pytest

from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.stereo_depth import StereoDepthParams, StereoPair, stereo_depth_m
from mocapd.fit.terms.depth_agreement_kernels import compare_depths
from mocapd.fit.view import View
from mocapd.types import Floats
from mocapd.vision.raster_kernels import NOTHING
from tests.fit.synthetic import FACTOR, LABELS, MODEL, apply_step, standing, textured_greys
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

PARAMS = StereoDepthParams()
LEFT, RIGHT = SIDE_BY_SIDE = tuple(
    looking_at(name, np.array([x, 1.2, 2.6]), np.array([x, 1.1, 0.0]))
    for name, x in (("left", -0.06), ("right", 0.06))
)


def seen(by: Fitter, state: MotionState, thought: MotionState) -> View:
    """The first camera's view of a state, with depths, looked for about another one."""
    drawing = by.drawings[0]
    roi = drawing.region(state, 0.0, 20)
    assert roi is not None
    ids = drawing.render(state, 0.0, roi).copy()
    first, second = textured_greys(MODEL, SIDE_BY_SIDE, state)
    pair = StereoPair(LEFT, RIGHT, (first, second), FACTOR)
    depth_m = stereo_depth_m(ids > 0, roi, pair, thought.root_m, PARAMS.farther_m, PARAMS)
    return View(0, roi, ids, np.full(ids.shape, 255, np.uint8), 0.0, depth_m=depth_m)


def shifted(by: Fitter, state: MotionState, z_m: float) -> MotionState:
    step = np.zeros(MODEL.n_pose)
    step[2] = z_m
    return apply_step(by, state, step)


def body() -> Fitter:
    return Fitter(MODEL, LABELS, SIDE_BY_SIDE, [FACTOR] * 2, FitParams())


def off_m(by: Fitter, view: View, state: MotionState) -> Floats:
    """By how much farther it is seen than a state is drawn, where both are known."""
    assert view.depth_m is not None
    drawn = by.drawings[0].render(state, 0.0, view.roi) > 0
    known = drawn & np.isfinite(view.depth_m)
    return np.asarray((view.depth_m - by.drawings[0].last_depth_m(view.roi))[known], float)


@pytest.mark.parametrize("thought_m", [-0.2, 0.0, 0.2])
def test_a_body_with_texture_is_seen_where_it_stands(thought_m: float) -> None:
    by, truth = body(), standing("forward_low", "side_low")
    off = off_m(by, seen(by, truth, shifted(by, truth, thought_m)), truth)
    assert len(off) > 500
    assert abs(np.median(off)) < 0.02
    assert np.mean(np.abs(off) < 0.1) > 0.8


def test_only_what_is_wanted_is_told_and_nothing_without_texture() -> None:
    by, truth = body(), standing()
    drawing = by.drawings[0]
    roi = drawing.region(truth, 0.0, 20)
    assert roi is not None
    wanted = drawing.render(truth, 0.0, roi) > 0
    grey = np.full((480, 640), 90, np.uint8)
    pair = StereoPair(LEFT, RIGHT, (grey, grey), FACTOR)
    depth_m = stereo_depth_m(wanted, roi, pair, truth.root_m, PARAMS.farther_m, PARAMS)
    assert depth_m.shape == wanted.shape
    assert np.isnan(depth_m).all()
    nothing = np.zeros_like(wanted)
    assert np.isnan(
        stereo_depth_m(nothing, roi, pair, truth.root_m, PARAMS.farther_m, PARAMS)
    ).all()


def test_a_fit_costs_more_where_depths_deny_it_and_says_of_which_patches() -> None:
    by, truth = body(), standing("forward_low", "side_low")
    view = seen(by, truth, truth)
    costs, shares = [], []
    for z_m in (0.0, 0.25):
        fit = by.fit(shifted(by, truth, z_m), [view], 1e-3, 1, False, fine=1)
        costs.append(fit.cost)
        shares.append(fit.in_depth[fit.visible > 40.0].mean())
    assert costs[1] > costs[0] + 100.0
    assert shares[0] > 0.75
    assert shares[1] < 0.5 * shares[0]


def test_the_comparison_equals_its_naive_twin() -> None:
    rng = np.random.default_rng(4)
    h, w, off_m = 21, 30, 0.1
    drawn = rng.uniform(2.0, 2.6, (h, w)).astype(np.float32)
    coarse = np.where(rng.random((7, 10)) < 0.3, np.nan, rng.uniform(1.6, 2.9, (7, 10)))
    seen_m = coarse.repeat(3, axis=0).repeat(3, axis=1).astype(np.float32)
    at = rng.integers(NOTHING, 5, (h, w)).astype(np.int32)
    drawn[at == NOTHING] = 1e9
    patch = np.array([1, 1, 2, 3, 0], np.uint8)
    asked, off = np.zeros(21), np.zeros(21)
    cost, nearer_px = compare_depths(drawn, at, patch, seen_m, 3, 2, off_m, asked, off)
    wanted, wanted_nearer = 0.0, 0
    wanted_asked, wanted_off = np.zeros(21), np.zeros(21)
    for y in range(1, h, 3):
        for x in range(1, w, 3):
            if at[y, x] == NOTHING or np.isnan(seen_m[y, x]):
                continue
            around = drawn[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3].astype(float)
            before = max(around.min() - float(seen_m[y, x]), 0.0)
            away = max(before, float(seen_m[y, x]) - around.max()) / off_m
            wanted += 9 * min(away**2, 1.0)
            wanted_nearer += 9 * (before > 2.0 * off_m)
            wanted_asked[patch[at[y, x]]] += 9
            wanted_off[patch[at[y, x]]] += 9 * (away > 1.0)
    np.testing.assert_allclose(cost, wanted, rtol=1e-4)
    assert nearer_px == wanted_nearer > 0
    np.testing.assert_array_equal(asked, wanted_asked)
    np.testing.assert_array_equal(off, wanted_off)


def test_hands_before_a_trunk_of_their_colour_are_looked_for() -> None:
    by, truth = body(), standing("hugging", "hugging")
    hanging = standing("side_low", "side_low")
    there = by.fit(truth, [seen(by, truth, truth)], 1e-3, 1, False, fine=1)
    elsewhere = by.fit(hanging, [seen(by, truth, hanging)], 1e-3, 1, False, fine=1)
    assert there.nearer_px < 30.0
    assert elsewhere.nearer_px > 100.0
