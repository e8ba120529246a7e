"""A nominal pose for one uncalibrated camera, so that a user can try it at once."""

import numpy as np

from mocapd.types import Camera, Rig

FIELD_OF_VIEW_DEG = 60.0  # across the longer side; what most webcams have is 50 to 80
HEIGHT_M = 1.2
DISTANCE_M = 2.5


def nominal_rig(name: str, size_px: tuple[int, int]) -> Rig:
    """One camera in front of the play area: it looks along -Z at a person who faces +Z.

    Directions are nearly right; sizes and distances are only as right as the guess.
    """
    width, height = size_px
    focal_px = 0.5 * max(size_px) / np.tan(0.5 * np.deg2rad(FIELD_OF_VIEW_DEG))
    K = np.array(
        [
            [focal_px, 0.0, 0.5 * (width - 1)],
            [0.0, focal_px, 0.5 * (height - 1)],
            [0.0, 0.0, 1.0],
        ]
    )
    R = np.diag([1.0, -1.0, -1.0])  # x stays right, y points down, z into the scene
    position_m = np.array([0.0, HEIGHT_M, DISTANCE_M])
    return Rig((Camera(name, size_px, K, np.zeros(5), R, -R @ position_m),))
