"""One Gauss-Newton step of the pose: evidence, motion prior, rest prior, joint limits and shape prior."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.joint_limit_kernels import JointLimits, limit_residuals
from mocapd.body.posing_kernels import difference

Array = NDArray[np.float64]


class PosePriors(NamedTuple):
    """What holds a pose beside the evidence: rest_information (P,P) to rest_local (J,4), limit_information to within the
    joint limits, and tilt_information the hips upright."""

    rest_local: Array
    rest_information: Array
    limits: JointLimits
    limit_information: float
    tilt_information: float


@njit(cache=True, nogil=True)
def gauss_newton_step(
    H: Array,
    b: Array,
    root: Array,
    local: Array,
    start_root: Array,
    start_local: Array,
    motion_information: Array,
    priors: PosePriors,
    shape_offset: Array,
    shape_information: Array,
) -> Array:
    """The step (P,) that solves the normal equations of all terms at the pose root (3,), local (J,4).

    H (P,P), b (P,) of the evidence, left as they are; of the P unknowns the first are the pose's.
    motion_information (n_pose,n_pose) holds the pose to start_root, start_local; shape_offset:
    from the factors to what is known of them, with shape_information.
    """
    rest_local, rest_information, limits, limit_information, tilt_information = priors
    _, joint_of_group, share_of_joint, _, _ = limits
    n_pose = motion_information.shape[0]
    P = b.shape[0]
    A = H.copy()
    g = b.copy()
    away = np.empty(n_pose)
    difference(start_root, start_local, root, local, joint_of_group, share_of_joint, away)
    for p in range(n_pose):
        for q in range(n_pose):
            A[p, q] += motion_information[p, q] + rest_information[p, q]
    _add_pulls(motion_information, away, g)
    difference(root, rest_local, root, local, joint_of_group, share_of_joint, away)
    _add_pulls(rest_information, away, g)
    # by which rotation vector, in the world, the hips lean: of Y over to where they point up
    x, y, z, w = local[0, 0], local[0, 1], local[0, 2], local[0, 3]
    A[3, 3] += tilt_information
    A[5, 5] += tilt_information
    g[3] -= tilt_information * 2.0 * (y * z + w * x)
    g[5] += tilt_information * 2.0 * (x * y - w * z)
    G = joint_of_group.shape[0]
    excess = np.zeros((G, 3))
    slope = np.zeros((G, 3, 3))
    limit_residuals(local, limits, excess, slope)
    for group in range(G):
        first = 3 + 3 * group
        for i in range(3):
            if excess[group, i] == 0.0:
                continue
            for p in range(3):
                pull = limit_information * slope[group, i, p]
                g[first + p] -= pull * excess[group, i]
                for q in range(3):
                    A[first + p, first + q] += pull * slope[group, i, q]
    for i in range(P - n_pose):
        for j in range(P - n_pose):
            A[n_pose + i, n_pose + j] += shape_information[i, j]
            g[n_pose + i] += shape_information[i, j] * shape_offset[j]
    step = np.linalg.solve(A, g)
    for p in range(P):
        g[p] = step[p]
    return g


@njit(cache=True, nogil=True)
def _add_pulls(information: Array, away: Array, g: Array) -> None:
    """Add information (n,n) times away (n,) to the first of g (P,); n is a multiple of three, and three sums that are made
    beside each other take a third of the time of one."""
    for p in range(0, away.shape[0], 3):
        x, y, z = g[p], g[p + 1], g[p + 2]
        for q in range(away.shape[0]):
            x += information[p, q] * away[q]
            y += information[p + 1, q] * away[q]
            z += information[p + 2, q] * away[q]
        g[p], g[p + 1], g[p + 2] = x, y, z
