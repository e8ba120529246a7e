"""A camera as the cylinders are drawn into its work picture, lens and all.

Points are distorted, pictures are not undistorted. A limb has eight corners but a picture 76800 pixels; the pictures stay
those that other trackers share; and nothing is blurred a second time. Between corners a drawn edge is straight where the
lens' is bowed: by 0.3 work pixels on a forearm near the border for k1 = -0.06 (webcams), by 1.2 for k1 = -0.3, less
than the blur of the edge image.
"""

from typing import NamedTuple

import numpy as np

from mocapd.geometry.camera_model import normalised
from mocapd.types import Camera, Floats

_BEYOND = 1.15  # by how much farther than the farthest corner the lens' polynomial is believed


class WorkCamera(NamedTuple):
    """camera_from_world R (3,3), t (3,) [m]; K (4,) fx fy cx cy of the work picture [px]; dist (5,); far_r2: squared
    normalised radius beyond which the distortion stays what it is there, as the polynomial may turn back."""

    R: Floats
    t: Floats
    K: Floats
    dist: Floats
    far_r2: float


def work_camera(camera: Camera, work_size_px: tuple[int, int]) -> WorkCamera:
    """Of pictures averaged down to work_size_px (width, height), pixel centres at integers in both."""
    (width, height), (w, h) = camera.size_px, work_size_px
    sx, sy = w / width, h / height
    K = np.array([
        camera.K[0, 0] * sx, camera.K[1, 1] * sy,
        (camera.K[0, 2] + 0.5) * sx - 0.5, (camera.K[1, 2] + 0.5) * sy - 0.5,
    ])  # fmt: skip
    x, y = width - 0.5, height - 0.5
    corners = normalised(camera, np.array([[-0.5, -0.5], [x, -0.5], [-0.5, y], [x, y]]))
    far_r2 = min(_BEYOND**2 * float((corners**2).sum(axis=1).max()), _turning_r2(camera.dist))
    R, t, dist = (
        np.array(a, dtype=np.float64, order="C") for a in (camera.R, camera.t_m, camera.dist)
    )
    return WorkCamera(R, t, K, dist, far_r2)


def _turning_r2(dist: Floats) -> float:
    """The least squared radius at which the radial polynomial r (1 + k1 r^2 + k2 r^4 + k3 r^6) stops rising, or inf."""
    k1, k2, _, _, k3 = dist
    roots = np.roots([7.0 * k3, 5.0 * k2, 3.0 * k1, 1.0])
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0)]
    return float(real.min()) if len(real) else np.inf
