"""How far each bone goes on the way to where it was found."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.posing_kernels import quat_exp, quat_inverse, quat_log, quat_multiply

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def _turn_between(one: Array, other: Array, inverse: Array, between: Array, out: Array) -> None:
    """The rotation vector (3,) [rad] that leads from `one` to `other` (4,); inverse, between (4,) are scratch."""
    quat_inverse(one, inverse)
    quat_multiply(other, inverse, between)
    quat_log(between, out)


@njit(cache=True, nogil=True)
def follow_bones(
    found_xyzw: Array,
    last_xyzw: Array,
    trust: Array,
    following: Array,
    gap_s: float,
    ticks: float,
    learns: float,
    turning_rad_s: Array,
    out_xyzw: Array,
    follows: Array,
    learned: Array,
) -> None:
    """Fill out_xyzw (J,4) with bones gap_s after last_xyzw (J,4) on their way to found_xyzw (J,4); turning_rad_s (J,3) goes
    from how they turned to how they turn.

    trust (J,): in each bone's direction; following (7,J): the numbers of a `Following`, for each bone; ticks: gap_s in usual
    frames; learns: see `PoseFilterParams`. Fills follows and learned (J,): the shares of the way, and of a new speed, that
    they took.
    """
    turn, way = np.empty(4), np.empty(3)
    expected, scratch, between = np.empty(4), np.empty(4), np.empty(4)
    for j in range(found_xyzw.shape[0]):
        all_sure, doubtful, least = following[0, j], following[1, j], following[2, j]
        doubtful_rad_s, sure_rad_s = following[3, j], following[4, j]
        power, goes_on = following[5, j], following[6, j]
        sure = min(max((trust[j] - doubtful) / (all_sure - doubtful), 0.0), 1.0) ** power
        follows[j] = 1.0 - ((1.0 - least) * (1.0 - sure)) ** ticks
        learned[j] = 1.0 - (1.0 - learns * np.sqrt(sure)) ** ticks
        speed, last = turning_rad_s[j], last_xyzw[j]
        for i in range(3):
            speed[i] *= goes_on**ticks
        quat_exp(gap_s * speed[0], gap_s * speed[1], gap_s * speed[2], turn)
        quat_multiply(turn, last, expected)
        _turn_between(expected, found_xyzw[j], scratch, between, way)
        quat_exp(follows[j] * way[0], follows[j] * way[1], follows[j] * way[2], turn)
        quat_multiply(turn, expected, between)
        for i in range(4):  # by numbers: numba takes seconds to compile an array's assignment
            expected[i] = between[i]
        _turn_between(last, expected, scratch, between, way)
        most_rad = gap_s * (doubtful_rad_s + (sure_rad_s - doubtful_rad_s) * sure)
        length = np.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
        share = min(1.0, most_rad / max(length, 1e-9))
        for i in range(3):
            way[i] *= share
            speed[i] += learned[j] * (way[i] / gap_s - speed[i])
        quat_exp(way[0], way[1], way[2], turn)
        out = out_xyzw[j]
        quat_multiply(turn, last, out)
        norm = np.copysign(np.sqrt((out * out).sum()), out[3])
        for i in range(4):
            out[i] /= norm
