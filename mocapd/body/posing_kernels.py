"""Compiled forward kinematics, skinning and projection; their derivatives are in `derivative_kernels`.

A pose is local rotations (J,4) and a root position (3,). It is moved by a parameter vector: the
root's translation, then a rotation vector for each *rotation group*, applied in the parent bone's
frame. A group is one joint, or several that share a bend (the spine), each taking a share of it.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays, PosedJoints, SkinArrays
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel
def quat_multiply(a: Array, b: Array, out: Array) -> None:
    """out = a * b (xyzw)."""
    ax, ay, az, aw = a[0], a[1], a[2], a[3]
    bx, by, bz, bw = b[0], b[1], b[2], b[3]
    out[0] = aw * bx + ax * bw + ay * bz - az * by
    out[1] = aw * by - ax * bz + ay * bw + az * bx
    out[2] = aw * bz + ax * by - ay * bx + az * bw
    out[3] = aw * bw - ax * bx - ay * by - az * bz


@kernel
def quat_inverse(q: Array, out: Array) -> None:
    """The conjugate of a unit quaternion."""
    out[0], out[1], out[2], out[3] = -q[0], -q[1], -q[2], q[3]


@kernel
def quat_exp(x: float, y: float, z: float, out: Array) -> None:
    """Rotation vector [rad] to a quaternion."""
    angle = np.sqrt(x * x + y * y + z * z)
    s = 0.5 - angle * angle / 48.0 if angle < 1e-4 else np.sin(0.5 * angle) / angle
    out[0], out[1], out[2], out[3] = x * s, y * s, z * s, np.cos(0.5 * angle)


@kernel
def quat_log(q: Array, out: Array) -> None:
    """Quaternion to a rotation vector (3,) [rad] of angle at most pi."""
    s = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    sign = 1.0 if q[3] >= 0.0 else -1.0
    f = 2.0 * sign if s < 1e-9 else 2.0 * np.arctan2(s, sign * q[3]) / s * sign
    out[0], out[1], out[2] = q[0] * f, q[1] * f, q[2] * f


@kernel
def quat_matrix(q: Array, out: Array) -> None:
    """Unit quaternion to a matrix (3,3)."""
    x, y, z, w = q[0], q[1], q[2], q[3]
    out[0, 0] = 1 - 2 * (y * y + z * z)
    out[0, 1] = 2 * (x * y - z * w)
    out[0, 2] = 2 * (x * z + y * w)
    out[1, 0] = 2 * (x * y + z * w)
    out[1, 1] = 1 - 2 * (x * x + z * z)
    out[1, 2] = 2 * (y * z - x * w)
    out[2, 0] = 2 * (x * z - y * w)
    out[2, 1] = 2 * (y * z + x * w)
    out[2, 2] = 1 - 2 * (x * x + y * y)


@kernel
def retract(
    root: Array,
    local: Array,
    step: Array,
    group_of_joint: Ints,
    share_of_joint: Array,
    out_root: Array,
    out_local: Array,
) -> None:
    """The pose moved by `step` (3 + 3 G): out may be the input itself."""
    turn = np.empty(4)
    result = np.empty(4)
    for i in range(3):
        out_root[i] = root[i] + step[i]
    for j in range(local.shape[0]):
        g = group_of_joint[j]
        if g < 0:
            for i in range(4):
                out_local[j, i] = local[j, i]
            continue
        f = share_of_joint[j]
        k = 3 + 3 * g
        quat_exp(f * step[k], f * step[k + 1], f * step[k + 2], turn)
        quat_multiply(turn, local[j], result)
        norm = np.sqrt(
            result[0] * result[0]
            + result[1] * result[1]
            + result[2] * result[2]
            + result[3] * result[3]
        )
        for i in range(4):
            out_local[j, i] = result[i] / norm


@kernel
def difference(
    root_a: Array,
    local_a: Array,
    root_b: Array,
    local_b: Array,
    joint_of_group: Ints,
    share_of_joint: Array,
    out: Array,
) -> None:
    """The step (3 + 3 G) that leads from b to a; a shared group is read off its first joint."""
    inverse = np.empty(4)
    turn = np.empty(4)
    vector = np.empty(3)
    for i in range(3):
        out[i] = root_a[i] - root_b[i]
    for g in range(joint_of_group.shape[0]):
        j = joint_of_group[g]
        quat_inverse(local_b[j], inverse)
        quat_multiply(local_a[j], inverse, turn)
        quat_log(turn, vector)
        for i in range(3):
            out[3 + 3 * g + i] = vector[i] / share_of_joint[j]


@kernel
def forward_kinematics(
    parents: Ints,
    rest: Array,
    root: Array,
    local: Array,
    out_R: Array,
    out_joints: Array,
    out_global: Array,
) -> None:
    """Global rotations as matrices (J,3,3) and quaternions (J,4), and joint centres (J,3)."""
    for j in range(parents.shape[0]):
        p = parents[j]
        if p < 0:
            for i in range(4):
                out_global[j, i] = local[j, i]
            for i in range(3):
                out_joints[j, i] = root[i]
        else:
            quat_multiply(out_global[p], local[j], out_global[j])
            for i in range(3):
                out_joints[j, i] = out_joints[p, i]
                for k in range(3):
                    out_joints[j, i] += out_R[p, i, k] * (rest[j, k] - rest[p, k])
        quat_matrix(out_global[j], out_R[j])


@kernel(fastmath=True)
def skin_and_project(
    vertices: Array,
    skin: SkinArrays,
    posed: PosedJoints,
    camera: CameraArrays,
    offset: Array,
    scale: float,
    out_xy: Array,
    out_depth: Array,
) -> None:
    """Linear blend skinning and projection of T-pose vertices (V,3).

    out_xy (V,2) are pixels of a region: (pixel - offset) * scale, with pixel centres kept at
    integers when pixels are averaged in blocks; out_depth (V,) [m] along the optical axis.
    """
    bones, weights = skin
    rest, R, joints, _ = posed
    cam_R, cam_t, K, dist = camera
    J = rest.shape[0]
    # camera-from-T-pose of every bone, so that a vertex costs one blend of 3x4 matrices
    M = np.empty((J, 3, 4))
    for j in range(J):
        for i in range(3):
            for k in range(3):
                M[j, i, k] = (
                    cam_R[i, 0] * R[j, 0, k] + cam_R[i, 1] * R[j, 1, k] + cam_R[i, 2] * R[j, 2, k]
                )
        for i in range(3):
            M[j, i, 3] = cam_t[i]
            for k in range(3):
                M[j, i, 3] += cam_R[i, k] * joints[j, k] - M[j, i, k] * rest[j, k]
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    k1, k2, p1, p2, k3 = dist[0], dist[1], dist[2], dist[3], dist[4]
    for v in range(vertices.shape[0]):
        X = Y = Z = 0.0
        vx, vy, vz = vertices[v, 0], vertices[v, 1], vertices[v, 2]
        for b in range(bones.shape[1]):
            wt = weights[v, b]
            if wt == 0.0:
                continue
            m = M[bones[v, b]]
            X += wt * (m[0, 0] * vx + m[0, 1] * vy + m[0, 2] * vz + m[0, 3])
            Y += wt * (m[1, 0] * vx + m[1, 1] * vy + m[1, 2] * vz + m[1, 3])
            Z += wt * (m[2, 0] * vx + m[2, 1] * vy + m[2, 2] * vz + m[2, 3])
        out_depth[v] = Z
        if Z <= 0.05:
            out_xy[v, 0] = out_xy[v, 1] = -1e6
            continue
        x, y = X / Z, Y / Z
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        out_xy[v, 0] = (fx * xd + cx - offset[0] + 0.5) * scale - 0.5
        out_xy[v, 1] = (fy * yd + cy - offset[1] + 0.5) * scale - 0.5
