"""The head as a ball on its joint, in shares of the stature."""

from dataclasses import dataclass

import numpy as np

from mocapd.geometry.camera_model import project, to_camera
from mocapd.published.hecht2009.head.head_colours import HeadEllipse
from mocapd.types import Camera, Floats

# A head is 0.130 of the stature high (Drillis and Contini 1966).
HALF_WIDTH = 0.048
HALF_HEIGHT = 0.066
HALF_LENGTH = 0.058


@dataclass(frozen=True, slots=True)
class HeadSize:
    """Half the width, height and length of a head [m]."""

    width_m: float
    height_m: float
    length_m: float


def head_size(stature_m: float) -> HeadSize:
    """Of a grown person."""
    return HeadSize(HALF_WIDTH * stature_m, HALF_HEIGHT * stature_m, HALF_LENGTH * stature_m)


def ellipse_of(camera: Camera, middle_m: Floats, size: HeadSize) -> HeadEllipse | None:
    """The outline of an upright head in a camera's picture; None behind the camera."""
    depth_m = float(to_camera(camera, middle_m)[2])
    if depth_m <= size.length_m:
        return None
    xy = project(camera, np.stack([middle_m, middle_m + (0.0, size.height_m, 0.0)]))
    if not np.isfinite(xy).all():
        return None
    up = xy[1] - xy[0]
    height_px = float(np.linalg.norm(up))
    width_px = float(camera.K[0, 0]) * size.width_m / depth_m
    # a camera above or below sees the head's length in the place of its height
    length_px = float(camera.K[1, 1]) * size.length_m / depth_m
    up = up / height_px if height_px > 1e-6 else np.array([0.0, -1.0])
    return HeadEllipse(
        np.array([*xy[0].tolist(), width_px, max(height_px, length_px)]), np.ascontiguousarray(up)
    )
