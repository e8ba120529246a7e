"""A hand that bends at its wrist, which the model's hands do not, hardly turns the forearm."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX
from mocapd.evaluate.score import interior_angle_deg
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import initial_information
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import region_labels
from tests.fit.synthetic import CAMERAS, FACTOR, standing, views_of

pytestmark = pytest.mark.kernels

BODY = build_model(1.75, full_body())
_ELBOW = ("leftUpperArm", "leftLowerArm", "leftHand")


@pytest.mark.parametrize("bend_rad", [-0.9, 0.9])
def test_a_bent_wrist_hardly_turns_the_forearm(bend_rad: float) -> None:
    fitter = Fitter(BODY, region_labels(BODY), CAMERAS, [FACTOR] * 3, FitParams())
    stands = replace(
        standing("side_low", "side_low"),
        velocity=np.zeros(BODY.n_pose),
        factors=np.ones(BODY.n_shape),
        information=initial_information(BODY.space),
    )
    local = stands.local_xyzw.copy()
    local[INDEX["leftHand"]] = rotations.exp(np.array([0.0, 0.0, bend_rad]))
    views = views_of(fitter, replace(stands, local_xyzw=local))
    found = fitter.fit(stands, views, 1 / 30, 6).state
    joints_m = np.stack([fitter.joints(state)[0] for state in (stands, found)])
    straight_deg, after_deg = interior_angle_deg(joints_m, NAMES, _ELBOW)
    assert abs(after_deg - straight_deg) < 5.0
