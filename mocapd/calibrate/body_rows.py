"""What one camera's classified picture says of pose, shape and of the camera's own place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import N_POSE, N_SHAPE
from mocapd.body.posing_kernels import joint_shape_derivatives
from mocapd.body.skeleton import N_JOINTS
from mocapd.geometry import rotations
from mocapd.trackers.colour.alignment_kernels import accumulate, spiral
from mocapd.trackers.colour.fitting import Fitter, View
from mocapd.trackers.colour.motion_state import MotionState, moved
from mocapd.trackers.colour.params import Params
from mocapd.types import Camera, Floats

N_CAMERA = 6  # world motion of a camera: v (3,) [m], then omega (3,) [rad]
N_ROW = N_POSE + N_SHAPE


@dataclass(frozen=True, slots=True, eq=False)
class BodyRows:
    """Normal equations H (N_ROW,N_ROW), b (N_ROW,) by pose, then shape; at_m (3,): the hips as drawn;
    camera: its index.

    visible, matched, unexplained (21,) per patch as in `Fit`, in units of two work px; cost: of the
    robust residuals.
    """

    camera: int
    H: Floats
    b: Floats
    at_m: Floats
    visible: Floats
    matched: Floats
    unexplained: Floats
    cost: float

    @property
    def match(self) -> float:
        """Share of the rendered shirt whose colour the picture has."""
        return float(self.matched.sum() / max(self.visible.sum(), 1.0))


class RowGatherer:
    """Draws states into the views of one fitter and gathers their rows; holds buffers only."""

    def __init__(self, fitter: Fitter, radius_px: int) -> None:
        """radius_px: work px within which a colour is looked for."""
        self.fitter = fitter
        self._offsets = spiral(radius_px)
        self._radius_px = float(radius_px)
        self._d_joints = np.zeros((N_SHAPE, N_JOINTS, 3))
        self._params: Params = fitter.params

    def gather(self, state: MotionState, view: View) -> BodyRows:
        """The rows of one camera, at every pixel."""
        fitter, p, m = self.fitter, self._params, self.fitter.model
        drawing = fitter.drawings[view.index]
        root, local = moved(m, state, view.dt_s)
        body = fitter.shaper(state.factors)
        ids, triangle_at = drawing.draw(root, local, body, view.roi)
        joint_shape_derivatives(m.parents, m.d_rest, drawing.R, self._d_joints)
        H, b = np.zeros((N_ROW, N_ROW)), np.zeros(N_ROW)
        visible, matched, unexplained = np.zeros(21), np.zeros(21), np.zeros(21)
        camera, factor = drawing.camera, drawing.factor
        cost = accumulate(
            ids, triangle_at, view.ids, view.softness, self._offsets, len(self._offsets),
            1.0, self._radius_px, 0.6 * self._radius_px, 0, 1, p.edge_stiffness, drawing.xy,
            m.triangles, m.sleeves, m.sleeve_start, m.patch, body.centres, m.d_centres,
            m.triangle_bones, m.triangle_weights, body.rest, m.d_rest, m.parents,
            m.joint_of_group, m.group_of_joint, m.share_of_joint, drawing.R, drawing.joints,
            self._d_joints, N_SHAPE, camera.R, camera.t_m,
            camera.K[0, 0] / factor, camera.K[1, 1] / factor, p.row_weight,
            H, b, visible, matched, unexplained,
        )  # fmt: skip
        at_m = drawing.joints[0].copy()
        return BodyRows(view.index, H, b, at_m, visible, matched, unexplained, cost)


def camera_columns(at_m: Floats) -> Floats:
    """(6,6): a row's derivative by the camera's world motion from that by root and hips.

    Moving the camera is moving the whole body before it: x -> x + omega x x + v. The root's columns
    are g, those of the hips (x - at) x g, so by omega it is x x g = (x - at) x g + at x g.
    """
    x, y, z = at_m
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    out = np.eye(N_CAMERA)
    out[3:, :3] = cross
    return out


def moved_camera(camera: Camera, motion: Floats) -> Camera:
    """The camera after a motion (6,) of the world before it."""
    turn = rotations.to_matrix(rotations.exp(motion[3:]))
    return replace(camera, R=camera.R @ turn, t_m=camera.t_m + camera.R @ motion[:3])


def mean_camera(cameras: Sequence[Camera]) -> Camera:
    """Amid the places (t and R) of a camera that differ little."""
    quats = rotations.from_matrix(np.stack([camera.R for camera in cameras]))
    first = quats[0]
    turns = rotations.log(rotations.multiply(quats, rotations.inverse(first)))
    R = rotations.to_matrix(rotations.multiply(rotations.exp(turns.mean(axis=0)), first))
    t_m = np.mean([camera.t_m for camera in cameras], axis=0)
    return replace(cameras[0], R=R, t_m=t_m)


def shift_px(rows: BodyRows, camera: Camera, factor: int) -> Floats:
    """The way (2,) in work px that this camera alone would move the whole body: what `bump_watch` reads."""
    way_m = np.linalg.solve(rows.H[:3, :3] + 1e-3 * np.eye(3), rows.b[:3])
    depth_m = float(camera.R[2] @ rows.at_m + camera.t_m[2])
    focal_px = np.array([camera.K[0, 0], camera.K[1, 1]]) / factor
    out: Floats = focal_px * (camera.R @ way_m)[:2] / max(depth_m, 0.2)
    return out
