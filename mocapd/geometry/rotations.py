"""Rotations as quaternions xyzw with w >= 0, rotation vectors and matrices; all batched over leading axes.

Written for the twenty-two bones of one body, thirty times a second: there a call of numpy costs more
than its arithmetic, so products are one outer product and one multiplication by a table of signs.
"""

import numpy as np

from mocapd.types import Floats

IDENTITY_XYZW = np.array([0.0, 0.0, 0.0, 1.0])
# Added to squared lengths: no zero to divide by. sin(x)/x and atan(x)/x of so small a length are 1 to
# rounding, whatever it is; and the squares of lengths under 1e-162 would be 0 anyway.
_TINY = 1e-300
_CONJUGATE = np.array([-1.0, -1.0, -1.0, 1.0])
_NEAR_ZERO_RAD = 1e-6  # where the series are exact to rounding
_NEAR_ZERO_JACOBIAN_RAD = 1e-4


def _table(terms: str) -> Floats:
    """(n*n, len(terms)): which products a_i b_j make up each component, from `+ax -zy ...` by rows."""
    rows = [row.split() for row in terms.strip().splitlines()]
    n = 1 + max("xyzw".index(letter) for row in rows for term in row for letter in term[1:])
    table = np.zeros((n, n, len(rows)))
    for k, row in enumerate(rows):
        for term in row:
            i, j = "xyzw".index(term[1]), "xyzw".index(term[2])
            table[i, j, k] = 1.0 if term[0] == "+" else -1.0
    return table.reshape(n * n, len(rows))


_HAMILTON = _table(
    """
    +wx +xw +yz -zy
    +wy -xz +yw +zx
    +wz +xy -yx +zw
    +ww -xx -yy -zz
    """
)
_CROSS = _table(
    """
    +yz -zy
    +zx -xz
    +xy -yx
    """
)
_TWICE_CROSS = 2.0 * _CROSS


def _bilinear(a: Floats, b: Floats, table: Floats) -> Floats:
    outer = np.asarray(a)[..., :, None] * np.asarray(b)[..., None, :]
    product: Floats = outer.reshape(*outer.shape[:-2], len(table)) @ table
    return product


def canonical(q_xyzw: Floats) -> Floats:
    """The same rotations (...,4) with unit norm and w >= 0."""
    norm = np.sqrt(np.vecdot(q_xyzw, q_xyzw))[..., None]
    q: Floats = q_xyzw / np.copysign(norm, q_xyzw[..., 3:])
    return q


def multiply(a_xyzw: Floats, b_xyzw: Floats) -> Floats:
    """Hamilton product (...,4): first b, then a."""
    return _bilinear(a_xyzw, b_xyzw, _HAMILTON)


def inverse(q_xyzw: Floats) -> Floats:
    """Conjugate of unit quaternions (...,4)."""
    conjugate: Floats = q_xyzw * _CONJUGATE
    return conjugate


def rotate(q_xyzw: Floats, v: Floats) -> Floats:
    """Vectors v (...,3) turned by q (...,4)."""
    u = q_xyzw[..., :3]
    t = _bilinear(u, v, _TWICE_CROSS)
    return v + q_xyzw[..., 3:] * t + _bilinear(u, t, _CROSS)


def exp(rotvec_rad: Floats) -> Floats:
    """Rotation vectors (...,3) [rad] to quaternions (...,4); exact to rounding near zero."""
    r = np.asarray(rotvec_rad, dtype=float)
    angle = np.sqrt(np.vecdot(r, r) + _TINY)[..., None]
    half = 0.5 * angle
    q = np.empty((*r.shape[:-1], 4))
    np.multiply(r, np.sin(half) / angle, out=q[..., :3])
    np.cos(half, out=q[..., 3:])
    return canonical(q)


def log(q_xyzw: Floats) -> Floats:
    """Quaternions (...,4) to rotation vectors (...,3) [rad], angle in [0, pi]."""
    q = canonical(q_xyzw)
    v = q[..., :3]
    s = np.sqrt(np.vecdot(v, v) + _TINY)[..., None]
    rotvec_rad: Floats = v * (2.0 * np.arctan2(s, q[..., 3:]) / s)
    return rotvec_rad


def to_matrix(q_xyzw: Floats) -> Floats:
    """Quaternions (...,4) to matrices (...,3,3)."""
    q = np.asarray(q_xyzw, dtype=float)
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    R = np.empty((*q.shape[:-1], 3, 3))
    R[..., 0, 0] = 1 - 2 * (y * y + z * z)
    R[..., 0, 1] = 2 * (x * y - z * w)
    R[..., 0, 2] = 2 * (x * z + y * w)
    R[..., 1, 0] = 2 * (x * y + z * w)
    R[..., 1, 1] = 1 - 2 * (x * x + z * z)
    R[..., 1, 2] = 2 * (y * z - x * w)
    R[..., 2, 0] = 2 * (x * z - y * w)
    R[..., 2, 1] = 2 * (y * z + x * w)
    R[..., 2, 2] = 1 - 2 * (x * x + y * y)
    return R


def from_matrix(R: Floats) -> Floats:
    """Rotation matrices (...,3,3) to quaternions (...,4), by the largest of the four squared components."""
    R = np.asarray(R, dtype=float)
    m00, m11, m22 = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    sx, sy, sz = R[..., 2, 1], R[..., 0, 2], R[..., 1, 0]
    tx, ty, tz = R[..., 1, 2], R[..., 2, 0], R[..., 0, 1]
    # row i: four times component i of the quaternion, multiplied by all four
    products = np.empty((*R.shape[:-2], 4, 4))
    products[..., 0, 0] = 1 + m00 - m11 - m22
    products[..., 1, 1] = 1 - m00 + m11 - m22
    products[..., 2, 2] = 1 - m00 - m11 + m22
    products[..., 3, 3] = 1 + m00 + m11 + m22
    products[..., 0, 1] = products[..., 1, 0] = sz + tz
    products[..., 0, 2] = products[..., 2, 0] = sy + ty
    products[..., 1, 2] = products[..., 2, 1] = sx + tx
    products[..., 0, 3] = products[..., 3, 0] = sx - tx
    products[..., 1, 3] = products[..., 3, 1] = sy - ty
    products[..., 2, 3] = products[..., 3, 2] = sz - tz
    flat = products.reshape(-1, 4, 4)
    best = np.argmax(flat[:, range(4), range(4)], axis=-1)
    return canonical(flat[range(len(flat)), best].reshape(*R.shape[:-2], 4))


def angle_rad(a_xyzw: Floats, b_xyzw: Floats) -> Floats:
    """Angle between rotations (...,) [rad]."""
    angle: Floats = np.linalg.norm(log(multiply(a_xyzw, inverse(b_xyzw))), axis=-1)
    return angle


def slerp(a_xyzw: Floats, b_xyzw: Floats, u: float | Floats) -> Floats:
    """Rotations on the shortest arc from a (u = 0) to b (u = 1); u broadcasts over the leading axes."""
    step = log(multiply(b_xyzw, inverse(a_xyzw)))
    return canonical(multiply(exp(np.asarray(u)[..., None] * step), a_xyzw))


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
