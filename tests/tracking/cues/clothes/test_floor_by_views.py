"""Where views cross, pictures show how high feet are, and the floor hardly pulls at somebody who jumps."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.pose_terms import PoseTerms
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from tests.fit.term_system import BODY, system
from tests.fit.test_usual_legs import CAMERAS

pytestmark = pytest.mark.kernels

_PIXEL = np.zeros((1, 1), np.uint8)


def pull_down(body: MotionState, cameras: int) -> float:
    """Of the floor at the root of a body that so many cameras see [1/m]."""
    fitter = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [1, 1], FitParams())
    views = [View(i, (0, 0, 1, 1), _PIXEL, _PIXEL, 0.0) for i in range(cameras)]
    floor, *_ = PoseTerms(BODY, 2, ClothesParams()).measure(
        fitter, body, views, lambda _: _PIXEL, 0
    )
    _, _, b = system(floor, body.root_m, body.local_xyzw)
    return float(-b[1])


def test_before_crossing_views_the_floor_hardly_pulls_at_who_jumps() -> None:
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    stands = t_pose_state(BODY, BODY.rest_m[0].copy(), wearer)
    jumps = replace(stands, root_m=stands.root_m + (0.0, 0.2, 0.0))
    assert abs(pull_down(stands, 2)) < 1e-6
    assert 0.0 < pull_down(jumps, 2) < 0.15 * pull_down(jumps, 1)


def test_feet_that_one_of_two_cameras_does_not_show_are_held() -> None:
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    near_the_front = t_pose_state(BODY, BODY.rest_m[0] + (0.0, 0.1, 2.2), wearer)
    assert pull_down(near_the_front, 2) == pytest.approx(pull_down(near_the_front, 1))
