"""Normal equations of pose, shape and camera pose from one camera's classified picture."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.fit.motion_state import MotionState, predict_pose
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.id_map_kernels import ComparedPictures
from mocapd.fit.terms.id_map_sums import CameraSums, search_within
from mocapd.fit.terms.nearest_pixel_kernels import offsets_by_distance
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import camera_from_world, with_extrinsics
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.geometry.rotations import cross_matrices
from mocapd.types import Bytes, Camera, Floats

_PIXEL_WEIGHT = 255  # of unclassified pixels: less would let the body grow beyond its picture
N_CAMERA = 6  # world motion of a camera: v (3,) [m], then omega (3,) [rad]


@dataclass(frozen=True, slots=True, eq=False)
class BodyRows:
    """Normal equations H (P,P), b (P,) by pose, then shape; at_m (3,): the hips as drawn; camera: its
    index.

    visible, matched (A,) by area as in `Fit`, in units of two work px; cost: of the robust residuals.
    """

    camera: int
    H: Floats
    b: Floats
    at_m: Floats
    visible: Floats
    matched: Floats
    cost: float

    @property
    def match(self) -> float:
        """Share of the rendered pixels whose label the picture has."""
        return float(self.matched.sum() / max(self.visible.sum(), 1.0))


class RowGatherer:
    """Draws states into the views of one fitter and gathers their rows; has only buffers as state."""

    def __init__(self, fitter: Fitter, radius_px: int) -> None:
        """radius_px: search radius for a label, in work px."""
        self.fitter = fitter
        self._search = search_within(
            offsets_by_distance(radius_px), float(radius_px), grid_px=1.0, every=1, phase=0,
            edge_weight=fitter.params.edge_weight,
        )  # fmt: skip

    def gather(self, state: MotionState, view: View) -> BodyRows:
        """The rows of one camera, at every pixel."""
        fitter, model = self.fitter, self.fitter.model
        drawing, body = fitter.drawings[view.index], fitter.shaper(state.factors)
        sums, n_unknown = CameraSums(model, drawing.labels), model.n_pose + model.n_shape
        drawn = drawing.draw(*predict_pose(model, state, view.dt_s), body, view.roi)
        sums.gather(
            ComparedPictures(*drawn, view.ids, view.pixel_weight), self._search, drawing.xy, body.centres, drawing.posed,
            drawing.pinhole, n_unknown, fitter.params.row_weight,
        )  # fmt: skip
        H, b = sums.by_size[n_unknown]
        hips_m, counts = drawing.posed.joints[0].copy(), sums.counts
        return BodyRows(view.index, H, b, hips_m, counts.visible, counts.matched, sums.cost)


def cost_of(rows: Sequence[BodyRows]) -> float:
    """Cost of one instant in all cameras, for each drawn pixel of the shirt."""
    return sum(row.cost for row in rows) / max(sum(float(row.visible.sum()) for row in rows), 1.0)


def least_match_of(rows: Sequence[BodyRows]) -> float:
    """The confirmed share of the drawn shirt, in the camera that confirms least."""
    return min(row.match for row in rows)


def pictured(
    index: int, ids: Bytes, roi_px: tuple[int, int, int, int], image_scale: int, late_s: float
) -> View:
    """The view of a camera's classified picture ids (h,w) over roi_px of its frame, `late_s` after the body's instant."""
    x0, y0, x1, y1 = (edge // image_scale for edge in roi_px)
    return View(index, (x0, y0, x1, y1), ids, np.full(ids.shape, _PIXEL_WEIGHT, np.uint8), late_s)


def camera_columns(at_m: Floats) -> Floats:
    """(6,6): a row's derivative by the camera's world motion from that by root and hips.

    Moving the camera equals moving the whole body before it: x -> x + omega x x + v. The root's columns
    are g, those of the hips (x - at) x g, so by omega it is x x g = (x - at) x g + at x g.
    """
    out = np.eye(N_CAMERA)
    out[3:, :3] = cross_matrices(at_m)
    return out


def move_camera(camera: Camera, motion: Floats) -> Camera:
    """The camera after a motion (6,) of the world before it."""
    world_from_moved = RigidTransform(rotations.to_matrix(rotations.exp(motion[3:])), motion[:3])
    return with_extrinsics(camera, camera_from_world(camera) @ world_from_moved)


def average_cameras(cameras: Sequence[Camera]) -> Camera:
    """The mean (t and R) of similar poses of one camera."""
    quats = rotations.from_matrix(np.stack([camera.R for camera in cameras]))
    first = quats[0]
    turns = rotations.log(rotations.multiply(quats, rotations.inverse(first)))
    R = rotations.to_matrix(rotations.multiply(rotations.exp(turns.mean(axis=0)), first))
    t_m = np.mean([camera.t_m for camera in cameras], axis=0)
    return replace(cameras[0], R=R, t_m=t_m)


def shift_px(rows: BodyRows, camera: Camera, image_scale: int) -> Floats:
    """The shift (2,) in work px of the whole body by this camera alone.

    It shows a rotation of the camera across the plane of both views, and no other one.
    """
    way_m = np.linalg.solve(rows.H[:3, :3] + 1e-3 * np.eye(3), rows.b[:3])
    depth_m = float(camera.R[2] @ rows.at_m + camera.t_m[2])
    focal_px = np.array([camera.K[0, 0], camera.K[1, 1]]) / image_scale
    return focal_px * (camera.R @ way_m)[:2] / max(depth_m, 0.2)
