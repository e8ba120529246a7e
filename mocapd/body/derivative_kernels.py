"""Derivatives of points of the posed body by the pose step and the shape factors: rows of Jacobians."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PosedJoints
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
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


@kernel(fastmath=True, inline="always")
def add_turns(
    bone: int,
    x: float,
    y: float,
    z: float,
    weight: float,
    g: Array,
    articulation: Articulation,
    posed: PosedJoints,
    out: Array,
) -> None:
    """Add to out (3 + 3 G) the derivative of weight * g . p by the rotation groups that carry p = (x, y, z) with a bone."""
    parents, group_of_joint, share_of_joint, _, _ = articulation
    _, R, joints, _ = posed
    j = bone
    while j >= 0:
        group = group_of_joint[j]
        if group >= 0:
            f = weight * share_of_joint[j]
            rx, ry, rz = x - joints[j, 0], y - joints[j, 1], z - joints[j, 2]
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


@kernel
def joint_row(
    joint: int, g: Array, articulation: Articulation, posed: PosedJoints, out: Array
) -> None:
    """Derivative of g . p by the pose step: out (3 + 3 G), p being a joint's centre and g (3,) a direction in the world."""
    parents, _, _, _, _ = articulation
    _, _, joints, _ = posed
    for i in range(3):
        out[i] = g[i]
    out[3:] = 0.0
    bone = parents[joint]  # a joint is a point of the bone above it
    add_turns(
        bone, joints[joint, 0], joints[joint, 1], joints[joint, 2], 1.0, g, articulation, posed, out
    )


@kernel(fastmath=True)
def surface_row(
    point: Array,
    point_bones: NDArray[np.int32],
    point_weights: Array,
    g: Array,
    articulation: Articulation,
    posed: PosedJoints,
    out: Array,
) -> None:
    """Derivative of g . p by the pose step: out (3 + 3 G), p being the surface point whose T-pose position is `point`, g (3,)
    a direction in the world. The columns of a rotation group turn about the axes of the parent bone (geometric Jacobian)."""
    rest, R, joints, _ = posed
    for i in range(3):
        out[i] = g[i]
    out[3:] = 0.0
    for b in range(point_bones.shape[0]):
        wt = point_weights[b]
        if wt == 0.0:
            continue
        bone = point_bones[b]
        dx, dy, dz = point[0] - rest[bone, 0], point[1] - rest[bone, 1], point[2] - rest[bone, 2]
        Px = joints[bone, 0] + R[bone, 0, 0] * dx + R[bone, 0, 1] * dy + R[bone, 0, 2] * dz
        Py = joints[bone, 1] + R[bone, 1, 0] * dx + R[bone, 1, 1] * dy + R[bone, 1, 2] * dz
        Pz = joints[bone, 2] + R[bone, 2, 0] * dx + R[bone, 2, 1] * dy + R[bone, 2, 2] * dz
        add_turns(bone, Px, Py, Pz, wt, g, articulation, posed, out)
