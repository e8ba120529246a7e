"""The bones of a limb mirrored in depth: to one camera they look alike."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.posing_kernels import quat_inverse, quat_multiply
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]


@kernel
def _mirror(v: Array, ray: Array, out: Array) -> None:
    """v (3,) with its part along a unit vector (3,) turned round."""
    along = v[0] * ray[0] + v[1] * ray[1] + v[2] * ray[2]
    for i in range(3):
        out[i] = v[i] - 2.0 * along * ray[i]


@kernel
def shortest_turn(a: Array, b: Array, out: Array) -> None:
    """Fill out (4,) with the smallest rotation that turns direction a (3,) into direction b (3,)."""
    scale = np.sqrt((a[0] ** 2 + a[1] ** 2 + a[2] ** 2) * (b[0] ** 2 + b[1] ** 2 + b[2] ** 2))
    w = 1.0 + (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / scale
    out[0] = (a[1] * b[2] - a[2] * b[1]) / scale
    out[1] = (a[2] * b[0] - a[0] * b[2]) / scale
    out[2] = (a[0] * b[1] - a[1] * b[0]) / scale
    out[3] = w
    if w < 1e-6:  # right round, about any axis across
        if abs(a[0]) < 0.9 * np.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2):
            out[0], out[1], out[2], out[3] = 0.0, a[2], -a[1], 0.0
        else:
            out[0], out[1], out[2], out[3] = -a[2], 0.0, a[0], 0.0
    length = np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3])
    for i in range(4):
        out[i] /= length


@kernel
def mirrored_in_depth(
    joints_m: Array, globals_xyzw: Array, parent_xyzw: Array, eye_m: Array, out: Array
) -> None:
    """Fill out (3,2,4) with the local rotations of a limb's two bones, the lower, the upper, both of them mirrored in depth.

    joints_m (3,3): where the bones begin and end; globals_xyzw (2,4): theirs, and that of the bone before, parent_xyzw (4,);
    eye_m (3,): the camera's centre, which sees the middle joint along its ray.
    """
    ray, bones, flipped = np.empty(3), np.empty((2, 3)), np.empty((2, 3))
    turn, inverse = np.empty(4), np.empty(4)
    turned = np.empty((2, 4))
    for i in range(3):
        ray[i] = joints_m[1, i] - eye_m[i]
        bones[0, i], bones[1, i] = joints_m[1, i] - joints_m[0, i], joints_m[2, i] - joints_m[1, i]
    length = np.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    for i in range(3):
        ray[i] /= length
    for k in range(2):
        _mirror(bones[k], ray, flipped[k])
    for n in range(3):
        for k in range(2):
            if n == 2 or k != n:
                shortest_turn(bones[k], flipped[k], turn)
                quat_multiply(turn, globals_xyzw[k], turned[k])
            else:
                for i in range(
                    4
                ):  # by numbers: numba takes seconds to compile an array's assignment
                    turned[k, i] = globals_xyzw[k, i]
        for k in range(2):
            quat_inverse(parent_xyzw if k == 0 else turned[0], inverse)
            quat_multiply(inverse, turned[k], out[n, k])
