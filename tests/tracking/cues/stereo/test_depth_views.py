"""Views of two cameras side by side know depths, and nothing of what is far behind; others are as they were."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.stereo_depth import StereoDepthParams
from mocapd.fit.view import View
from mocapd.tracking.cues.stereo.stereo_distances import GreyPicture, add_stereo_depth
from mocapd.types import Camera
from tests.fit.synthetic import CAMERAS, FACTOR, LABELS, MODEL, standing, textured_greys
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

PARAMS = StereoDepthParams()
BESIDE = tuple(
    looking_at(name, np.array([x, 1.2, 2.6]), np.array([x, 1.1, 0.0]))
    for name, x in (("left", -0.06), ("right", 0.06))
)


def filmed(cameras: tuple[Camera, ...], *bodies: MotionState) -> GreyPicture:
    """Bodies with texture, the first one in front."""
    greys = textured_greys(MODEL, cameras, bodies[-1])
    for body in bodies[-2::-1]:
        nearer = textured_greys(MODEL, cameras, body)
        greys = [np.where(a != 90, a, b) for a, b in zip(nearer, greys, strict=True)]
    return list(greys).__getitem__


def views(by: Fitter, state: MotionState, *others: MotionState) -> list[View]:
    """Where any of these bodies is all is classified as body; the first was drawn last."""
    out = []
    for i, drawing in enumerate(by.drawings):
        roi = (0, 0, 320, 240)
        ids = np.zeros((240, 320), np.uint8)
        for body in (*others, state):
            ids |= np.asarray(drawing.render(body, 0.0, roi) > 0, np.uint8)
        out.append(View(i, roi, ids, np.full(ids.shape, 90, np.uint8), 0.0))
    return out


def test_the_body_stays_and_who_is_far_behind_goes() -> None:
    by, state = Fitter(MODEL, LABELS, BESIDE, [FACTOR] * 2, FitParams()), standing()
    behind = replace(state, root_m=state.root_m + np.array([0.9, 0.0, -1.6]))
    before = views(by, state, behind)
    drawn = [drawing.last((0, 0, 320, 240))[0] > 0 for drawing in by.drawings]
    seen = add_stereo_depth(by, state, before, filmed(BESIDE, state, behind), PARAMS)
    for was, now, mine in zip(before, seen, drawn, strict=True):
        np.testing.assert_array_equal(now.ids[mine], was.ids[mine])
        others = (was.ids > 0) & ~mine
        assert others.sum() > 200
        assert np.mean(now.ids[others] > 0) < 0.5
        gone = others & (now.ids == 0)
        assert (now.pixel_weight[gone] == 255).all()
    assert seen[0].depth_m is not None
    assert seen[1].depth_m is None


def test_cameras_that_see_other_sides_and_one_alone_know_no_depths() -> None:
    state = standing()
    crossing = Fitter(MODEL, LABELS, CAMERAS[:2], [FACTOR] * 2, FitParams())
    seen = views(crossing, state)
    assert add_stereo_depth(crossing, state, seen, filmed(CAMERAS[:2], state), PARAMS) == seen
    by = Fitter(MODEL, LABELS, BESIDE, [FACTOR] * 2, FitParams())
    alone = views(by, state)[:1]
    assert add_stereo_depth(by, state, alone, filmed(BESIDE, state), PARAMS) == alone
