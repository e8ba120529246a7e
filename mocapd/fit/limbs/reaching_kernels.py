"""Arms bent so that the hand comes to a place: elbows on a circle, and the rotations of two bones that lie so."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.posing_kernels import quat_exp, quat_inverse, quat_multiply
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
_LEAST = 1e-6


@kernel
def _cross(a: Array, b: Array, out: Array) -> None:
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def _make_unit(v: Array) -> float:
    """Scale v (3,) to length 1, if it has any; its length."""
    length: float = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    for i in range(3):
        v[i] /= max(length, _LEAST)
    return length


@kernel
def bend_to(
    hands_m: Array,
    shoulder_m: Array,
    upper_m: float,
    lower_m: float,
    outwards: Array,
    swivels_rad: Array,
    upper: Array,
    lower: Array,
) -> None:
    """Fill upper and lower (S,T,3) [m] with bones of these lengths that lead from the shoulder (3,) to each of hands_m (T,3),
    or as near as they reach.

    Of the circle on which the elbow then is, each of swivels_rad (S,) takes the place so far from its lowest, towards
    outwards (3,), away from the body.
    """
    towards, below, beside = np.empty(3), np.empty(3), np.empty(3)
    for t in range(hands_m.shape[0]):
        for i in range(3):
            towards[i] = hands_m[t, i] - shoulder_m[i]
        far_m = _make_unit(towards)
        far_m = min(max(far_m, abs(upper_m - lower_m) + 0.02), upper_m + lower_m - 0.005)
        middle_m = (upper_m * upper_m - lower_m * lower_m + far_m * far_m) / (2.0 * far_m)
        radius_m = np.sqrt(max(upper_m * upper_m - middle_m * middle_m, 0.0))
        for i in range(3):
            below[i] = towards[i] * towards[1]
        below[1] -= 1.0
        _make_unit(below)
        _cross(towards, below, beside)
        if not beside[0] * outwards[0] + beside[1] * outwards[1] + beside[2] * outwards[2] > 0.0:
            for i in range(3):
                beside[i] = -beside[i]
        for s in range(len(swivels_rad)):
            a, b = radius_m * np.cos(swivels_rad[s]), radius_m * np.sin(swivels_rad[s])
            for i in range(3):
                upper[s, t, i] = middle_m * towards[i] + a * below[i] + b * beside[i]
                lower[s, t, i] = far_m * towards[i] - upper[s, t, i]


@kernel
def _of_frame(x: Array, y: Array, z: Array, out: Array) -> None:
    """The rotation (4,) whose matrix has these columns (3,), by the largest of its four squared components."""
    w2, x2 = 1.0 + x[0] + y[1] + z[2], 1.0 + x[0] - y[1] - z[2]
    y2, z2 = 1.0 - x[0] + y[1] - z[2], 1.0 - x[0] - y[1] + z[2]
    if x2 >= max(y2, z2, w2):
        out[0], out[1], out[2], out[3] = x2, x[1] + y[0], z[0] + x[2], y[2] - z[1]
    elif y2 >= max(z2, w2):
        out[0], out[1], out[2], out[3] = x[1] + y[0], y2, y[2] + z[1], z[0] - x[2]
    elif z2 >= w2:
        out[0], out[1], out[2], out[3] = z[0] + x[2], y[2] + z[1], z2, x[1] - y[0]
    else:
        out[0], out[1], out[2], out[3] = y[2] - z[1], z[0] - x[2], x[1] - y[0], w2
    length = np.copysign(
        np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3]), out[3]
    )
    for i in range(4):
        out[i] /= length


@kernel
def rotations_of_bends(
    upper: Array, lower: Array, side: float, upper_m: float, collar_xyzw: Array, out: Array
) -> None:
    """Fill out (N,3,4), behind each collar, with the local rotations of upper arms and forearms that lie like upper and lower
    (N,3) [m].

    side: 1 of the left arm, which lies along the body's x in the T-pose, -1 of the right one; upper_m: how long an upper
    arm is; collar_xyzw (4,): the collar's global rotation.
    """
    x, y, z, frame, inverse = np.empty(3), np.empty(3), np.empty(3), np.empty(4), np.empty(4)
    quat_inverse(collar_xyzw, inverse)
    for n in range(upper.shape[0]):
        along = 0.0
        for i in range(3):
            x[i] = side / upper_m * upper[n, i]
            along += lower[n, i] * x[i]
        across = 0.0
        for i in range(3):
            z[i] = lower[n, i] - along * x[i]
        _make_unit(z)
        for i in range(3):
            across += lower[n, i] * z[i]
        _cross(z, x, y)
        _of_frame(x, y, z, frame)
        quat_multiply(inverse, frame, out[n, 1])
        quat_exp(0.0, -side * np.arctan2(across, side * along), 0.0, out[n, 2])
