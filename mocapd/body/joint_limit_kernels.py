"""Compiled angles of the rotation groups against their limits, with derivatives."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
LITTLE_SWING_RAD, MUCH_SWING_RAD = np.radians(30.0), np.radians(65.0)


class JointLimits(NamedTuple):
    """Limits of the G rotation groups of a pose space; axis -1: free (the root).

    lower_rad, upper_rad (G,3): about x y z of the parent bone, twist at `axis`, swing elsewhere.
    hanging_rad (G,2): least and greatest twist while the bone swings by less than LITTLE_SWING_RAD; from there to
    MUCH_SWING_RAD the twist's limits become those of lower_rad and upper_rad, linearly.
    joint (G,): the joint that a group's angle is read from; share (J,): its share of the angle.
    """

    axis: Ints  # (G,)
    joint: Ints  # (G,)
    share: Array  # (J,)
    lower_rad: Array  # (G,3)
    upper_rad: Array  # (G,3)
    hanging_rad: Array  # (G,2)


@kernel
def limit_residuals(
    local: Array,
    limits: JointLimits,
    residual: Array,
    derivative: Array,
) -> None:
    """How far each group is beyond its limits: residual (G,3) [rad], 0 inside.

    local (J,4) xyzw; the limits are along x y z of the parent bone: the component `axis` is the twist
    about the bone, the two others are the swing's rotation vector (rotation = swing * twist, the swing
    last). derivative (G,3,3): d residual[g, i] / d step[g, k] for the solver's step, a rotation vector
    in the parent's frame of which each joint of the group takes its share. A group with axis -1 has no
    limits.
    """
    axis_of_group, joint_of_group, share_of_joint, lower, upper, hanging = limits
    d = np.empty(4)
    c = np.empty(3)
    dc = np.empty((3, 3))
    for g in range(joint_of_group.shape[0]):
        for i in range(3):
            residual[g, i] = 0.0
            for k in range(3):
                derivative[g, i, k] = 0.0
        a = axis_of_group[g]
        if a < 0:
            continue
        j = joint_of_group[g]
        share = share_of_joint[j]
        b, e = (a + 1) % 3, (a + 2) % 3  # the axes after the twist axis, in cyclic order
        w = local[j, 3]
        sign = 1.0 if w >= 0.0 else -1.0
        w *= sign
        qa, qb, qe = sign * local[j, a], sign * local[j, b], sign * local[j, e]
        n2 = max(qa * qa + w * w, 1e-12)
        n = np.sqrt(n2)
        m2 = qb * qb + qe * qe
        m = np.sqrt(m2)
        # swing = q * twist^-1; its vector part is (p, r) / n, its angle 2 atan2(m, n)
        p = qb * w - qa * qe
        r = qa * qb + qe * w
        if m < 1e-5:
            f, df = 2.0 + m2 / 3.0, 2.0 / 3.0
        else:
            angle = 2.0 * np.arctan2(m, n)
            f = angle / m
            df = (2.0 / max(n, 1e-6) - f) / m2  # (d f / d m) / m
        c[a] = 2.0 * np.arctan2(qa, w)
        c[b] = f * p / n
        c[e] = f * r / n
        for k in range(3):
            # dq = step * q / 2 for a unit step about axis k (relative order a, b, e)
            if k == 0:
                d[0], d[1], d[2], d[3] = w, -qe, qb, -qa
            elif k == 1:
                d[0], d[1], d[2], d[3] = qe, w, -qa, -qb
            else:
                d[0], d[1], d[2], d[3] = -qb, qa, w, -qe
            for i in range(4):
                d[i] *= 0.5
            axis = a if k == 0 else (b if k == 1 else e)
            dc[a, axis] = 2.0 * (w * d[0] - qa * d[3]) / n2
            dn = (qa * d[0] + w * d[3]) / n
            dp = d[1] * w + qb * d[3] - d[0] * qe - qa * d[2]
            dr = d[0] * qb + qa * d[1] + d[2] * w + qe * d[3]
            dfk = df * (qb * d[1] + qe * d[2])
            dc[b, axis] = dfk * p / n + f * (dp - p * dn / n) / n
            dc[e, axis] = dfk * r / n + f * (dr - r * dn / n) / n
        swing = np.sqrt(c[b] * c[b] + c[e] * c[e])  # [rad]
        for i in range(3):
            # angles of the whole group; a joint's share of the step undoes the division
            most, least = upper[g, i], lower[g, i]
            over_swing, under_swing = 0.0, 0.0  # derivatives of the twist's limits
            if i == a and swing / share < MUCH_SWING_RAD:
                range_rad = MUCH_SWING_RAD - LITTLE_SWING_RAD
                lifted = max(swing / share - LITTLE_SWING_RAD, 0.0) / range_rad
                if lifted > 0.0:
                    over_swing = (most - hanging[g, 1]) / range_rad
                    under_swing = (least - hanging[g, 0]) / range_rad
                most = hanging[g, 1] + lifted * (most - hanging[g, 1])
                least = hanging[g, 0] + lifted * (least - hanging[g, 0])
            over = c[i] / share - most
            under = c[i] / share - least
            if over > 0.0:
                residual[g, i], by_swing = over, over_swing
            elif under < 0.0:
                residual[g, i], by_swing = under, under_swing
            else:
                continue
            for k in range(3):
                derivative[g, i, k] = dc[i, k]
                if by_swing != 0.0:
                    derivative[g, i, k] -= by_swing * (c[b] * dc[b, k] + c[e] * dc[e, k]) / swing
