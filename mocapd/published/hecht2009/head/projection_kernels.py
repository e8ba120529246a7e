"""One point through a camera with its lens, for the kernels beside."""

from mocapd.body.arrays import CameraArrays
from mocapd.kernels.decorator import kernel

BEHIND = 1e-3  # depth [m] of what is not before the camera


@kernel(inline="always")
def pixel_of(camera: CameraArrays, X: float, Y: float, Z: float) -> tuple[float, float, float]:
    """x, y [px] and depth [m] of a world point [m]; a depth up to BEHIND: it has no pixel."""
    R, t, K, dist = camera
    z = R[2, 0] * X + R[2, 1] * Y + R[2, 2] * Z + t[2]
    if z <= BEHIND:
        return 0.0, 0.0, z
    x = (R[0, 0] * X + R[0, 1] * Y + R[0, 2] * Z + t[0]) / z
    y = (R[1, 0] * X + R[1, 1] * Y + R[1, 2] * Z + t[1]) / z
    r2 = x * x + y * y
    radial = 1.0 + r2 * (dist[0] + r2 * (dist[1] + r2 * dist[4]))
    u = x * radial + 2.0 * dist[2] * x * y + dist[3] * (r2 + 2.0 * x * x)
    v = y * radial + dist[2] * (r2 + 2.0 * y * y) + 2.0 * dist[3] * x * y
    return K[0, 0] * u + K[0, 2], K[1, 1] * v + K[1, 2], z
