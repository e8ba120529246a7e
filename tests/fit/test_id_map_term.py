"""The alignment kernel against its slow twin, and the fit that is built on it."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.arrays import PinholeArrays
from mocapd.body.model import Shaper
from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.id_map_kernels import ComparedPictures, Search
from mocapd.fit.terms.id_map_sums import CameraSums
from mocapd.fit.terms.nearest_pixel_kernels import labels_in_reach, offsets_by_distance
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.types import Bytes
from tests.fit import naive_id_map_term
from tests.fit.naive_id_map_term import Posed, Sums, posed
from tests.fit.synthetic import CAMERAS, LABELS, MODEL, apply_step, fitter, standing, views_of

pytestmark = pytest.mark.kernels

TICK_S = 1.0 / 30.0
# joints that the shirt tells of
UPPER = [
    j for name, j in INDEX.items() if not any(s in name for s in ("Leg", "Foot", "Toes", "head"))
]


def test_offsets_by_distance_go_outwards_through_every_offset_once() -> None:
    offsets = offsets_by_distance(6).astype(int)
    squared = (offsets**2).sum(axis=1)
    assert (np.diff(squared) >= 0).all()
    assert squared[0] == 1
    everywhere = {(x, y) for x in range(-6, 7) for y in range(-6, 7) if 0 < x * x + y * y <= 36}
    assert {tuple(offset) for offset in offsets.tolist()} == everywhere
    assert len(offsets) == len(everywhere)


# --- the kernel ------------------------------------------------------------------------------

COARSE = 8  # pictures of 80x60, for the slow twin
ROBUST_PX, RADIUS_PX, WEIGHT = 2.4, 4, 0.06


def accumulated(
    state: MotionState,
    drawn: Posed,
    image_ids: Bytes,
    pixel_weight: Bytes,
    phase: int = 0,
    every: int = 2,
    edge_weight: float = 0.0,
    n_shape: int = 0,
    grid_px: float = 1.0,
) -> Sums:
    camera, offsets = CAMERAS[0], offsets_by_distance(20)
    within = int(((offsets.astype(int) ** 2).sum(axis=1) <= (RADIUS_PX / grid_px) ** 2).sum())
    fx, fy = (float(grid_px * camera.K[i, i] / COARSE) for i in (0, 1))
    sums, n_unknown = CameraSums(MODEL, LABELS), MODEL.n_pose + n_shape
    sums.gather(
        ComparedPictures(drawn.ids, drawn.triangle_at, image_ids, pixel_weight),
        Search(offsets[:within], float(RADIUS_PX), ROBUST_PX, grid_px, every, phase, edge_weight),
        drawn.xy, Shaper(MODEL)(state.factors).centres, drawn.joints, PinholeArrays(camera.R, camera.t_m, fx, fy),
        n_unknown, WEIGHT,
    )  # fmt: skip
    return Sums(*sums.by_size[n_unknown], *sums.counts, sums.cost)


@pytest.mark.parametrize(
    ("phase", "every", "edge_weight", "n_shape", "grid_px"),
    [
        (0, 2, 1.0, MODEL.n_shape, 1.0),
        (1, 2, 0.0, 0, 1.0),
        (0, 1, 0.0, 0, 2.0),
        (1, 2, 0.5, MODEL.n_shape, 1.0),
    ],
)
def test_accumulate_equals_the_naive_twin(
    phase: int, every: int, edge_weight: float, n_shape: int, grid_px: float
) -> None:
    """The twin's derivatives are differences with h = 1e-6: rows agree to 1e-10 / 1e-6 = 1e-4 px and
    better, against rows of tens of px per radian or metre, hundreds of them added up."""
    rng = np.random.default_rng(phase)
    truth, camera = standing(), CAMERAS[0]
    factors = 1.0 + rng.uniform(-0.05, 0.05, MODEL.n_shape)
    state = replace(
        apply_step(fitter(1), truth, rng.normal(0.0, 0.08, MODEL.n_pose)), factors=factors
    )
    image_ids = posed(MODEL, LABELS, truth, camera, COARSE).ids
    wrong = rng.random(image_ids.shape) < 0.1
    image_ids[wrong] = rng.integers(0, 11, wrong.sum())
    pixel_weight = rng.integers(0, 256, image_ids.shape).astype(np.uint8)
    drawn = posed(MODEL, LABELS, state, camera, COARSE)
    got = accumulated(
        state, drawn, image_ids, pixel_weight, phase, every, edge_weight, n_shape, grid_px
    )
    wanted = naive_id_map_term.accumulate(
        MODEL, LABELS, state, drawn, camera, COARSE, image_ids, pixel_weight,
        grid_px, RADIUS_PX, ROBUST_PX, phase, every, edge_weight, n_shape, WEIGHT,
    )  # fmt: skip
    for name in ("visible", "matched", "unexplained"):
        np.testing.assert_array_equal(getattr(got, name), getattr(wanted, name))
    assert got.cost == pytest.approx(wanted.cost, rel=1e-12)
    assert got.unexplained.sum() > 30
    scale = np.abs(wanted.H).max()
    np.testing.assert_allclose(got.H, wanted.H, atol=1e-6 * scale)
    np.testing.assert_allclose(got.b, wanted.b, atol=1e-6 * np.abs(wanted.b).max())


def test_a_label_out_of_reach_is_not_searched_and_one_within_always_is() -> None:
    """A cell may say too much, never too little."""
    rng = np.random.default_rng(0)
    ids = (rng.integers(1, 11, (60, 83)) * (rng.random((60, 83)) < 0.004)).astype(np.uint8)
    y, x = np.mgrid[:60, :83]
    for radius in (3.0, 8.0, 12.5, 20.0):
        told = labels_in_reach(ids, radius)[y // 8, x // 8]
        for k in range(1, 11):
            near = np.zeros(ids.shape, bool)
            far = np.ones(ids.shape, bool)
            for v, u in np.argwhere(ids == k):
                apart = np.hypot(y - v, x - u)
                near |= apart <= radius
                far &= apart > radius * 1.5 + 40
            there = (told >> k & 1).astype(bool)
            assert there[near].all()
            assert not there[far].any()


def test_perfect_agreement_asks_for_no_step() -> None:
    state = standing()
    drawn = posed(MODEL, LABELS, state, CAMERAS[0], COARSE)
    sure = np.full(drawn.ids.shape, 255, np.uint8)
    got = accumulated(state, drawn, drawn.ids.copy(), sure, n_shape=MODEL.n_shape)
    assert got.cost == 0.0
    assert not got.b.any()
    assert not got.unexplained.any()
    assert got.visible.sum() > 50
    np.testing.assert_array_equal(got.matched, got.visible)


def test_pixel_weight_weighs_what_the_picture_denies() -> None:
    """A body before nothing but unclassified pixels costs as much as those deny it."""
    state = standing()
    drawn = posed(MODEL, LABELS, state, CAMERAS[0], COARSE)
    nothing = np.zeros_like(drawn.ids)
    costs = [
        accumulated(state, drawn, nothing, np.full_like(drawn.ids, s)).cost for s in (0, 51, 255)
    ]
    assert costs[0] == 0.0
    assert costs[1] == pytest.approx(0.2 * costs[2])
    assert costs[2] > 0.0


# --- the fit ---------------------------------------------------------------------------------


def errors(by: Fitter, got: MotionState, truth: MotionState) -> tuple[float, float]:
    """RMS over the upper joints [m], mean over their bones [rad]."""
    joints, turned = by.joints(got)
    true_joints, true_turned = by.joints(truth)
    apart = np.linalg.norm(joints - true_joints, axis=1)[UPPER]
    return float(np.sqrt((apart**2).mean())), float(
        rotations.angle_rad(turned, true_turned)[UPPER].mean()
    )


def beside(by: Fitter, truth: MotionState, seed: int) -> MotionState:
    """A few centimetres and degrees away, as a prediction is."""
    rng = np.random.default_rng(seed)
    step = np.concatenate([rng.normal(0.0, 0.03, 3), rng.normal(0.0, 0.08, MODEL.n_pose - 3)])
    return apply_step(by, truth, step)


def fitted(by: Fitter, start: MotionState, views: list[View]) -> Fit:
    return by.fit(start, views, TICK_S, 8)


# What remains of a fit to perfect ids, whose pixels are 9 mm wide at the body: edges in place weigh
# against those that are not, so two cameras come well below a pixel. One camera knows the distance
# only from the size, to about a pixel in the body's 150.
LEFT_M = {1: 0.035, 2: 0.006, 3: 0.006}
LEFT_RAD = {1: np.radians(5.0), 2: np.radians(4.5), 3: np.radians(4.0)}


@pytest.mark.parametrize("n_cameras", [1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_a_known_shift_of_the_pose_is_recovered(n_cameras: int, seed: int) -> None:
    by, truth = fitter(n_cameras), standing()
    views, start = views_of(by, truth), beside(by, truth, seed)
    before_m, before_rad = errors(by, start, truth)
    fit = fitted(by, start, views)
    after_m, after_rad = errors(by, fit.state, truth)
    assert before_m > 0.03
    assert after_m < min(LEFT_M[n_cameras], 0.7 * before_m)
    assert after_rad < min(LEFT_RAD[n_cameras], before_rad)
    assert fit.matched.sum() > 0.88 * fit.visible.sum()


def test_the_cost_falls() -> None:
    by, truth = fitter(2), standing()
    views, start = views_of(by, truth), beside(by, truth, 4)
    costs = []
    for iterations in (1, 8):
        state = by.fit(start, views, TICK_S, iterations).state
        # asked again of that state, by one iteration of the same radius
        costs.append(by.fit(state, views, TICK_S, 1).cost)
    first = by.fit(start, views, TICK_S, 1).cost
    assert costs[1] < costs[0] < first
    assert costs[1] < 0.2 * first


def test_missing_and_wrong_pixels_do_not_matter_much() -> None:
    """A fifth of the pixels unclassified over uncertain background, and some of a wrong colour."""
    by, truth = fitter(2), standing()
    rng = np.random.default_rng(0)
    views = []
    for view in views_of(by, truth):
        ids, pixel_weight = view.ids.copy(), view.pixel_weight.copy()
        missing = rng.random(ids.shape) < 0.2
        ids[missing], pixel_weight[missing] = 0, 64
        wrong = rng.random(ids.shape) < 0.005
        ids[wrong] = rng.integers(1, 11, wrong.sum())
        views.append(replace(view, ids=ids, pixel_weight=pixel_weight))
    for seed in range(3):
        fit = fitted(by, beside(by, truth, seed), views)
        after_m, _ = errors(by, fit.state, truth)
        assert after_m < 0.02


def test_each_camera_is_fitted_at_its_own_instant() -> None:
    """A body that moves, seen by free-running cameras: the pose is that of the asked instant."""
    by = fitter(2)
    velocity = np.zeros(MODEL.n_pose)
    velocity[0] = 4.0  # m/s to the side: 6 cm between the cameras
    truth = replace(standing(), velocity=velocity)
    views = views_of(by, truth, dts_s=(0.0, 0.016))
    own, _ = errors(by, fitted(by, truth, views).state, truth)
    together = [replace(view, dt_s=0.0) for view in views]
    mixed, _ = errors(by, fitted(by, truth, together).state, truth)
    assert own < LEFT_M[2]
    assert mixed > 0.025


def test_proportions_are_learned() -> None:
    by = fitter(3)
    wide = replace(standing("side_low", "side_high"), factors=np.ones(MODEL.n_shape))
    wide.factors[4], wide.factors[3] = 1.15, 1.1  # torso width, forearms
    views, state = views_of(by, wide), replace(wide, factors=np.ones(MODEL.n_shape))
    for _ in range(4):
        state = by.fit(state, views, TICK_S, 5, learn_shape=True).state
    assert abs(state.factors[4] - 1.15) < 0.05
    assert abs(state.factors[3] - 1.1) < 0.05
    assert np.abs(np.delete(state.factors, [3, 4]) - 1.0).max() < 0.1


def test_a_fit_without_views_stays_where_it_is() -> None:
    by, state = fitter(1), standing("t_pose", "t_pose")
    fit = fitted(by, state, [])
    assert fit.cost == 0.0
    assert errors(by, fit.state, state)[0] < 0.02
