"""The body model drawn into one camera's work picture, at that camera's own instant."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import PosedJoints, camera_arrays, pinhole_arrays, plain
from mocapd.body.model import BodyModel, Shaped, Shaper
from mocapd.body.posing_kernels import forward_kinematics, skin_and_project
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.motion_state import MotionState, predict_pose
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.fit.work_size import MAX_SIDE_PX, work_size
from mocapd.types import Camera, Floats
from mocapd.vision.raster_kernels import bounds, label_triangles, rasterise

Roi = tuple[int, int, int, int]  # x0, y0, x1, y1 [work px], x1 and y1 excluded
_NEAREST_M = 0.2  # of a vertex that is in view
_MAX_WORK_PX = MAX_SIDE_PX**2


@dataclass(frozen=True, slots=True, eq=False)
class PartialRender:
    """Part of the body drawn in one camera, with the posed joints; triangle_at (h,w): which of the part's, or -1."""

    ids: NDArray[np.uint8]
    triangle_at: NDArray[np.int32]
    zbuffer: NDArray[np.float32]
    posed: PosedJoints


class IdMapRenderer:
    """Draws one body into one camera. Results are in its own buffers, until the next drawing."""

    def __init__(
        self, shaper: Shaper, labels: SurfaceLabels, camera: Camera, image_scale: int
    ) -> None:
        """labels: the ids that are drawn; image_scale: by how much the camera's frames are averaged down to work pictures."""
        self.model: BodyModel = shaper.model
        self.labels = labels
        self.camera, self.image_scale, self._shaper = camera, image_scale, shaper
        self.projection = camera_arrays(camera)
        self._skin, self._projection = plain(self.model.skin), plain(self.projection)
        self.pinhole = pinhole_arrays(self.projection, image_scale)
        self.posed = PosedJoints(
            self.model.rest_m,
            np.zeros((N_JOINTS, 3, 3)),
            np.zeros((N_JOINTS, 3)),
            np.zeros((N_JOINTS, 4)),
        )
        self.xy = np.empty((len(self.model.vertices_m), 2))
        self._depth = np.empty(len(self.model.vertices_m))
        self._zbuffer = np.empty(_MAX_WORK_PX, np.float32)
        self._triangle_at = np.empty(_MAX_WORK_PX, np.int32)
        self._ids = np.empty(_MAX_WORK_PX, np.uint8)
        self.coarse_xy = np.empty_like(self.xy)
        self._coarse_at = np.empty(_MAX_WORK_PX // 2, np.int32)
        self._coarse_ids = np.empty(_MAX_WORK_PX // 2, np.uint8)

    def region(self, state: MotionState, dt_s: float, margin: int) -> Roi | None:
        """The work-picture region around the body as this camera sees it; None when it is not in view."""
        w, h = work_size(self.camera, self.image_scale)
        body = self._shaper(state.factors)
        self._project(*predict_pose(self.model, state, dt_s), body, (0, 0, w, h))
        n_visible, left, top, right, bottom = bounds(self.xy, self._depth, _NEAREST_M)
        if n_visible < max(len(self.xy) // 2, 1):
            return None
        x0, y0 = max(0, int(left) - margin) & ~1, max(0, int(top) - margin) & ~1
        x1, y1 = min(w, int(right) + margin), min(h, int(bottom) + margin)
        return (x0, y0, x1, y1) if x1 - x0 >= 16 and y1 - y0 >= 16 else None

    def render(self, state: MotionState, dt_s: float, roi: Roi) -> NDArray[np.uint8]:
        """The id map (h,w) of the state dt_s after its instant."""
        return self.draw(*predict_pose(self.model, state, dt_s), self._shaper(state.factors), roi)[
            0
        ]

    def render_about(
        self, state: MotionState, dt_s: float, margin: int
    ) -> tuple[Roi, NDArray[np.uint8]] | None:
        """`region` of the body, and its id map (h,w) there."""
        roi = self.region(state, dt_s, margin)
        if roi is None:
            return None
        self.xy -= roi[:2]  # as of the whole picture so far
        ids, triangle_at = self.last(roi)
        self._raster(self.xy, self.model.triangles, self.labels.label, ids, triangle_at)
        return roi, ids

    def last(self, roi: Roi) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        """Id map and triangles (h,w) that were drawn last in this region."""
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        return self._ids[: h * w].reshape(h, w), self._triangle_at[: h * w].reshape(h, w)

    def last_depth_m(self, roi: Roi) -> NDArray[np.float32]:
        """Depths (h,w) of the last drawing in this region, along the camera's axis; far away on the background."""
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        return self._zbuffer[: h * w].reshape(h, w)

    def render_parts(
        self, state: MotionState, dt_s: float, roi: Roi, triangles: NDArray[np.int64]
    ) -> PartialRender:
        """Only these triangles of the body."""
        m = self.model
        self._project(*predict_pose(m, state, dt_s), self._shaper(state.factors), roi)
        ids, triangle_at = self.last(roi)
        zbuffer = self._raster(
            self.xy, m.triangles[triangles], self.labels.label[triangles], ids, triangle_at
        )
        return PartialRender(ids, triangle_at, zbuffer, self.posed)

    def draw(
        self, root_m: Floats, local_xyzw: Floats, body: Shaped, roi: Roi
    ) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        """Id map and triangles (h,w) of a pose of this body."""
        self._project(root_m, local_xyzw, body, roi)
        ids, triangle_at = self.last(roi)
        self._raster(self.xy, self.model.triangles, self.labels.label, ids, triangle_at)
        return ids, triangle_at

    def draw_coarse(
        self, root_m: Floats, local_xyzw: Floats, body: Shaped, roi: Roi
    ) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        """As `draw`, at every second pixel each way: (h+1)//2, (w+1)//2."""
        self._project(root_m, local_xyzw, body, roi)
        np.multiply(self.xy, 0.5, out=self.coarse_xy)
        h, w = (roi[3] - roi[1] + 1) // 2, (roi[2] - roi[0] + 1) // 2
        ids = self._coarse_ids[: h * w].reshape(h, w)
        triangle_at = self._coarse_at[: h * w].reshape(h, w)
        self._raster(self.coarse_xy, self.model.triangles, self.labels.label, ids, triangle_at)
        return ids, triangle_at

    def last_coarse(self, roi: Roi) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        """Every second pixel of what `draw` drew last in this region."""
        ids, triangle_at = self.last(roi)
        np.multiply(self.xy, 0.5, out=self.coarse_xy)
        return np.ascontiguousarray(ids[::2, ::2]), np.ascontiguousarray(triangle_at[::2, ::2])

    def pose(self, root_m: Floats, local_xyzw: Floats, rest: Floats) -> None:
        """Pose the joints (`posed`) without drawing."""
        if self.posed.rest is not rest:
            self.posed = self.posed._replace(rest=rest)
        _, R, joints, quats = self.posed
        forward_kinematics(self.model.parents, rest, root_m, local_xyzw, R, joints, quats)

    def _raster(
        self,
        xy: Floats,
        triangles: NDArray[np.int32],
        label: NDArray[np.uint8],
        ids: NDArray[np.uint8],
        triangle_at: NDArray[np.int32],
    ) -> NDArray[np.float32]:
        """Fill ids and triangle_at (h,w) with the projected vertices; returns their depths (h,w) [m]."""
        zbuffer = self._zbuffer[: ids.size].reshape(ids.shape)
        rasterise(xy, self._depth, triangles, zbuffer, triangle_at)
        label_triangles(triangle_at, label, ids)
        return zbuffer

    def _project(self, root_m: Floats, local_xyzw: Floats, body: Shaped, roi: Roi) -> None:
        image_scale = self.image_scale
        # in two calls: within one compiled function the second would be rounded otherwise, depending on
        # what the cache of compiled code holds
        self.pose(root_m, local_xyzw, body.rest)
        skin_and_project(
            body.vertices, self._skin, plain(self.posed), self._projection,
            np.array([float(roi[0] * image_scale), float(roi[1] * image_scale)]), 1.0 / image_scale,
            self.xy, self._depth,
        )  # fmt: skip
