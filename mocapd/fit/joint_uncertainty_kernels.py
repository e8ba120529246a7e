"""Compiled derivatives of the joint centres by the pose parameters, and what a covariance of those makes of them."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.posing_kernels import quat_matrix
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def joint_jacobian(
    parents: Ints,
    group_of_joint: Ints,
    share_of_joint: Array,
    global_xyzw: Array,
    joints: Array,
    out: Array,
) -> None:
    """Derivative of the joint centres joints (J,3) by the pose step of `retract`: out (J,3,3 + 3 G).

    global_xyzw (J,4): its bones' rotations. A bone turns about the axes of its parent, and moves the joints below it,
    not its own.
    """
    R = np.empty((parents.shape[0], 3, 3))
    for j in range(parents.shape[0]):
        quat_matrix(global_xyzw[j], R[j])
    out[:] = 0.0
    for j in range(parents.shape[0]):
        for i in range(3):
            out[j, i, i] = 1.0
        above = parents[j]
        while above >= 0:
            group = group_of_joint[above]
            if group >= 0:
                f = share_of_joint[above]
                x = f * (joints[j, 0] - joints[above, 0])
                y = f * (joints[j, 1] - joints[above, 1])
                z = f * (joints[j, 2] - joints[above, 2])
                p = parents[above]
                for k in range(3):
                    if p < 0:
                        a = 1.0 if k == 0 else 0.0
                        b = 1.0 if k == 1 else 0.0
                        c = 1.0 if k == 2 else 0.0
                    else:
                        a, b, c = R[p, 0, k], R[p, 1, k], R[p, 2, k]
                    column = 3 + 3 * group + k
                    out[j, 0, column] += b * z - c * y
                    out[j, 1, column] += c * x - a * z
                    out[j, 2, column] += a * y - b * x
            above = parents[above]


@kernel
def place_variances(jacobian: Array, covariance: Array, out: Array) -> None:
    """Trace of each joint's covariance: out (J,) from jacobian (J,3,P) and covariance (P,P)."""
    J, _, P = jacobian.shape
    columns = np.empty(P, np.int64)
    for j in range(J):
        n = 0
        for p in range(P):  # of the parameters few move a joint
            if jacobian[j, 0, p] != 0.0 or jacobian[j, 1, p] != 0.0 or jacobian[j, 2, p] != 0.0:
                columns[n] = p
                n += 1
        total = 0.0
        for s in range(n):
            p = columns[s]
            for t in range(n):
                q = columns[t]
                total += covariance[p, q] * (
                    jacobian[j, 0, p] * jacobian[j, 0, q]
                    + jacobian[j, 1, p] * jacobian[j, 1, q]
                    + jacobian[j, 2, p] * jacobian[j, 2, q]
                )
        out[j] = total


@kernel
def add_unmodelled_turns(
    parents: Ints, group_of_joint: Ints, turn_sd: Array, joints: Array, out: Array
) -> None:
    """Add to the traces out (J,) what bones that have no pose parameter may be turned by: turn_sd (J,) about each
    axis [rad], inf where anything is possible."""
    for j in range(parents.shape[0]):
        above = parents[j]
        while above >= 0:
            if group_of_joint[above] < 0:
                lever2 = 0.0
                for i in range(3):
                    lever2 += (joints[j, i] - joints[above, i]) ** 2
                out[j] += 2.0 * turn_sd[above] ** 2 * lever2
            above = parents[above]
