"""A leg's inverse kinematics.

Plain numpy: it is called four times a picture, and numba would take six seconds to compile it.
"""

import math

import numpy as np

from mocapd.types import Floats


def leg_rotations(
    hip_m: Floats, thigh: Floats, shank: Floats, ankle_m: Floats, hips_forward: Floats,
    foot_yaw_rad: float,
) -> Floats:  # fmt: skip
    """Rotations (3,3,3) of upper leg, lower leg and foot that put the ankle at ankle_m (3,).

    thigh and shank (3,) are the bones in the T-pose [m]. The knee bends forwards, half-way between
    where hips and foot point. An ankle out of reach is approached with a straight leg.
    """
    a, b = math.sqrt(thigh @ thigh), math.sqrt(shank @ shank)
    reach = ankle_m - hip_m
    length = math.sqrt(reach @ reach)
    down = reach / length
    d = min(max(length, 0.3 * (a + b)), 0.9995 * (a + b))
    c, s = math.cos(foot_yaw_rad), math.sin(foot_yaw_rad)
    forward = hips_forward + np.array([s, 0.0, c])
    forward -= (forward @ down) * down
    forward /= math.sqrt(forward @ forward)
    # law of cosines: the thigh leaves the line hip-ankle by this angle
    cosine = (a * a + d * d - b * b) / (2 * a * d)
    knee = hip_m + a * (cosine * down + math.sqrt(max(1 - cosine * cosine, 0.0)) * forward)
    ahead = np.array([0.0, 0.0, 1.0])
    upper = _axes(hip_m - knee, forward) @ _axes(-thigh, ahead).T
    lower = _axes(knee - hip_m - d * down, forward) @ _axes(-shank, ahead).T
    foot = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.stack([upper, lower, foot])


def _axes(along: Floats, forward: Floats) -> Floats:
    """Columns x y z of a frame with y along `along` and z nearest to `forward`."""
    y = along / math.sqrt(along @ along)
    z = forward - (forward @ y) * y
    z /= math.sqrt(z @ z)
    (y0, y1, y2), (z0, z1, z2) = y.tolist(), z.tolist()
    return np.array(
        [
            [y1 * z2 - y2 * z1, y0, z0],
            [y2 * z0 - y0 * z2, y1, z1],
            [y0 * z1 - y1 * z0, y2, z2],
        ]
    )
