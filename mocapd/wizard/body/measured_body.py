"""Draws the measured body over a picture of the measurement."""

import cv2
import numpy as np

from mocapd.body.model import BodyModel, Shaper, shape_of
from mocapd.body.shape import skeleton_of
from mocapd.body.skeleton import global_from_local, joint_positions
from mocapd.calibrate.body_shape.body_shape_fit import BodyObservation
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.motion_state import MotionState, predict_pose
from mocapd.fit.work_size import image_scales
from mocapd.geometry.camera_model import project
from mocapd.shirt.garment import shirt_labels
from mocapd.types import Bytes, Camera, Pose, Skeleton

_OUTLINE_BGR, _BONE_BGR, _UNDER_BGR = (138, 240, 93), (255, 216, 79), (0, 0, 0)
_LEG_ENDS = ("Leg", "Foot", "Toes")  # the shirt's body has none: they are a guess from the stature


def measured_bones(skeleton: Skeleton) -> list[tuple[int, int]]:
    """Joints at the ends, parent first, of the bones that the shirt measures."""
    return [
        (parent, child)
        for child, parent in enumerate(skeleton.parents.tolist())
        if parent >= 0 and not skeleton.names[child].endswith(_LEG_ENDS)
    ]


def body_picture(
    pixels: Bytes,
    camera: Camera,
    model: BodyModel,
    state: MotionState,
    observation: BodyObservation,
    index: int,
) -> Bytes:
    """The picture (h,w,3) BGR with outlines of the shirt's patches and the bones that it measures, as the body in `state`
    has them at this camera's own instant. index: of the camera in the observation's views."""
    out = pixels.copy()
    view = next((view for view in observation.views if view.index == index), None)
    if view is None:
        return out
    image_scale = image_scales([camera], FitParams().work_width_px)[0]
    drawing = IdMapRenderer(Shaper(model), shirt_labels(model), camera, image_scale)
    ids = drawing.render(state, view.dt_s, view.roi)
    at = np.array([view.roi[0], view.roi[1]])
    for colour in range(1, int(ids.max(initial=0)) + 1):
        lines, _ = cv2.findContours(
            (ids == colour).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE
        )
        corners = [
            ((line + at) * image_scale + image_scale // 2).astype(np.int32) for line in lines
        ]
        cv2.polylines(out, corners, True, _OUTLINE_BGR, 1, cv2.LINE_AA)
    skeleton = skeleton_of(shape_of(model, state.factors))
    root, local = predict_pose(model, state, view.dt_s)
    joints = joint_positions(skeleton, Pose(root, global_from_local(skeleton, local)))
    at_px = np.rint(project(camera, joints))
    for colour_bgr, width in ((_UNDER_BGR, 5), (_BONE_BGR, 2)):
        for bone in measured_bones(skeleton):
            ends = at_px[list(bone)]
            if np.isfinite(ends).all() and (np.abs(ends) < 1e4).all():
                a, b = ends.astype(int).tolist()
                cv2.line(out, a, b, colour_bgr, width, cv2.LINE_AA)
    return out
