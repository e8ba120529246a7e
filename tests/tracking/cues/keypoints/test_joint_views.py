"""What cameras see of a person's joints: near the true ones, and told as rays."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, local_from_global
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry.camera_model import project, to_camera
from mocapd.geometry.rotations import rotate
from mocapd.shirt.garment import shirt_labels
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.world import World, rig_of
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams, KeypointDetectionParams
from mocapd.tracking.cues.keypoints.keypoint_detection import (
    KeypointDetectors,
)
from mocapd.vision.heatmaps.joint_network import (
    CELLS,
    INPUT_PX,
    JOINTS,
    MARKS,
    SIDE_M,
    STATURE_M,
    DetectedJoints,
    JointNetwork,
)
from mocapd.vision.heatmaps.person_crop import crop_about, middle_of
from tests.fit.term_system import BODY
from tests.fit.test_joint_term import CROSSING
from tests.fit.test_pose_terms import ROOT, relaxed
from tests.sim import small

pytestmark = pytest.mark.kernels


def test_joints_of_somebody_are_seen_where_they_are() -> None:
    table = small.table()
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
    for light in table["lights"]:
        light["events"] = []
    table["motion"] = {
        "keyframes": [{"t_s": 0.0, "pose": "goalpost", "at_m": [0.1, 0.1], "yaw_deg": 10.0}]
    }
    table["clothes"] = {"shirt": "plain", "top_srgb": [150, 60, 60]}
    table["body"] = {"whole": True}
    scenario = small.scenario(**table)
    world, rig = World(scenario), rig_of(scenario)
    renderers = camera_renderers(world)
    body = build_model(world.shape.stature_m, full_body())
    fitter = Fitter(body, shirt_labels(body), rig.cameras, [1] * len(rig.cameras), FitParams())
    cameras = CameraViews(fitter, ClothesParams())
    cameras.reset()
    levels = np.ones(len(table["lights"]))
    for k in range(22):
        pictures = [r.picture(None, levels, k) for r in renderers]
        cameras.take(dict(enumerate(pictures)), dict.fromkeys(range(len(pictures)), 0.0))
        cameras.mark_body(None)
        cameras.learn(None, [])
    pictures = [r.frame(0) for r in renderers]
    cameras.take(dict(enumerate(pictures)), dict.fromkeys(range(len(pictures)), 0.0))
    truth = world.at(renderers[0].exposure_s(0))
    state = MotionState(
        truth.pose.root_m + [0.06, 0.0, -0.05], local_from_global(world.skeleton, truth.pose.quats_xyzw),
        np.zeros(body.n_pose), np.ones(body.n_shape), initial_information(body.space),
    )  # fmt: skip
    (term,) = _looked(ClothesParams().joints, fitter, state, cameras)
    assert len(term.rays) == len(rig.cameras)
    off_cm = []
    for one in term.rays:
        there = to_camera(one.camera, truth.joints_m)
        z = there[one.joints, 2]
        off_cm.append(100.0 * np.linalg.norm(one.xy * z[:, None] - there[one.joints, :2], axis=1))
        assert {INDEX["head"], INDEX["hips"], INDEX["leftHand"]} <= set(one.joints.tolist())
    assert np.median(np.concatenate(off_cm)) < 5.0
    assert np.percentile(np.concatenate(off_cm), 90) < 15.0
    unheeded = replace(
        ClothesParams().joints, term=replace(ClothesParams().joints.term, weight=0.0)
    )
    assert _looked(unheeded, fitter, state, cameras) == ()


def test_rays_go_through_the_joints_and_not_through_what_the_network_marks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The network marks hands short of the wrist, and trunk and head in front of their joints: `MARKS`."""
    camera = CROSSING[0]
    fitter = Fitter(BODY, shirt_labels(BODY), CROSSING[:1], [1], FitParams())
    turned = relaxed()
    turned[0] = (0.0, np.sin(0.5), 0.0, np.cos(0.5))  # about the vertical: not as in the T-pose
    state = MotionState(
        ROOT, turned, np.zeros(BODY.n_pose), np.ones(BODY.n_shape), initial_information(BODY.space)
    )
    joints_m, quats = fitter.joints(state)
    mine = np.array([INDEX[name] for name in JOINTS])
    size = BODY.stature_m / STATURE_M
    marked_m = joints_m[mine] + BODY.stature_m * rotate(quats[mine], MARKS)
    there = to_camera(camera, joints_m)
    hips, neck = there[INDEX["hips"]], there[INDEX["neck"]]
    crop = crop_about(camera, middle_of(hips, neck), SIDE_M * size, INPUT_PX)
    cell_px = INPUT_PX / CELLS
    at_cells = (
        project(camera, marked_m) * crop.scale + crop.corner_px - (cell_px / 2 - 0.5)
    ) / cell_px
    deep = to_camera(camera, marked_m)[:, 2]
    n = len(JOINTS)
    seen = DetectedJoints(
        at_cells, np.tile([0.7, 0.0, 0.7], (n, 1)), (deep - deep[JOINTS.index("hips")]) / size, np.full(n, 0.05),
        np.zeros((INPUT_PX, INPUT_PX), np.float32),
    )  # fmt: skip
    monkeypatch.setattr(JointNetwork, "detect", lambda *_: seen)
    cameras = CameraViews(fitter, ClothesParams())
    cameras.reset()
    w, h = camera.size_px
    cameras.take({0: np.zeros((h, w, 3), np.uint8)}, {0: 0.0})
    (term,) = _looked(ClothesParams().joints, fitter, state, cameras)
    (rays,) = term.rays
    assert len(rays.joints) > 12
    z = there[rays.joints, 2]
    beside_m = np.linalg.norm(rays.xy * z[:, None] - there[rays.joints, :2], axis=1)
    assert (
        beside_m.max() < 0.006
    )  # marks lie up to 3 cm beside; they are moved as at the body's middle
    assert np.abs(rays.farther_m - (z - hips[2])).max() < 0.006


def _looked(
    params: KeypointDetectionParams, fitter: Fitter, state: MotionState, cameras: CameraViews
) -> tuple[JointTerm, ...]:
    joints = KeypointDetectors(len(cameras.each), fitter.model.stature_m, params)
    return joints.term(fitter.model, map(joints.detector(fitter, state, cameras), cameras.present))
