"""Rotations as quaternions xyzw with w >= 0, rotation vectors and matrices; all batched over leading axes."""

import numpy as np

from mocapd.types import Floats

IDENTITY_XYZW = np.array([0.0, 0.0, 0.0, 1.0])


def canonical(q_xyzw: Floats) -> Floats:
    """The same rotations (...,4) with unit norm and w >= 0."""
    q: Floats = q_xyzw / np.linalg.norm(q_xyzw, axis=-1, keepdims=True)
    return q * np.where(q[..., 3:] < 0.0, -1.0, 1.0)


def multiply(a_xyzw: Floats, b_xyzw: Floats) -> Floats:
    """Hamilton product (...,4): first b, then a."""
    ax, ay, az, aw = np.moveaxis(np.asarray(a_xyzw), -1, 0)
    bx, by, bz, bw = np.moveaxis(np.asarray(b_xyzw), -1, 0)
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )


def inverse(q_xyzw: Floats) -> Floats:
    """Conjugate of unit quaternions (...,4)."""
    conjugate: Floats = np.asarray(q_xyzw) * np.array([-1.0, -1.0, -1.0, 1.0])
    return conjugate


def rotate(q_xyzw: Floats, v: Floats) -> Floats:
    """Vectors v (...,3) turned by q (...,4)."""
    u, w = q_xyzw[..., :3], q_xyzw[..., 3:]
    t = 2.0 * _cross(u, v)
    return v + w * t + _cross(u, t)


def _cross(a: Floats, b: Floats) -> Floats:
    """np.cross for (...,3), without its overhead, which is several times this at 22 bones."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def exp(rotvec_rad: Floats) -> Floats:
    """Rotation vectors (...,3) [rad] to quaternions (...,4); exact to rounding near zero."""
    r = np.asarray(rotvec_rad, dtype=float)
    angle = np.linalg.norm(r, axis=-1, keepdims=True)
    half = 0.5 * angle
    # sin(a/2)/a by its series where the quotient would lose digits
    small = angle < 1e-4
    scale = np.where(small, 0.5 - angle**2 / 48.0, np.sin(half) / np.where(small, 1.0, angle))
    return canonical(np.concatenate([r * scale, np.cos(half)], axis=-1))


def log(q_xyzw: Floats) -> Floats:
    """Quaternions (...,4) to rotation vectors (...,3) [rad], angle in [0, pi]."""
    q = canonical(q_xyzw)
    s = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    small = s < 1e-8  # below, the quotient is 2/w to rounding, and s may have underflowed
    scale = np.where(
        small,
        2.0 / q[..., 3:].clip(1e-9),
        2.0 * np.arctan2(s, q[..., 3:]) / np.where(small, 1.0, s),
    )
    return q[..., :3] * scale


def to_matrix(q_xyzw: Floats) -> Floats:
    """Quaternions (...,4) to matrices (...,3,3)."""
    x, y, z, w = np.moveaxis(np.asarray(q_xyzw, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def from_matrix(R: Floats) -> Floats:
    """Rotation matrices (...,3,3) to quaternions (...,4), by the largest of the four squared components."""
    R = np.asarray(R, dtype=float)
    m00, m11, m22 = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    squares = np.stack(
        [1 + m00 - m11 - m22, 1 - m00 + m11 - m22, 1 - m00 - m11 + m22, 1 + m00 + m11 + m22], -1
    )
    sx, sy, sz = R[..., 2, 1], R[..., 0, 2], R[..., 1, 0]
    tx, ty, tz = R[..., 1, 2], R[..., 2, 0], R[..., 0, 1]
    candidates = np.stack(
        [
            np.stack([squares[..., 0], sz + tz, sy + ty, sx - tx], -1),
            np.stack([sz + tz, squares[..., 1], sx + tx, sy - ty], -1),
            np.stack([sy + ty, sx + tx, squares[..., 2], sz - tz], -1),
            np.stack([sx - tx, sy - ty, sz - tz, squares[..., 3]], -1),
        ],
        axis=-2,
    )
    best = np.argmax(squares, axis=-1)
    return canonical(np.take_along_axis(candidates, best[..., None, None], axis=-2)[..., 0, :])


def angle_rad(a_xyzw: Floats, b_xyzw: Floats) -> Floats:
    """Angle between rotations (...,) [rad]."""
    angle: Floats = np.linalg.norm(log(multiply(a_xyzw, inverse(b_xyzw))), axis=-1)
    return angle


def slerp(a_xyzw: Floats, b_xyzw: Floats, u: float | Floats) -> Floats:
    """Rotations on the shortest arc from a (u = 0) to b (u = 1); u broadcasts over the leading axes."""
    step = log(multiply(b_xyzw, inverse(a_xyzw)))
    return canonical(multiply(exp(np.asarray(u)[..., None] * step), a_xyzw))
