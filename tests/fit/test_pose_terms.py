"""The floor and measured distances: rows that are derivatives, and bodies that go where they should."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, apply_step, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.distance_term import DistanceTerm, MeasuredDistances
from mocapd.fit.terms.floor_term import FloorParams, FloorTerm
from mocapd.fit.terms.stereo_match_term import measured_distances
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.types import Floats, Ints
from tests.fit.synthetic import textured_greys
from tests.fit.term_system import BODY, SHAPED, posed, system
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

ROOT = BODY.rest_m[0].copy()
CAMERAS = tuple(
    looking_at(name, np.array([x, 1.2, 2.9]), np.array([x, 0.9, 0.0]), roll_rad=0.0)
    for name, x in (("left", -0.06), ("right", 0.06))
)


def bent(seed: int = 3) -> Floats:
    """Local rotations of some pose."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    rng = np.random.default_rng(seed)
    for joint in BODY.joint_of_group:
        local[joint] = rotations.exp(rng.normal(0.0, 0.25, 3))
    return local


def relaxed() -> Floats:
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        local[INDEX[side + "UpperArm"]] = rotations.exp(np.array([0.0, 0.0, -0.9 * sign]))
    return local


def places(root: Floats, local: Floats, triangle: Ints) -> Floats:
    """Middles (N,3) of triangles in the world."""
    body, bones = posed(root, local), BODY.triangle_bones[triangle]
    turned = np.einsum(
        "nkij,nkj->nki", body.R[bones], SHAPED.centres[triangle][:, None] - body.rest[bones]
    )
    out: Floats = np.einsum(
        "nk,nki->ni", BODY.triangle_weights[triangle], turned + body.joints[bones]
    )
    return out


SOME = np.arange(0, len(BODY.triangles), 100)


def distances(root: Floats, local: Floats, farther_m: Floats) -> MeasuredDistances:
    """Of some triangles, seen from the first camera, farther away than they are."""
    origin = centre(CAMERAS[0])
    rays = places(root, local, SOME) - origin
    away = np.linalg.norm(rays, axis=1)
    return MeasuredDistances(
        SOME, origin, rays / away[:, None], away + farther_m, np.full(len(SOME), 0.04)
    )


def terms() -> list[tuple[Term, float]]:
    """Each with a residual so small that its weight hardly changes, and how high the body is above where it stands."""
    rng = np.random.default_rng(5)
    local = bent()
    off_m = rng.normal(0.0, 0.003, len(SOME))
    on_floor = [INDEX[side + bone] for side in ("left", "right") for bone in ("Foot", "Toes")]
    low = min(posed(ROOT, local).joints[on_floor, 1] - SHAPED.rest[on_floor, 1])
    lowest_alone = FloorTerm(BODY, FloorParams(together_m=0.0))
    return [
        (lowest_alone, 0.01 - low),
        (lowest_alone, -0.01 - low),
        (DistanceTerm(BODY, distances(ROOT, local, off_m)), 0.0),
    ]


@pytest.mark.parametrize("which", range(3))
def test_rows_are_the_derivatives_of_the_cost(which: int) -> None:
    term, raised_m = terms()[which]
    root, local = ROOT + np.array([0.0, raised_m, 0.0]), bent()
    cost, H, b = system(term, root, local)
    assert cost > 0.0
    assert np.allclose(H, H.T)
    step = 1e-6
    for k in range(BODY.n_pose):
        ends = []
        for sign in (1.0, -1.0):
            there = np.zeros(BODY.n_pose, dtype=np.float64)
            there[k] = sign * step
            ends.append(system(term, *apply_step(BODY, root, local, there))[0])
        slope = (ends[0] - ends[1]) / (2.0 * step)
        assert slope == pytest.approx(-2.0 * b[k], rel=0.03, abs=2e-3 * np.abs(b).max())


def settled(term: Term, root: Floats, local: Floats) -> tuple[Floats, Floats]:
    """After ten steps, with a little that holds the pose."""
    for _ in range(10):
        _, H, b = system(term, root, local)
        step = np.asarray(np.linalg.solve(H + np.eye(len(b)), b), dtype=np.float64)
        root, local = apply_step(BODY, root, local, step)
    return root, local


