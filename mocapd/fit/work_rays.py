"""Where each work pixel looks: lenses are undone once for each camera, not in every frame."""

from functools import lru_cache

import numpy as np

from mocapd.fit.rays_in_other_kernels import taken_at
from mocapd.geometry.camera_model import normalised
from mocapd.types import Camera, Floats, Ints

_CACHE_SIZE = 16  # of cameras and sizes of work pictures
_BEYOND_PX = 3  # a grid's last place may lie beyond the picture


def rays_at(rays: Floats, y: Ints, x: Ints, image_scale: int) -> tuple[Floats, Floats]:
    """Of work pixels (N,): middles (N,2) [px of the pictures as delivered], and directions (N,3) of those of all (h,w,3)."""
    pixels, along = np.empty((len(y), 2)), np.empty((len(y), 3))
    taken_at(y, x, image_scale, rays, pixels, along)
    return pixels, along


@lru_cache(_CACHE_SIZE)
def work_rays_in_world(camera: Camera, image_scale: int) -> Floats:
    """Unit vectors (h,w,3) of all work pixels, in the world; not to be written to."""
    w, h = (side // image_scale + _BEYOND_PX for side in camera.size_px)
    pixels = np.stack(np.meshgrid(np.arange(w), np.arange(h)), axis=2)
    xy = normalised(camera, np.asarray((pixels + 0.5) * image_scale - 0.5, np.float64))
    d = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=2)
    d /= np.linalg.norm(d, axis=2, keepdims=True)
    return np.asarray(d @ camera.R)
