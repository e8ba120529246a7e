"""Synthetic evidence: webcams around a body, and the id maps they would see of a pose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import BodyModel, build_model
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information, predict_pose
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database.key_poses import arm_rotations
from mocapd.types import Camera, Floats
from tests.geometry.rigs import looking_at

STATURE_M = 1.75
MODEL = build_model(STATURE_M)
LABELS = shirt_labels(MODEL)
CAMERAS = tuple(
    looking_at(name, np.array(eye_m), np.array([0.0, 1.1, 0.0]))
    for name, eye_m in (
        ("left", (-1.3, 1.4, 2.3)), ("right", (1.5, 1.3, 2.2)), ("behind", (0.4, 1.7, -2.7)),
    )
)  # fmt: skip
FACTOR = 2  # frames of 640x480 are averaged down to 320x240


def fitter(n_cameras: int, params: FitParams | None = None) -> Fitter:
    cameras = CAMERAS[:n_cameras]
    return Fitter(
        MODEL, LABELS, cameras, [FACTOR] * n_cameras, params if params is not None else FitParams()
    )


def standing(left: str = "goalpost", right: str = "side_low", yaw_rad: float = 0.2) -> MotionState:
    """At rest in the middle; arms are poses of `key_poses`."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw_rad, 0.0]))
    local[INDEX["leftUpperArm"]], local[INDEX["leftLowerArm"]] = arm_rotations(left)
    mirror = np.array([1.0, -1.0, -1.0, 1.0])
    upper, lower = arm_rotations(right)
    local[INDEX["rightUpperArm"]], local[INDEX["rightLowerArm"]] = upper * mirror, lower * mirror
    return MotionState(
        np.array([0.05, 0.98, -0.1]),
        local,
        np.zeros(MODEL.n_pose),
        np.ones(MODEL.n_shape),
        initial_information(MODEL.space),
    )


def apply_step(of: Fitter, state: MotionState, step: Floats) -> MotionState:
    """The state moved by a pose step (n_pose,)."""
    root, local = predict_pose(of.model, replace(state, velocity=step), 1.0)
    return replace(state, root_m=root, local_xyzw=local)


def views_of(
    by: Fitter, state: MotionState, dts_s: Sequence[float] = (0.0, 0.0, 0.0), margin: int = 28
) -> list[View]:
    """What every camera sees of a state, perfectly classified before a known background."""
    out = []
    for i, drawing in enumerate(by.drawings):
        roi = drawing.region(state, dts_s[i], margin)
        assert roi is not None
        ids = drawing.render(state, dts_s[i], roi).copy()
        out.append(View(i, roi, ids, np.full(ids.shape, 255, np.uint8), dts_s[i]))
    return out


def textured_greys(
    model: BodyModel, cameras: Sequence[Camera], state: MotionState
) -> list[NDArray[np.uint8]]:
    """Each camera's picture (480,640) of a body whose brightness follows its surface, triangle by triangle."""
    brightness = np.random.default_rng(2).integers(30, 226, len(model.triangles)).astype(np.uint8)
    greys = []
    for drawing in Fitter(
        model, shirt_labels(model), cameras, [1] * len(cameras), FitParams()
    ).drawings:
        roi = (60, 0, 540, 480)
        drawing.render(state, 0.0, roi)
        at = drawing.last(roi)[1]
        picture = np.full((480, 640), 90, np.uint8)
        picture[:, 60:540] = np.where(at >= 0, brightness[at], 90)
        greys.append(picture)
    return greys
