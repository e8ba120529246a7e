"""A whole pose out of joints that cameras saw: who sits, kneels, lies or shows the back, also before a pair side by side."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.initialisers.keypoint_pose import pose_through, triangulated_joints
from mocapd.types import Camera, Floats
from mocapd.vision.heatmaps.joint_network import JOINTS
from tests.geometry.rigs import looking_at
from tests.tracking.stances.low_stances import STANCES, performed

pytestmark = pytest.mark.kernels

STATURE_M = 1.75
BODY = build_model(STATURE_M, full_body())
SEEN = np.array([INDEX[name] for name in JOINTS])
WIDE = [(-1.5, 1.4, 2.4), (1.6, 1.3, 2.2)]
BESIDE = [(-0.06, 1.3, 3.0), (0.06, 1.3, 3.0)]
OFF_M = np.array([0.25, -0.1, 0.3])  # of the first guess of where the hips are


def seen_by(camera: Camera, joints_m: Floats, without: tuple[str, ...] = ()) -> JointRays:
    """What a network that errs in nothing says of these joints."""
    joints = np.array([j for j in SEEN if j not in [INDEX[name] for name in without]])
    there = to_camera(camera, joints_m)
    information = np.tile([1.0 / 0.05**2, 0.0, 1.0 / 0.05**2], (len(joints), 1))
    return JointRays(
        camera, joints, there[joints, :2] / there[joints, 2:], information, there[joints, 2] - there[0, 2],
        np.full(len(joints), 1.0 / 0.1**2),
    )  # fmt: skip


def rig(places_m: list[tuple[float, float, float]]) -> list[Camera]:
    return [
        looking_at(f"cam{k}", np.array(at_m), np.array([0.3 * at_m[0], 0.8, 0.0]), roll_rad=0.0)
        for k, at_m in enumerate(places_m)
    ]


@pytest.mark.parametrize("stance", ["sits", "kneels", "squats", "lies", "cross_legged", "stands"])
@pytest.mark.parametrize("yaw_deg", [20.0, 180.0])
# side by side, rays as sure as to 5 cm leave open how far away all of the body is
@pytest.mark.parametrize(
    ("places_m", "away_m"), [(WIDE, 0.01), (BESIDE, 0.2)], ids=["wide", "beside"]
)
def test_any_stance_is_found_whichever_way_it_faces(
    stance: str, yaw_deg: float, places_m: list[tuple[float, float, float]], away_m: float
) -> None:
    skeleton = standard_skeleton(STATURE_M)
    joints_m = joint_positions(skeleton, performed(STANCES[stance], yaw_deg)(skeleton)(0.3))
    seen = [seen_by(camera, joints_m) for camera in rig(places_m)]
    there_m = triangulated_joints(seen, joints_m[0] + OFF_M, 0.5)
    off_m = there_m[SEEN] - joints_m[SEEN]
    assert np.linalg.norm(off_m.mean(axis=0)) < away_m
    assert np.linalg.norm(off_m - off_m.mean(axis=0), axis=1).max() < 0.05
    by = Fitter(BODY, shirt_labels(BODY), rig(places_m), [2, 2], FitParams())
    state = pose_through(by, there_m, np.ones(BODY.n_shape), initial_information(BODY.space))
    assert state is not None
    limbs = [j for j in SEEN if j not in (INDEX["head"], INDEX["neck"])]
    posed_m = np.linalg.norm(by.joints(state)[0] - joints_m - off_m.mean(axis=0), axis=1)[limbs]
    assert np.median(posed_m) < 0.05  # a bent trunk is straight in it
    assert posed_m.max() < 0.15


def test_joints_that_only_one_camera_sees_are_placed_and_others_are_not_made_up() -> None:
    skeleton = standard_skeleton(STATURE_M)
    joints_m = joint_positions(skeleton, performed(STANCES["sits"])(skeleton)(0.0))
    left, right = rig(WIDE)
    hidden = ("rightHand", "leftFoot")
    seen = [seen_by(left, joints_m, hidden), seen_by(right, joints_m, hidden[:1])]
    there_m = triangulated_joints(seen, joints_m[0] + OFF_M, 0.5)
    assert np.isnan(there_m[INDEX["rightHand"]]).all()
    foot = INDEX["leftFoot"]
    assert np.linalg.norm(there_m[foot] - joints_m[foot]) < 0.05


def test_without_a_trunk_there_is_no_pose() -> None:
    by = Fitter(BODY, shirt_labels(BODY), rig(WIDE), [2, 2], FitParams())
    nowhere = np.full_like(BODY.rest_m, np.nan)
    known = np.ones(BODY.n_shape), initial_information(BODY.space)
    assert pose_through(by, nowhere, *known) is None
