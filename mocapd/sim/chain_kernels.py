"""Rotations along the chain of bones, and a leg's inverse kinematics."""

import numpy as np
from numba import njit

from mocapd.types import Floats, Ints


@njit(cache=True, nogil=True)
def chain_rotations(parents: Ints, local: Floats, out: Floats) -> None:
    """Global rotations out (J,4) xyzw from those relative to the parent bone (J,4); parents come first."""
    for j in range(len(parents)):
        if parents[j] < 0:
            out[j] = local[j]
            continue
        a, b = out[parents[j]], local[j]
        out[j, 0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1]
        out[j, 1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0]
        out[j, 2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3]
        out[j, 3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]


@njit(cache=True, nogil=True)
def _axes(along: Floats, forward: Floats) -> Floats:
    """Columns x y z of the frame whose y is `along` and whose z is next to `forward`."""
    y = along / np.sqrt(np.dot(along, along))
    z = forward - np.dot(forward, y) * y
    z /= np.sqrt(np.dot(z, z))
    out = np.empty((3, 3))
    out[0, 0], out[1, 0], out[2, 0] = (
        y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0],
    )  # fmt: skip
    out[:, 1], out[:, 2] = y, z
    return out


@njit(cache=True, nogil=True)
def leg_rotations(
    hip_m: Floats, thigh: Floats, shank: Floats, ankle_m: Floats, hips_forward: Floats,
    foot_yaw_rad: float,
) -> Floats:  # fmt: skip
    """Rotations (3,3,3) of upper leg, lower leg and foot that put the ankle at ankle_m (3,).

    thigh and shank (3,) are the bones in the T-pose [m]. The knee bends forwards, half-way between
    where hips and foot point. An ankle out of reach is approached with a straight leg.
    """
    a, b = np.sqrt(np.dot(thigh, thigh)), np.sqrt(np.dot(shank, shank))
    reach = ankle_m - hip_m
    length = np.sqrt(np.dot(reach, reach))
    down = reach / length
    d = min(max(length, 0.3 * (a + b)), 0.9995 * (a + b))
    c, s = np.cos(foot_yaw_rad), np.sin(foot_yaw_rad)
    forward = hips_forward + np.array([s, 0.0, c])
    forward -= np.dot(forward, down) * down
    forward /= np.sqrt(np.dot(forward, forward))
    # law of cosines: the thigh leaves the line hip-ankle by this angle
    cosine = (a * a + d * d - b * b) / (2 * a * d)
    knee = hip_m + a * (cosine * down + np.sqrt(max(1 - cosine * cosine, 0.0)) * forward)
    ahead = np.array([0.0, 0.0, 1.0])
    out = np.empty((3, 3, 3))
    out[0] = _axes(hip_m - knee, forward) @ _axes(-thigh, ahead).T
    out[1] = _axes(knee - hip_m - d * down, forward) @ _axes(-shank, ahead).T
    out[2] = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return out
