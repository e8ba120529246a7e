"""One Gauss-Newton step without evidence: priors alone."""

from dataclasses import replace

import numpy as np

from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.view import View
from mocapd.geometry import rotations
from tests.fit.synthetic import fitter, standing

_NO_PIXEL = np.zeros((120, 160), np.uint8)
NOTHING_SEEN = View(0, (80, 60, 240, 180), _NO_PIXEL, _NO_PIXEL, 0.0)  # nor denied


def leaning(pitch_rad: float, roll_rad: float, yaw_rad: float) -> MotionState:
    state = standing("hanging", "hanging", yaw_rad)
    local = state.local_xyzw.copy()
    lean = rotations.exp(np.array([pitch_rad, 0.0, roll_rad]))
    local[0] = rotations.multiply(lean, local[0])
    return replace(state, local_xyzw=local)


def lean_rad(state: MotionState) -> float:
    up = rotations.rotate(state.local_xyzw[0], np.array([0.0, 1.0, 0.0]))
    return float(np.arccos(np.clip(up[1], -1.0, 1.0)))


def test_before_one_camera_a_body_of_which_nothing_is_seen_stands_up_slowly() -> None:
    by = fitter(1, FitParams(tilt_sd_rad=0.25))
    for yaw_rad in (0.0, 1.2, -2.5):
        before = leaning(0.3, -0.2, yaw_rad)
        after = by.fit(before, [NOTHING_SEEN], 1 / 30, 1).state
        assert lean_rad(after) < lean_rad(before) - 0.01
        turned = rotations.log(
            rotations.multiply(after.local_xyzw[0], rotations.inverse(before.local_xyzw[0]))
        )
        assert abs(turned[1]) < 0.2 * np.linalg.norm(turned)


def test_where_nothing_is_seen_the_prediction_is_held_by_what_is_known_of_it() -> None:
    by, before = fitter(1), leaning(0.0, 0.0, 0.0)
    firm = 1e6 * np.eye(by.model.n_pose)
    held = by.fit(before, [], 1 / 30, 3, motion=firm).state
    np.testing.assert_allclose(held.local_xyzw, before.local_xyzw, atol=1e-4)
    loose = by.fit(before, [], 1 / 30, 3).state
    assert np.abs(loose.local_xyzw - before.local_xyzw).max() > 1e-3
