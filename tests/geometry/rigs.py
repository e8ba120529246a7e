"""Cameras for tests: asymmetric in every respect, so that a swapped axis shows."""

import numpy as np

from mocapd.geometry import rotations
from mocapd.types import Camera, Floats

WEBCAM_DIST = np.array([0.09, -0.23, -0.0015, 0.0008, 0.035])


def looking_at(
    name: str, eye_m: Floats, target_m: Floats, dist: Floats = WEBCAM_DIST, roll_rad: float = 0.05
) -> Camera:
    """A webcam of 640x480 at `eye_m` that has `target_m` in the middle, slightly rolled."""
    z = target_m - eye_m
    z = z / np.linalg.norm(z)
    x = np.cross(z, np.array([0.0, 1.0, 0.0]))
    x = x / np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])  # x right, y down, z forward
    R = rotations.to_matrix(rotations.exp(np.array([0.0, 0.0, roll_rad]))) @ R
    K = np.array([[614.5, 0.0, 316.5], [0.0, 611.2, 234.6], [0.0, 0.0, 1.0]])
    return Camera(name, (640, 480), K, dist, R, -R @ eye_m)


def ring(n: int, radius_m: float = 2.7) -> tuple[Camera, ...]:
    """n webcams around the play area, at different heights."""
    angles = 0.3 + 2.0 * np.pi * np.arange(n) / max(n, 3)
    return tuple(
        looking_at(
            f"cam{i}",
            np.array([radius_m * np.sin(a), 1.2 + 0.3 * i, radius_m * np.cos(a)]),
            np.array([0.05, 1.0, -0.1]),
        )
        for i, a in enumerate(angles)
    )


def points_in_the_play_area(n: int, seed: int = 0) -> Floats:
    """(n,3) [m]: where a person's joints may be, in sight of every camera of `ring`."""
    rng = np.random.default_rng(seed)
    return rng.uniform([-0.5, 0.4, -0.5], [0.5, 1.6, 0.5], (n, 3))
