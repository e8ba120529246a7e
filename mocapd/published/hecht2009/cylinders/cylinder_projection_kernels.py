"""Frusta as quadrilaterals in a picture: the simplified projection of [Hecht et al. 2009, figure 2].

The outline of a round part around the axis a b is seen at right angles to the plane through the camera and the axis: its
normal n gives the corners a + r n, b + r n, b - r n, a - r n, which are projected. The long edges are the first to the
second and the fourth to the third. What a round end adds is left out.
"""

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera
from mocapd.published.hecht2009.vector_kernels import Array, cross, dot, over

NEAREST_M = 0.1  # depth of what is drawn at all
# sine of the angle between the rays to both ends, below which the axis has no direction
_ALONG_RAY = 1e-6


@kernel(inline="always")
def to_camera_frame(camera: WorkCamera, point: Array, out: Array) -> None:
    """A world point (3,) in the camera's frame, out (3,) [m]."""
    R, t, _, _, _ = camera
    for i in range(3):
        out[i] = dot(R[i], point) + t[i]


@kernel(inline="always", error_model="numpy")
def pixel_at(
    K: Array, dist: Array, far_r2: float, X: float, Y: float, Z: float
) -> tuple[float, float]:
    """Work pixel of a point before the camera, in the camera's frame [m]."""
    x, y = X / Z, Y / Z
    r2 = x * x + y * y
    # far outside as the point of the same direction at the rim, moved outwards in proportion
    inner, share = r2, 1.0
    if r2 > far_r2:
        inner, share = far_r2, np.sqrt(far_r2 / r2)
    radial = 1.0 + inner * (dist[0] + inner * (dist[1] + inner * dist[4]))
    u = x * radial + share * (2.0 * dist[2] * x * y + dist[3] * (r2 + 2.0 * x * x))
    v = y * radial + share * (dist[2] * (r2 + 2.0 * y * y) + 2.0 * dist[3] * x * y)
    return K[0] * u + K[2], K[1] * v + K[3]


@kernel(error_model="numpy")
def project_frustum(
    camera: WorkCamera, a: Array, b: Array, radius_a: float, radius_b: float, quad: Array
) -> bool:
    """Corners quad (4,2) [work px] of a part between a and b (3,), points of the camera's frame [m]. False: an end is not
    before the camera, and quad is as it was."""
    if a[2] < NEAREST_M or b[2] < NEAREST_M:
        return False
    _, _, K, dist, far_r2 = camera
    n = cross(a, b)
    if np.sqrt(dot(n, n)) < _ALONG_RAY * a[2] * b[2]:
        # the axis runs along the ray: any direction across it will do
        n = (a[2], 0.0, -a[0])
    n = over(n, np.sqrt(dot(n, n)))
    for k in range(4):
        first = k % 3 == 0
        p = a if first else b
        r = radius_a if first else radius_b
        if k > 1:
            r = -r
        quad[k, 0], quad[k, 1] = pixel_at(
            K, dist, far_r2, p[0] + r * n[0], p[1] + r * n[1], p[2] + r * n[2]
        )
    return True


@kernel
def project_parts(
    ends: Array, radii: Array, camera: WorkCamera, quads: Array, depths: Array
) -> None:
    """Parts of one body: ends (C,2,3) [m, world], radii (C,2) of each part's ends [m].

    quads (C,4,2) [work px]; depths (C,2): of each part's ends [m]; quads of what is not before the camera: NaN.
    """
    a, b = np.empty(3), np.empty(3)
    for c in range(ends.shape[0]):
        to_camera_frame(camera, ends[c, 0], a)
        to_camera_frame(camera, ends[c, 1], b)
        depths[c, 0], depths[c, 1] = a[2], b[2]
        if not project_frustum(camera, a, b, radii[c, 0], radii[c, 1], quads[c]):
            quads[c] = np.nan
