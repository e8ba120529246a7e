"""The square of a picture about a person, scaled to one size for any distance and stature."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Camera, Floats
from mocapd.vision.heatmaps.joint_network import MIDDLE


@dataclass(frozen=True, slots=True, eq=False)
class PersonCrop:
    """A pixel of the crop is scale * a pixel of the picture + corner_px (2,)."""

    scale: float
    corner_px: Floats

    @property
    def affine(self) -> Floats:
        """For cv2.warpAffine (2,3)."""
        x, y = self.corner_px
        return np.array([[self.scale, 0.0, x], [0.0, self.scale, y]])

    def moved(self, way_px: Floats) -> "PersonCrop":
        """About somebody who has moved by way_px (2,) in the picture since."""
        return PersonCrop(self.scale, self.corner_px - self.scale * way_px)


def middle_of(hips_m: Floats, neck_m: Floats) -> Floats:
    """The point of a body (3,) that is in the middle of its crop."""
    out: Floats = hips_m + MIDDLE * (neck_m - hips_m)
    return out


def crop_about(
    camera: Camera, middle_m: Floats, side_m: float, side_px: int, smaller: float = 1.0
) -> PersonCrop:
    """side_px pixels each way that show side_m [m] each way at a point (3,) in the camera's frame, out of a picture that
    is `smaller` times smaller than the camera's. Distortion is left out: a person is seldom near the edge."""
    focal = camera.K[[0, 1], [0, 1]]
    at_px = (middle_m[:2] / middle_m[2] * focal + camera.K[:2, 2] + 0.5) / smaller - 0.5
    scale = side_px / (side_m * focal[0] / smaller / middle_m[2])
    return PersonCrop(scale, side_px / 2 - 0.5 - scale * at_px)
