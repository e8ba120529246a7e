"""Where each work pixel looks: lenses are undone once for each camera, not in every frame."""

from functools import lru_cache

import numpy as np

from mocapd.geometry.camera_model import normalised
from mocapd.types import Camera, Floats, Ints

_KEPT = 16  # of cameras and sizes of work pictures
_BEYOND_PX = 3  # a grid's last place may lie beyond the picture


def pixels_as_delivered(y: Ints, x: Ints, image_scale: int) -> Floats:
    """Middles (N,2) [px of the pictures as delivered] of work pixels (N,)."""
    return np.asarray((np.stack([x, y], axis=1) + 0.5) * image_scale - 0.5, np.float64)


@lru_cache(_KEPT)
def work_rays(camera: Camera, image_scale: int) -> Floats:
    """Unit vectors (h,w,3) of all work pixels, in the camera's frame; not to be written to."""
    w, h = (side // image_scale + _BEYOND_PX for side in camera.size_px)
    pixels = np.stack(np.meshgrid(np.arange(w), np.arange(h)), axis=2)
    xy = normalised(camera, np.asarray((pixels + 0.5) * image_scale - 0.5, np.float64))
    d = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=2)
    out: Floats = d / np.linalg.norm(d, axis=2, keepdims=True)
    return out


@lru_cache(_KEPT)
def work_rays_in_world(camera: Camera, image_scale: int) -> Floats:
    """The same (h,w,3) in the world."""
    return np.asarray(work_rays(camera, image_scale) @ camera.R)
