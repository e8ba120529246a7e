"""The shirt's distance by its texture: for cameras side by side, and only for those."""

import numpy as np
import pytest

from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.stereo_match_term import StereoMatchParams
from mocapd.fit.view import View
from mocapd.tracking.cues.stereo.stereo_distances import GreyPicture, stereo_distance_terms
from mocapd.types import Camera, Floats
from tests.fit.synthetic import CAMERAS, LABELS, MODEL, apply_step, standing, textured_greys
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

SIDE_BY_SIDE = tuple(
    looking_at(name, np.array([x, 1.2, 2.6]), np.array([x, 1.1, 0.0]))
    for name, x in (("left", -0.06), ("right", 0.06))
)


def textured(cameras: tuple[Camera, ...], state: MotionState) -> GreyPicture:
    """Pictures of a body whose brightness follows its surface."""
    return list(textured_greys(MODEL, cameras, state)).__getitem__


def shifted(by: Fitter, state: MotionState, m: Floats) -> MotionState:
    step = np.zeros(MODEL.n_pose)
    step[:3] = m
    return apply_step(by, state, step)


def drawn(by: Fitter, state: MotionState) -> list[View]:
    """As a tracker leaves it: the predicted body drawn last into every view."""
    views = []
    for i, drawing in enumerate(by.drawings):
        roi = drawing.region(state, 0.0, 20)
        assert roi is not None
        ids = drawing.render(state, 0.0, roi)
        views.append(View(i, roi, ids, np.full(ids.shape, 255, np.uint8), 0.0))
    return views


def test_a_pair_side_by_side_pulls_the_body_to_where_its_texture_is() -> None:
    truth = standing()
    by = Fitter(MODEL, LABELS, SIDE_BY_SIDE, [2, 2], FitParams())
    nearer = shifted(by, truth, np.array([0.0, 0.0, 0.12]))
    (term,) = stereo_distance_terms(
        by, nearer, drawn(by, nearer), textured(SIDE_BY_SIDE, truth), 0, StereoMatchParams()
    )
    H, b = np.zeros((MODEL.n_pose, MODEL.n_pose)), np.zeros(MODEL.n_pose)
    by.drawings[0].pose(nearer.root_m, nearer.local_xyzw, by.shaper(nearer.factors).rest)
    term.add(by.drawings[0].posed, by.shaper(nearer.factors), H, b)
    back_m = b[2] / H[2, 2]  # along the view, all else held
    assert -0.15 < back_m < -0.09


def test_cameras_that_see_other_sides_and_one_alone_do_not_ask() -> None:
    truth = standing()
    crossing = Fitter(MODEL, LABELS, CAMERAS[:2], [2, 2], FitParams())
    grey = textured(CAMERAS[:2], truth)
    views = drawn(crossing, truth)
    assert stereo_distance_terms(crossing, truth, views, grey, 0, StereoMatchParams()) == ()
    alone = Fitter(MODEL, LABELS, SIDE_BY_SIDE, [2, 2], FitParams())
    views = drawn(alone, truth)[:1]
    grey = textured(SIDE_BY_SIDE, truth)
    assert stereo_distance_terms(alone, truth, views, grey, 0, StereoMatchParams()) == ()
