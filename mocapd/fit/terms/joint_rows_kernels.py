"""Rows of joints that a camera saw."""

import math

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PosedJoints
from mocapd.body.derivative_kernels import joint_row
from mocapd.fit.terms.point_rows_kernels import add_row
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
_NEAREST_M = 0.2


@kernel
def pull_at_joints(
    seen: Ints,
    xy: Array,
    information: Array,
    farther_m: Array,
    depth_information: Array,
    weights: tuple[float, float, float],
    camera_R: Array,
    camera_t: Array,
    articulation: Articulation,
    posed: PosedJoints,
    H: Array,
    b: Array,
) -> float:
    """Add two rows for each joint of `seen` (N,) that pull it to the ray xy (N,2), and one to its depth beside the hips',
    farther_m (N,); the robust cost (Geman-McClure).

    information (N,3): xx, xy, yy across the ray [1/m^2]; depth_information (N,); weights: of places, how many standard
    deviations leave a quarter of the weight, and of depths.
    """
    weight, robust2, depth_weight = weights[0], weights[1] * weights[1], weights[2]
    joints = posed[2]
    hips_z = camera_t[2]
    for i in range(3):
        hips_z += camera_R[2, i] * joints[0, i]
    cost = 0.0
    across = np.empty((2, 3))
    rows = np.empty((4, 3 + 3 * articulation[3].shape[0]))
    for n in range(seen.shape[0]):
        joint = seen[n]
        x, y, z = camera_t[0], camera_t[1], camera_t[2]
        for i in range(3):
            x += camera_R[0, i] * joints[joint, i]
            y += camera_R[1, i] * joints[joint, i]
            z += camera_R[2, i] * joints[joint, i]
        if z < _NEAREST_M:
            continue
        rx, ry = xy[n, 0] * z - x, xy[n, 1] * z - y
        xx, xy_, yy = information[n, 0], information[n, 1], information[n, 2]
        m2 = xx * rx * rx + 2.0 * xy_ * rx * ry + yy * ry * ry
        trust = 1.0 / (1.0 + m2 / robust2)
        for i in range(3):
            across[0, i] = camera_R[0, i] - x / z * camera_R[2, i]
            across[1, i] = camera_R[1, i] - y / z * camera_R[2, i]
        for k in range(2):
            joint_row(joint, across[k], articulation, posed, rows[k])
        # the two rows made independent: information = L L^T
        l11 = math.sqrt(xx)
        l21 = xy_ / l11
        l22 = math.sqrt(max(yy - l21 * l21, 0.0))
        for q in range(rows.shape[1]):
            rows[2, q] = l11 * rows[0, q] + l21 * rows[1, q]
            rows[3, q] = l22 * rows[1, q]
        add_row(rows[2], l11 * rx + l21 * ry, weight * trust * trust, H, b)
        add_row(rows[3], l22 * ry, weight * trust * trust, H, b)
        cost += weight * m2 * trust
        if joint == 0:
            continue
        off = farther_m[n] - (z - hips_z)
        m2 = depth_information[n] * off * off
        trust = 1.0 / (1.0 + m2 / robust2)
        joint_row(joint, camera_R[2], articulation, posed, rows[0])
        for q in range(3):
            rows[0, q] = 0.0  # hips and joint move together
        add_row(rows[0], off, depth_weight * depth_information[n] * trust * trust, H, b)
        cost += depth_weight * m2 * trust
    return cost


@kernel
def turn_level(
    first: Ints,
    second: Ints,
    apart_m: Array,
    information: float,
    articulation: Articulation,
    posed: PosedJoints,
    H: Array,
    b: Array,
) -> float:
    """Add two rows for each pair of joints (N,) that pull the second as far from the first as apart_m (N,3) says, along x and
    z, wherever both are; the cost. information [1/m^2]."""
    joints = posed[2]
    P = 3 + 3 * articulation[3].shape[0]
    row, less = np.empty(P), np.empty(P)
    cost, along = 0.0, np.zeros(3)
    for n in range(first.shape[0]):
        for axis in range(0, 3, 2):
            along[:] = 0.0
            along[axis] = 1.0
            off = apart_m[n, axis] - joints[second[n], axis] + joints[first[n], axis]
            joint_row(second[n], along, articulation, posed, row)
            joint_row(first[n], along, articulation, posed, less)
            for q in range(row.shape[0]):
                row[q] -= less[q]
            add_row(row, off, information, H, b)
            cost += information * off * off
    return cost
