"""Cameras around a place, and exact silhouettes of ellipsoids there."""

import numpy as np

from mocapd.geometry.camera_model import rays
from mocapd.types import Bytes, Camera, Floats

SIZE_PX = (320, 240)


def ring(n: int, radius_m: float = 3.0, size_px: tuple[int, int] = SIZE_PX) -> list[Camera]:
    """n cameras with distorting lenses that look at (0, 0.9, 0)."""
    out = []
    for k in range(n):
        angle = 0.3 + 2.0 * np.pi * k / n
        eye = np.array([radius_m * np.sin(angle), 1.2 + 0.3 * (k % 2), radius_m * np.cos(angle)])
        ahead = np.array([0.0, 0.9, 0.0]) - eye
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, [0.0, 1.0, 0.0])
        right /= np.linalg.norm(right)
        R = np.stack([right, np.cross(ahead, right), ahead])
        focal = 0.9 * size_px[0]
        K = np.array(
            [[focal, 0, size_px[0] / 2 - 3.0], [0, focal, size_px[1] / 2 + 2.0], [0, 0, 1]]
        )
        dist = np.array([-0.15, 0.05, 0.002, -0.001, 0.0])
        out.append(Camera(f"cam{k}", size_px, K, dist, R, -R @ eye))
    return out


def crossings_m(eye_m: Floats, ways: Floats, centre_m: Floats, radii_m: Floats) -> Floats:
    """Where (N,2) rays enter and leave an ellipsoid along the axes [m]; NaN where they miss it."""
    a, d = (eye_m - centre_m) / radii_m, ways / radii_m
    dd, ad, aa = (d * d).sum(axis=-1), (a * d).sum(axis=-1), (a * a).sum(axis=-1)
    under = ad * ad - dd * (aa - 1.0)
    root = np.sqrt(np.where(under >= 0.0, under, np.nan))
    return np.stack([(-ad - root) / dd, (-ad + root) / dd], axis=-1)


def silhouette(
    camera: Camera, ellipsoids: list[tuple[Floats, Floats]], size_px: tuple[int, int] | None = None
) -> Bytes:
    """(h,w) uint8 of centres and radii [m]: 255 where the ray of a pixel's centre meets one."""
    w, h = size_px or camera.size_px
    scale = np.array(camera.size_px) / (w, h)
    rows, columns = np.indices((h, w))
    xy = (np.stack([columns, rows], axis=-1).reshape(-1, 2) + 0.5) * scale - 0.5
    eye, ways = rays(camera, xy)
    hit = np.zeros(h * w, dtype=bool)
    for centre, radii in ellipsoids:
        hit |= np.isfinite(crossings_m(eye, ways, centre, radii)[:, 0])
    return np.where(hit, 255, 0).astype(np.uint8).reshape(h, w)


# a trunk and two legs apart: rays cross them in several intervals
FIGURE = [
    (np.array([0.0, 1.15, 0.0]), np.array([0.2, 0.35, 0.13])),
    (np.array([0.18, 0.45, 0.02]), np.array([0.08, 0.42, 0.09])),
    (np.array([-0.2, 0.45, -0.05]), np.array([0.08, 0.42, 0.09])),
]
BOX_M = np.array([[-0.8, 0.0, -0.8], [0.8, 1.8, 0.8]])


def inside_figure(points_m: Floats) -> np.ndarray:
    """(P,) whether points (P,3) are in an ellipsoid of FIGURE."""
    hit = np.zeros(len(points_m), dtype=bool)
    for centre, radii in FIGURE:
        hit |= (((points_m - centre) / radii) ** 2).sum(axis=-1) <= 1.0
    return hit
