"""The first pose: whichever way somebody stands, they are found facing it, and not the other way."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorParams, FloorTerm
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.clothes_params import StartParams
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.tracking.initialisers.standing_initialiser import (
    blobs_of,
    fit_first_pose,
    person_candidates,
    views_of,
)
from mocapd.vision.foreground_kernels import BEFORE
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

STATURE_M, FACTOR = 1.75, 2
CAMERAS = [
    looking_at(name, np.array([x, 1.3, 3.2]), np.array([x, 0.9, 0.0]), roll_rad=0.0)
    for name, x in (("left", -0.06), ("right", 0.06))
]
BODY = build_model(STATURE_M, full_body())
PARAMS = StartParams()


def turned(yaw_rad: float) -> MotionState:
    """Somebody who takes a step, arms hanging but for a forearm held forwards."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw_rad, 0.0]))
    for side, mirror, step in (("left", 1.0, -0.3), ("right", -1.0, 0.2)):
        local[INDEX[side + "UpperArm"]] = rotations.exp(np.array([0.0, 0.0, -1.25 * mirror]))
        local[INDEX[side + "UpperLeg"]] = rotations.exp(np.array([step, 0.0, 0.0]))
    local[INDEX["leftLowerArm"]] = rotations.exp(np.array([0.0, -1.2, 0.0]))
    return MotionState(
        np.array([0.1, BODY.rest_m[0, 1] - 0.02, 0.0]), local, np.zeros(BODY.n_pose),
        np.ones(BODY.n_shape), initial_information(BODY.space),
    )  # fmt: skip


def found(state: MotionState) -> Fit:
    """The first fit to somebody's outlines."""
    by = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [FACTOR] * 2, FitParams(iterations=6))
    blobs = {}
    for i, drawing in enumerate(by.drawings):
        before = np.zeros((240, 320), np.uint8)
        roi = drawing.region(state, 0.0, 10)
        assert roi is not None
        x0, y0, x1, y1 = roi
        before[y0:y1, x0:x1] = np.where(drawing.render(state, 0.0, roi) > 0, BEFORE, 0)
        blobs[i] = blobs_of(before, False, PARAMS)
    who = person_candidates(blobs, CAMERAS, [FACTOR] * 2, STATURE_M, PARAMS)[0]
    fits = fit_first_pose(
        by, who, views_of(who, {0: 0.0, 1: 0.0}), state.factors, state.information,
        (FloorTerm(by.model, FloorParams()),), PARAMS,
    )  # fmt: skip
    while True:
        try:
            next(fits)
        except StopIteration as end:
            fit: Fit = end.value
            return fit


@pytest.mark.parametrize("yaw_rad", [-1.3, -0.9, 0.0, 0.9, 1.3])
def test_who_stands_aside_is_found_facing_there(yaw_rad: float) -> None:
    forward = rotations.rotate(
        found(turned(yaw_rad)).state.local_xyzw[0], np.array([0.0, 0.0, 1.0])
    )
    off_rad = np.angle(np.exp(1j * (np.arctan2(forward[0], forward[2]) - yaw_rad)))
    assert abs(off_rad) < 0.7
