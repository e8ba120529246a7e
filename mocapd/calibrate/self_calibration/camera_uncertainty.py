"""The uncertainty of a camera's extrinsics, in degrees and in parts of its distance."""

from dataclasses import dataclass

import numpy as np

from mocapd.geometry.camera_model import centre
from mocapd.types import Camera, Floats


@dataclass(frozen=True, slots=True)
class CameraUncertainty:
    """Standard deviations of the camera's rotation [degrees] and of its distance from the first [%].

    They cover chance and the variation between people; with real bodies in real cloth the errors were up
    to three times as large (docs/decisions/calibration.md).
    """

    rotation_deg: float
    distance_percent: float


def uncertainty_of(camera: Camera, first_m: Floats, covariance: Floats) -> CameraUncertainty:
    """From the covariance (6,6) of the motion (v, omega) of the world before the camera.

    first_m (3,): centre of the camera that stays. By the motion the camera goes by -v - omega x c.
    """
    at_m = centre(camera)
    away = at_m - first_m
    length_m = float(np.linalg.norm(away))
    by_motion = np.concatenate([-away, -np.cross(at_m, away)]) / length_m
    return CameraUncertainty(
        float(np.degrees(np.sqrt(np.trace(covariance[3:, 3:])))),
        100.0 * float(np.sqrt(by_motion @ covariance @ by_motion)) / length_m,
    )
