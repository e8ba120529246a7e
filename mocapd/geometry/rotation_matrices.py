"""Rotation matrices, SO(3): exponential, its left Jacobian, cross products; batched over leading axes."""

import numpy as np

from mocapd.types import Floats

_NEAR_ZERO_RAD = 1e-6  # where the series are exact to rounding
_NEAR_ZERO_JACOBIAN_RAD = 1e-4


def cross_matrices(v: Floats) -> Floats:
    """(...,3) to (...,3,3): [v]x u = v x u."""
    out = np.zeros((*v.shape[:-1], 3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return out


def exp_matrices(rotvec_rad: Floats) -> Floats:
    """Rotation vectors (...,3) [rad] to matrices (...,3,3) (Rodrigues)."""
    angle = np.linalg.norm(rotvec_rad, axis=-1)[..., None, None]
    K = cross_matrices(rotvec_rad)
    small = angle < _NEAR_ZERO_RAD
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 1.0, np.sin(safe) / safe)
    b = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    R: Floats = np.eye(3) + a * K + b * (K @ K)
    return R


def left_jacobians(rotvec_rad: Floats) -> Floats:
    """(...,3,3): d exp(w) = [J dw]x exp(w) (Barfoot, State Estimation for Robotics, eq. 7.77)."""
    angle = np.linalg.norm(rotvec_rad, axis=-1)[..., None, None]
    K = cross_matrices(rotvec_rad)
    small = angle < _NEAR_ZERO_JACOBIAN_RAD
    safe = np.where(small, 1.0, angle)
    b = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    c = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    J: Floats = np.eye(3) + b * K + c * (K @ K)
    return J
