"""How far each bone goes on the way to where it was found."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.posing_kernels import quat_exp, quat_inverse, quat_log, quat_multiply
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]

# of `moving_share`
_KEEPS = 0.85  # decay of the mean way per tick
_LASTS = 0.95  # decay of the stored speed per tick
_LEAST = 0.05  # share of its way that noise goes
_FAST_HZ = 10.0  # what goes this many times as far as noise in a second surely moves


@kernel
def _turn_between(one: Array, other: Array, inverse: Array, between: Array, out: Array) -> None:
    """The rotation vector (3,) [rad] that leads from `one` to `other` (4,); inverse, between (4,) are scratch."""
    quat_inverse(one, inverse)
    quat_multiply(other, inverse, between)
    quat_log(between, out)


@kernel
def moving_share(way: Array, speed: float, memory: Array, ticks: float, noise: float) -> float:
    """How much of a step is motion, above 0 to 1, by what speaks most for motion rather than noise.

    Ways of noise go to and fro: the mean way's length over the ways' mean length, squared (Trigg and Leach 1967, Exponential
    smoothing with an adaptive response rate). Who was fast a moment ago turns back rather than trembles. Noise is never far.

    way (3,): of this step [rad]; speed: up to it [rad/s]; memory (5,): mean way, mean length and remembered speed, which
    become those after it; ticks: the step's time in usual frames; noise: how far it leads at most [rad], 0 for none.
    """
    new = 1.0 - _KEEPS**ticks
    length2 = mean2 = 0.0
    for i in range(3):
        memory[i] += new * (way[i] - memory[i])
        length2 += way[i] * way[i]
        mean2 += memory[i] * memory[i]
    memory[3] += new * (np.sqrt(length2) - memory[3])
    memory[4] = max(speed, memory[4] * _LASTS**ticks)
    if length2 >= noise * noise:
        return 1.0
    one_way = mean2 / max(memory[3] * memory[3], 1e-18)
    moves = max(one_way, (memory[4] / (_FAST_HZ * noise)) ** 2, length2 / (noise * noise))
    share: float = _LEAST + (1.0 - _LEAST) * min(moves, 1.0)
    return share


@kernel
def follow_bones(
    found_xyzw: Array,
    last_xyzw: Array,
    trust: Array,
    following: Array,
    gap_s: float,
    ticks: float,
    learns: float,
    memory: Array,
    turning_rad_s: Array,
    out_xyzw: Array,
    follows: Array,
    learned: Array,
) -> None:
    """Fill out_xyzw (J,4) with bones gap_s after last_xyzw (J,4) on their way to found_xyzw (J,4); turning_rad_s (J,3) goes
    from how they turned to how they turn, memory (J,5) as that of `moving_share` does.

    trust (J,): in each bone's direction; following (8,J): the numbers of `BoneGains`, for each bone; ticks: gap_s in usual
    frames; learns: see `PoseFilterParams`. Fills follows and learned (J,): the shares of the way, and of a new speed, that
    they take of steady motion.
    """
    turn, way = np.empty(4), np.empty(3)
    expected, scratch, between = np.empty(4), np.empty(4), np.empty(4)
    for j in range(found_xyzw.shape[0]):
        all_sure, doubtful, least = following[0, j], following[1, j], following[2, j]
        doubtful_rad_s, sure_rad_s = following[3, j], following[4, j]
        power, goes_on, noise_rad = following[5, j], following[6, j], following[7, j]
        sure = min(max((trust[j] - doubtful) / (all_sure - doubtful), 0.0), 1.0) ** power
        follows[j] = 1.0 - ((1.0 - least) * (1.0 - sure)) ** ticks
        learned[j] = 1.0 - (1.0 - learns * np.sqrt(sure)) ** ticks
        speed, last = turning_rad_s[j], last_xyzw[j]
        speed_rad_s = np.sqrt(speed[0] * speed[0] + speed[1] * speed[1] + speed[2] * speed[2])
        for i in range(3):
            speed[i] *= goes_on**ticks
        quat_exp(gap_s * speed[0], gap_s * speed[1], gap_s * speed[2], turn)
        quat_multiply(turn, last, expected)
        _turn_between(expected, found_xyzw[j], scratch, between, way)
        share = follows[j] * moving_share(way, speed_rad_s, memory[j], ticks, noise_rad)
        quat_exp(share * way[0], share * way[1], share * way[2], turn)
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
        norm = np.copysign(
            np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3]), out[3]
        )
        for i in range(4):
            out[i] /= norm
