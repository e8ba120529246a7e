"""Derivatives of points of the posed body by the pose step and the shape factors: rows of Jacobians."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PosedJoints

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def joint_shape_derivatives(parents: Ints, d_rest: Array, R: Array, out: Array) -> None:
    """d posed joints / d factor: out (N,J,3) from d_rest (N,J,3); the root does not move."""
    for n in range(d_rest.shape[0]):
        for j in range(parents.shape[0]):
            p = parents[j]
            for i in range(3):
                if p < 0:
                    out[n, j, i] = 0.0
                else:
                    value = out[n, p, i]
                    for k in range(3):
                        value += R[p, i, k] * (d_rest[n, j, k] - d_rest[n, p, k])
                    out[n, j, i] = value


@njit(cache=True, nogil=True)
def joint_row(
    joint: int, g: Array, articulation: Articulation, posed: PosedJoints, out: Array
) -> None:
    """Derivative of g . p by the pose step: out (3 + 3 G), p being a joint's centre and g (3,) a direction in the world."""
    parents, group_of_joint, share_of_joint, _, _ = articulation
    _, R, joints, _ = posed
    for i in range(3):
        out[i] = g[i]
    out[3:] = 0.0
    j = parents[joint]  # a joint is a point of the bone above it
    while j >= 0:
        group = group_of_joint[j]
        if group >= 0:
            f = share_of_joint[j]
            rx = joints[joint, 0] - joints[j, 0]
            ry = joints[joint, 1] - joints[j, 1]
            rz = joints[joint, 2] - joints[j, 2]
            # a . (r x g) summed over the group's axes a
            mx = f * (ry * g[2] - rz * g[1])
            my = f * (rz * g[0] - rx * g[2])
            mz = f * (rx * g[1] - ry * g[0])
            p, k = parents[j], 3 + 3 * group
            if p < 0:
                out[k] += mx
                out[k + 1] += my
                out[k + 2] += mz
            else:
                for i in range(3):
                    out[k + i] += R[p, 0, i] * mx + R[p, 1, i] * my + R[p, 2, i] * mz
        j = parents[j]


@njit(cache=True, nogil=True, fastmath=True)
def surface_row_of_arrays(
    point: Array,
    point_bones: NDArray[np.int32],
    point_weights: Array,
    d_point: Array,
    g: Array,
    rest: Array,
    parents: Ints,
    joint_of_group: Ints,
    group_of_joint: Ints,
    share_of_joint: Array,
    R: Array,
    joints: Array,
    d_rest: Array,
    d_joints: Array,
    n_shape: int,
    out: Array,
) -> None:
    """Derivative of g . p by the pose step and the shape factors: out (3 + 3 G + n_shape).

    p is the surface point whose T-pose position is `point`; g (3,) in the world. The columns of
    rotation group g turn about the axes of the parent bone (geometric Jacobian).
    """
    G = joint_of_group.shape[0]
    for i in range(3):
        out[i] = g[0] if i == 0 else (g[1] if i == 1 else g[2])
    for k in range(3, 3 + 3 * G + n_shape):
        out[k] = 0.0
    for b in range(point_bones.shape[0]):
        wt = point_weights[b]
        if wt == 0.0:
            continue
        bone = point_bones[b]
        dx, dy, dz = point[0] - rest[bone, 0], point[1] - rest[bone, 1], point[2] - rest[bone, 2]
        Px = joints[bone, 0] + R[bone, 0, 0] * dx + R[bone, 0, 1] * dy + R[bone, 0, 2] * dz
        Py = joints[bone, 1] + R[bone, 1, 0] * dx + R[bone, 1, 1] * dy + R[bone, 1, 2] * dz
        Pz = joints[bone, 2] + R[bone, 2, 0] * dx + R[bone, 2, 1] * dy + R[bone, 2, 2] * dz
        j = bone
        while j >= 0:
            group = group_of_joint[j]
            if group >= 0:
                f = wt * share_of_joint[j]
                rx, ry, rz = Px - joints[j, 0], Py - joints[j, 1], Pz - joints[j, 2]
                # a . (r x g) summed over the group's axes a
                mx = f * (ry * g[2] - rz * g[1])
                my = f * (rz * g[0] - rx * g[2])
                mz = f * (rx * g[1] - ry * g[0])
                p = parents[j]
                k = 3 + 3 * group
                if p < 0:
                    out[k] += mx
                    out[k + 1] += my
                    out[k + 2] += mz
                else:
                    for i in range(3):
                        out[k + i] += R[p, 0, i] * mx + R[p, 1, i] * my + R[p, 2, i] * mz
            j = parents[j]
        # g in the bone's frame
        hx = R[bone, 0, 0] * g[0] + R[bone, 1, 0] * g[1] + R[bone, 2, 0] * g[2]
        hy = R[bone, 0, 1] * g[0] + R[bone, 1, 1] * g[1] + R[bone, 2, 1] * g[2]
        hz = R[bone, 0, 2] * g[0] + R[bone, 1, 2] * g[1] + R[bone, 2, 2] * g[2]
        for n in range(n_shape):
            out[3 + 3 * G + n] += wt * (
                hx * (d_point[n, 0] - d_rest[n, bone, 0])
                + hy * (d_point[n, 1] - d_rest[n, bone, 1])
                + hz * (d_point[n, 2] - d_rest[n, bone, 2])
                + g[0] * d_joints[n, bone, 0]
                + g[1] * d_joints[n, bone, 1]
                + g[2] * d_joints[n, bone, 2]
            )


@njit(cache=True, nogil=True, fastmath=True)
def surface_row(
    point: Array,
    point_bones: NDArray[np.int32],
    point_weights: Array,
    d_point: Array,
    g: Array,
    articulation: Articulation,
    posed: PosedJoints,
    d_joints: Array,
    out: Array,
) -> None:
    """Derivative of g . p by the pose step and the shape factors: out (3 + 3 G + N), N being 0
    where the shape does not matter.

    p is the surface point whose T-pose position is `point`; g (3,) in the world. The columns of
    rotation group g turn about the axes of the parent bone (geometric Jacobian).
    """
    parents, group_of_joint, share_of_joint, joint_of_group, d_rest = articulation
    rest, R, joints, _ = posed
    surface_row_of_arrays(
        point, point_bones, point_weights, d_point, g, rest, parents, joint_of_group, group_of_joint,
        share_of_joint, R, joints, d_rest, d_joints, out.shape[0] - 3 - 3 * joint_of_group.shape[0],
        out,
    )  # fmt: skip
