"""Which way somebody faces: a body turned round looks alike, and a face tells."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.hypotheses.flipped_poses import flipped_poses
from mocapd.types import BodyState, Floats, Pose
from tests.geometry.rigs import ring
from tests.tracking.profiles import markerless_tracker

BODY = build_model(1.75, full_body())
FITTER = Fitter(BODY, region_labels(BODY), ring(2), [2, 2], FitParams())
ALONG = np.array([0.0, -0.3, -1.0])


def somebody() -> MotionState:
    """Half turned, one arm up, one leg forwards."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, 0.5, 0.0]))
    local[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, -0.4, 0.9]))
    local[INDEX["rightUpperLeg"]] = rotations.exp(np.array([-0.6, 0.0, 0.0]))
    return MotionState(
        BODY.rest_m[0].copy(), local, np.zeros(BODY.n_pose), np.ones(BODY.n_shape),
        initial_information(BODY.space),
    )  # fmt: skip


def joints_of(state: MotionState) -> Floats:
    return FITTER.joints(state)[0]


def facing_rad(state: MotionState) -> float:
    forward = rotations.rotate(
        FITTER.joints(state)[1][INDEX["upperChest"]], np.array([0.0, 0.0, 1.0])
    )
    return float(np.arctan2(forward[0], forward[2]))


def test_a_mirrored_body_is_where_the_other_sides_joints_are_seen() -> None:
    state = somebody()
    mirrored, _ = flipped_poses(FITTER, state, ALONG)
    across = joints_of(state)
    found = joints_of(mirrored)
    for left, right in (
        ("leftHand", "rightHand"),
        ("leftFoot", "rightFoot"),
        ("leftLowerArm", "rightLowerArm"),
    ):
        for one, other in ((left, right), (right, left)):
            # along the view it is on the other side of the hips, across it is where it was
            there = across[INDEX[other]] - across[0]
            there[2] = -there[2]
            np.testing.assert_allclose(found[INDEX[one]] - found[0], there, atol=0.01)


def test_a_body_turned_round_keeps_its_limbs_in_place_and_faces_the_other_way() -> None:
    state = somebody()
    _, turned = flipped_poses(FITTER, state, ALONG)
    before, after = joints_of(state), joints_of(turned)
    apart = np.linalg.norm(after[INDEX["leftHand"]] - before[INDEX["rightHand"]])
    assert apart < 0.06  # joints lie a little before or behind the trunk's middle
    assert np.cos(facing_rad(turned) - facing_rad(state)) == pytest.approx(-1.0, abs=1e-6)


def test_turning_twice_brings_everything_back() -> None:
    state = somebody()
    for which in (0, 1):
        there = flipped_poses(FITTER, state, ALONG)[which]
        back = flipped_poses(FITTER, there, ALONG)[which]
        np.testing.assert_allclose(joints_of(back), joints_of(state), atol=1e-6)


@pytest.mark.kernels
@pytest.mark.long
def test_who_is_thought_to_show_their_back_is_turned_when_the_face_is_seen(
    dev_captures: Callable[[str], Path],
) -> None:
    """Somebody before a pair 12 cm apart, whom another tracker hands over the wrong way round."""
    folder = load_folder(dev_captures("stereo_shirt_grab"))
    calibration = from_capture(folder)
    assert calibration.wearer.stature_m is not None
    stature_m = calibration.wearer.stature_m
    tracker, shape = markerless_tracker(calibration), mean_shape(stature_m)
    assert calibration.rig is not None
    body = build_model(stature_m, full_body())
    fitter = Fitter(body, region_labels(body), calibration.rig.cameras, [2, 2], FitParams())
    facing = []
    for k, frames in enumerate(frame_sets(folder)):
        track = tracker.step(frames, shape)
        if track.body.pose is not None:
            chest = rotations.rotate(
                track.body.pose.quats_xyzw[INDEX["upperChest"]], np.array([0.0, 0.0, 1.0])
            )
            facing.append(float(chest[2]))
        if k == 60:
            assert facing[-1] > 0.9
            tracker.reset(near=_turned(track.body, fitter))
        if k == 85:
            break
    assert min(facing) < -0.9
    assert facing[-1] > 0.7


def _turned(body: BodyState, fitter: Fitter) -> BodyState:
    assert body.pose is not None
    model = fitter.model
    local = body.pose.quats_xyzw.copy()
    for joint in range(N_JOINTS - 1, 0, -1):
        parent = int(model.parents[joint])
        local[joint] = rotations.multiply(
            rotations.inverse(body.pose.quats_xyzw[parent]), local[joint]
        )
    state = MotionState(
        body.pose.root_m, local, np.zeros(model.n_pose), np.ones(model.n_shape),
        initial_information(model.space),
    )  # fmt: skip
    joints, quats = fitter.joints(flipped_poses(fitter, state, ALONG)[1])
    return replace(body, pose=Pose(joints[0], quats), joints_m=joints)
