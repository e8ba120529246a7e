"""One Gauss-Newton step: the terms' normal equations, held by the priors of motion, rest, uprightness, joint limits and
proportions, and solved. One call, as a frame has dozens of steps; each prior is a kernel of its own."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.body.joint_limit_kernels import JointLimits, limit_residuals
from mocapd.body.posing_kernels import difference
from mocapd.fit.positive_inverse_kernels import solve_positive
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]

FREE_POSE = 1e-3  # information of a free pose, for what nothing observes


@kernel
def keep_in_limits(
    local_xyzw: Array, limits: JointLimits, information: float, H: Array, b: Array
) -> None:
    """Add information [1/rad^2] of by how much each rotation group of a pose (J,4) is beyond its limits."""
    groups = limits[1].shape[0]
    excess = np.zeros((groups, 3))
    slope = np.zeros((groups, 3, 3))
    limit_residuals(local_xyzw, limits, excess, slope)
    for group in range(groups):
        first = 3 + 3 * group
        for i in range(3):
            if excess[group, i] == 0.0:
                continue
            for p in range(3):
                pull = information * slope[group, i, p]
                b[first + p] -= pull * excess[group, i]
                for q in range(3):
                    H[first + p, first + q] += pull * slope[group, i, q]


@kernel
def pull_back(information: Array, away: Array, b: Array) -> None:
    """Add information (n,n) times away (n,), from the pose to the other one, to the first of b (P,); n is a multiple of
    three, and three sums that are made beside each other take a third of the time of one."""
    for p in range(0, away.shape[0], 3):
        x, y, z = b[p], b[p + 1], b[p + 2]
        for q in range(away.shape[0]):
            x += information[p, q] * away[q]
            y += information[p + 1, q] * away[q]
            z += information[p + 2, q] * away[q]
        b[p], b[p + 1], b[p + 2] = x, y, z


@kernel
def set_upright(hips_xyzw: Array, information: float, H: Array, b: Array) -> None:
    """Add information [1/rad^2] of the rotation vector, in the world, by which the hips lean: of Y over to where they point
    up."""
    x, y, z, w = hips_xyzw[0], hips_xyzw[1], hips_xyzw[2], hips_xyzw[3]
    H[3, 3] += information
    H[5, 5] += information
    b[3] -= information * 2.0 * (y * z + w * x)
    b[5] += information * 2.0 * (x * y - w * z)


class PosePriors(NamedTuple):
    """What holds a pose beside the evidence: rest_information (P,P) to rest_local (J,4), limit_information to within the
    joint limits, and tilt_information the hips upright."""

    rest_local: Array
    rest_information: Array
    limits: JointLimits
    limit_information: float
    tilt_information: float


@kernel
def _shape_step(
    A: Array,
    g: Array,
    n_pose: int,
    shape_offset: Array,
    shape_information: Array,
    shape_room: Array,
) -> Array:
    """The step of the factors where the pose is free: eliminated from A (P,P), g (P,), as in
    `Fitter.shape_information`; within shape_room (2,n_shape)."""
    free, factors = A.copy(), g.copy()
    for p in range(n_pose):
        free[p, p] += FREE_POSE
    for i in range(len(shape_offset)):
        for j in range(len(shape_offset)):
            free[n_pose + i, n_pose + j] += shape_information[i, j]
            factors[n_pose + i] += shape_information[i, j] * shape_offset[j]
    solve_positive(free, factors)
    step = factors[n_pose:].copy()
    for i in range(len(step)):
        step[i] = min(max(step[i], shape_room[0, i]), shape_room[1, i])
    return step


@kernel
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
    shape_room: Array,
) -> Array:
    """The step (P,) that the normal equations of all terms lead to from the pose root (3,), local (J,4).

    H (P,P), b (P,) of the evidence, left as they are; of the P unknowns the first are the pose's.
    motion_information (n_pose,n_pose) holds the pose to start_root, start_local; shape_offset:
    from the factors to what is known of them, with shape_information; shape_room (2,n_shape): the least and the largest step
    of each. Motion does not hold the pose while the factors are found: before one camera they would otherwise follow each
    wrong depth, and grow with it.
    """
    rest_local, rest_information, limits, limit_information, tilt_information = priors
    _, joint_of_group, share_of_joint, _, _, _ = limits
    n_pose = motion_information.shape[0]
    P = b.shape[0]
    A = H.copy()
    g = b.copy()
    away = np.empty(n_pose)
    for p in range(n_pose):
        for q in range(n_pose):
            A[p, q] += rest_information[p, q]
    difference(root, rest_local, root, local, joint_of_group, share_of_joint, away)
    pull_back(rest_information, away, g)
    set_upright(local[0], tilt_information, A, g)
    keep_in_limits(local, limits, limit_information, A, g)
    if n_pose < P:
        shape_step = _shape_step(A, g, n_pose, shape_offset, shape_information, shape_room)
        for i in range(P - n_pose):
            for p in range(n_pose):
                g[p] -= A[p, n_pose + i] * shape_step[i]
            g[n_pose + i] = shape_step[i]
        A = A[:n_pose, :n_pose].copy()
    for p in range(n_pose):
        for q in range(n_pose):
            A[p, q] += motion_information[p, q]
    difference(start_root, start_local, root, local, joint_of_group, share_of_joint, away)
    pull_back(motion_information, away, g)
    solve_positive(A, g[:n_pose])
    return g
