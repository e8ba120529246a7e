"""The pictures of one instant as input of the head's search and filter."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.body.arrays import CameraArrays
from mocapd.geometry.camera_model import centre, rays
from mocapd.published.hecht2009.head.head_track import HeadPicture
from mocapd.published.hecht2009.head.stereo_distance import StereoView
from mocapd.types import Bytes, Camera, Floats

LEAST_BASELINE_M = 0.01  # cameras that are nearer stand in one place
_UNKNOWN = np.zeros((0, 0), np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class HeadView:
    """A camera's picture: the camera's index, grey for faces and distance, colours, its lateness [s], and foreground
    (h,w), or (0,0) where that is unknown."""

    index: int
    stereo: StereoView
    pixels: Bytes
    offset_s: float
    foreground: Bytes

    @property
    def has_foreground(self) -> bool:
        return self.foreground.size > 0

    @property
    def camera(self) -> Camera:
        return self.stereo.camera

    @property
    def grey(self) -> Bytes:
        return self.stereo.grey


def head_views(
    cameras: Sequence[Camera], arrays: Sequence[CameraArrays], pictures: Sequence[HeadPicture]
) -> list[HeadView]:
    """Of the cameras that have a picture."""
    out = []
    for i, (camera, of, picture) in enumerate(zip(cameras, arrays, pictures, strict=True)):
        if picture.pixels is not None:
            grey = np.asarray(cv2.cvtColor(picture.pixels, cv2.COLOR_BGR2GRAY), np.uint8)
            foreground = _UNKNOWN if picture.foreground is None else picture.foreground
            view = StereoView(camera, of, grey)
            out.append(HeadView(i, view, picture.pixels, picture.offset_s, foreground))
    return out


def ray_through(view: HeadView, xy_px: Floats) -> tuple[Floats, Floats]:
    """The camera's centre (3,) and the unit direction (3,) through a pixel (2,)."""
    return rays(view.camera, xy_px)


def have_baseline(a: Camera, b: Camera) -> bool:
    """Whether two cameras stand in different places."""
    return float(np.linalg.norm(centre(a) - centre(b))) >= LEAST_BASELINE_M
