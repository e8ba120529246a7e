"""Single rotations as plain numbers, for programs without numpy. Quaternions x y z w of length one."""

import math

from mocapd.outputs.wire import Quaternion, Vector

IDENTITY_XYZW: Quaternion = (0.0, 0.0, 0.0, 1.0)
_STRAIGHT = 1e-9  # sine of half the angle below which the axis is undefined


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """First b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(q: Quaternion) -> Quaternion:
    return (-q[0], -q[1], -q[2], q[3])


def canonical(q: Quaternion) -> Quaternion:
    """The same rotation with w >= 0, as on the wire."""
    return q if q[3] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])


def rotate(q: Quaternion, v: Vector) -> Vector:
    x, y, z, w = q
    tx, ty, tz = (
        2.0 * (y * v[2] - z * v[1]),
        2.0 * (z * v[0] - x * v[2]),
        2.0 * (x * v[1] - y * v[0]),
    )
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def log(q: Quaternion) -> Vector:
    """The shortest rotation vector [rad]."""
    x, y, z, w = canonical(q)
    sine = math.sqrt(x * x + y * y + z * z)
    if sine < _STRAIGHT:
        return (2.0 * x, 2.0 * y, 2.0 * z)
    share = 2.0 * math.atan2(sine, w) / sine
    return (x * share, y * share, z * share)


def exp(v: Vector) -> Quaternion:
    """The rotation of a rotation vector [rad]."""
    angle = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if angle < _STRAIGHT:
        return (0.5 * v[0], 0.5 * v[1], 0.5 * v[2], 1.0)
    share = math.sin(0.5 * angle) / angle
    return (v[0] * share, v[1] * share, v[2] * share, math.cos(0.5 * angle))
