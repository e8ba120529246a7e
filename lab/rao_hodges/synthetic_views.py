"""Four cameras around a limb chain, and its exact silhouettes: what figure 4 of Rao and Hodges compares points with."""

from collections.abc import Sequence

import numpy as np

from mocapd.geometry.camera_model import rays
from mocapd.published.rao_hodges.limb_chain import LimbChain
from mocapd.published.rao_hodges.limb_weight import PosedChain
from mocapd.types import Bytes, Camera, Floats

_SIZE_PX = (160, 120)
_FOCAL_PX = 150.0
_AWAY_M = 2.5
_BELOW_M = 0.4  # of the root: the middle of the legs


def cameras_around(root_m: Floats) -> list[Camera]:
    """In front, left, behind and right of a root (3,) [m], at the height of the middle of the legs."""
    middle = root_m - np.array([0.0, _BELOW_M, 0.0])
    out = []
    for name, angle in (("front", 0.0), ("left", 0.5), ("behind", 1.0), ("right", 1.5)):
        away = np.array([np.sin(np.pi * angle), 0.0, np.cos(np.pi * angle)])
        down = np.array([0.0, -1.0, 0.0])
        R = np.stack([np.cross(down, -away), down, -away])
        K = np.array([[_FOCAL_PX, 0.0, 79.5], [0.0, _FOCAL_PX, 59.5], [0.0, 0.0, 1.0]])
        eye = middle + _AWAY_M * away
        out.append(Camera(name, _SIZE_PX, K, np.zeros(5), R, -R @ eye))
    return out


def silhouettes_of(chain: LimbChain, pose: PosedChain, cameras: Sequence[Camera]) -> list[Bytes]:
    """(h,w) of each camera: 255 where the ray of a pixel meets an ellipsoid of the first particle."""
    w, h = _SIZE_PX
    pixels = np.stack(np.meshgrid(np.arange(w), np.arange(h)), axis=-1).reshape(-1, 2).astype(float)
    a, out = chain.arrays, []
    for camera in cameras:
        eye, ways = rays(camera, pixels)
        met = np.zeros(len(ways), dtype=bool)
        for R, joint, centre, radii in zip(
            pose.R[0], pose.joints_m[0], a.centres_m, a.radii_m, strict=True
        ):
            # in the frame where the ellipsoid is the unit ball
            origin = (R.T @ (eye - joint) - centre) / radii
            way = ways @ (R / radii)
            along, length2 = way @ origin, (way * way).sum(axis=1)
            met |= along**2 >= length2 * (origin @ origin - 1.0)
        out.append(np.where(met, 255, 0).astype(np.uint8).reshape(h, w))
    return out
