"""Pixels of a camera that show the floor about a person, where shadows fall."""

import numpy as np

from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.work_rays import work_rays_in_world
from mocapd.fit.work_size import work_size
from mocapd.geometry.camera_model import centre
from mocapd.tracking.cues.clothes.floor_view_kernels import near_on_floor
from mocapd.types import Bytes, Camera, Floats

_REACH_M = 1.5  # shadows of a lamp at the ceiling are shorter than that; those of low lamps fall on walls, too
_FAR_M = 1e3


class FloorView:
    """Where each work pixel's ray meets the plane y = 0."""

    def __init__(self, camera: Camera, image_scale: int) -> None:
        w, h = work_size(camera, image_scale)
        along = work_rays_in_world(camera, image_scale)[:h, :w].reshape(-1, 3)
        eye = centre(camera)
        down = np.minimum(along[:, 1], -1e-6)
        met = eye + along * (-eye[1] / down)[:, None]
        met[along[:, 1] > -1e-3] = _FAR_M
        self._met_x, self._met_z = (
            np.ascontiguousarray(met[:, i].reshape(h, w), np.float32) for i in (0, 2)
        )

    def near(self, root_m: Floats, roi: Roi) -> Bytes:
        """(h,w) of the region: 1 where an empty room would show the floor about a body with this root (3,)."""
        x0, y0, x1, y1 = roi
        near = np.empty((y1 - y0, x1 - x0), np.uint8)
        near_on_floor(self._met_x, self._met_z, x0, y0, root_m[0], root_m[2], _REACH_M, near)
        return near