@pytest.mark.parametrize("up_m", [0.08, -0.08])
def test_who_hovers_or_sinks_comes_to_stand(up_m: float) -> None:
    term, local = FloorTerm(BODY), np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    root, local = settled(term, ROOT + np.array([0.0, up_m, 0.0]), local)
    feet = posed(root, local).joints[[INDEX["leftFoot"], INDEX["rightFoot"]], 1]
    np.testing.assert_allclose(feet, SHAPED.rest[INDEX["leftFoot"], 1], atol=0.003)


def test_who_stands_on_tiptoe_by_mistake_comes_down_to_the_soles() -> None:
    """The shoe's picture is as high either way."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for side in ("left", "right"):
        local[INDEX[side + "Foot"]] = rotations.exp(np.array([0.4, 0.0, 0.0]))
    root, local = settled(FloorTerm(BODY), ROOT + np.array([0.0, 0.04, 0.0]), local)
    for bone in ("Foot", "Toes"):
        height = posed(root, local).joints[INDEX["left" + bone], 1]
        assert height == pytest.approx(SHAPED.rest[INDEX["left" + bone], 1], abs=0.005)


def test_a_raised_foot_is_left_in_the_air_and_a_jump_hardly_held() -> None:
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[INDEX["leftUpperLeg"]] = rotations.exp(np.array([-1.2, 0.0, 0.0]))
    term = FloorTerm(BODY)
    _, _, b = system(term, ROOT, local)
    left_knee = BODY.space.group("leftLowerLeg")
    assert not b[3 + 3 * left_knee : 6 + 3 * left_knee].any()
    low, high = (
        system(term, ROOT + np.array([0.0, up_m, 0.0]), bent(0))[2][1] / up_m for up_m in (0.3, 1.0)
    )
    assert abs(high) < 0.35 * abs(low)


def fitted(terms: tuple[Term, ...], start: MotionState, truth: MotionState) -> Floats:
    """Joints after fitting the true silhouettes of both cameras side by side."""
    fitter = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [2, 2], FitParams())
    views = []
    for i, drawing in enumerate(fitter.drawings):
        ids = drawing.render(truth, 0.0, (0, 0, 320, 240)).copy()
        views.append(View(i, (0, 0, 320, 240), ids, np.full(ids.shape, 255, np.uint8), 0.0))
    fit = fitter.fit(start, views, 0.4, 10, terms=terms)
    return fitter.joints(fit.state)[0]


def test_floor_and_distances_bring_back_a_body_that_is_too_far_away() -> None:
    """Silhouettes of cameras side by side alone leave it behind."""
    still, known = np.zeros(BODY.n_pose), initial_information(BODY.space)
    truth = MotionState(ROOT, relaxed(), still, np.ones(BODY.n_shape), known)
    back = ROOT + np.array([0.0, 0.0, -0.25])
    start = replace(truth, root_m=back)
    wanted = posed(ROOT, relaxed()).joints
    seen = DistanceTerm(BODY, distances(ROOT, relaxed(), np.zeros(len(SOME))))
    alone, helped = (
        np.linalg.norm(fitted(terms, start, truth) - wanted, axis=1)
        for terms in ((), (FloorTerm(BODY), seen))
    )
    assert np.sqrt((helped**2).mean()) < 0.025
    assert np.sqrt((helped**2).mean()) < 0.6 * np.sqrt((alone**2).mean())


def test_distances_are_measured_where_the_body_has_texture() -> None:
    """Pictures of a body whose brightness follows the surface: expected 15 cm too near, found to 3 cm."""
    fitter = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [2, 2], FitParams())
    still, known = np.zeros(BODY.n_pose), initial_information(BODY.space)
    truth = MotionState(ROOT, relaxed(), still, np.ones(BODY.n_shape), known)
    greys = textured_greys(BODY, CAMERAS, truth)
    start = replace(truth, root_m=ROOT + np.array([0.0, 0.0, 0.15]))
    drawing, roi = fitter.drawings[0], (0, 0, 320, 240)
    drawing.render(start, 0.0, roi)
    found = measured_distances(
        drawing, drawing.last(roi), SHAPED, CAMERAS[1], (greys[0], greys[1]), turn=0
    )
    assert len(found.distance_m) > 30
    expected = np.einsum(
        "ni,ni->n", places(start.root_m, relaxed(), found.triangle) - found.origin_m, found.rays
    )
    farther_m = found.distance_m - expected
    assert abs(np.median(farther_m) - 0.15) < 0.02
    assert (np.abs(farther_m - 0.15) < 0.05).mean() > 0.7
