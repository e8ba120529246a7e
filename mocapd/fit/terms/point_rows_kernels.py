"""Rows of terms that pull at points of the body: at its ankles, at triangles of its surface."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PosedJoints, TriangleArrays
from mocapd.body.derivative_kernels import joint_row, surface_row
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
_FEW = 1e-12


@kernel
def add_row(row: Array, residual: float, information: float, H: Array, b: Array) -> None:
    """One row (P,) to the normal equations H (P,P) and b (P,), of which it may be the first columns."""
    for p in range(row.shape[0]):
        if abs(row[p]) < _FEW:
            continue
        scaled = information * row[p]
        b[p] += scaled * residual
        for q in range(row.shape[0]):
            H[p, q] += scaled * row[q]


@kernel
def stand_on_floor(
    feet: Ints,
    heights_m: Array,
    information: tuple[float, float],
    together_m: float,
    jump_m: float,
    articulation: Articulation,
    posed: PosedJoints,
    H: Array,
    b: Array,
) -> float:
    """Add a row for each ankle or toe joint, feet (F,), that is too low or stands; the cost.

    heights_m (F,): of those of one who stands; information: of what is under the floor and of what is on it;
    together_m: by how much more than the lowest one may be up and still stand; jump_m: height at which
    standing has lost half of its weight.
    """
    up = np.array([0.0, 1.0, 0.0])
    joints = posed[2]
    row = np.empty(3 + 3 * articulation[3].shape[0])
    lowest = np.inf
    for f in range(feet.shape[0]):
        lowest = min(lowest, joints[feet[f], 1] - heights_m[f])
    cost = 0.0
    for f in range(feet.shape[0]):
        above = joints[feet[f], 1] - heights_m[f]
        if above < 0.0:
            weight = information[0]
        elif above <= lowest + together_m:
            weight = information[1] / (1.0 + (above / jump_m) ** 2)
        else:
            continue
        joint_row(feet[f], up, articulation, posed, row)
        add_row(row, -above, weight, H, b)
        cost += weight * above * above
    return cost


@kernel
def hold_on_floor(
    held: Ints,
    places_m: Array,
    information: Array,
    robust_m: float,
    articulation: Articulation,
    posed: PosedJoints,
    H: Array,
    b: Array,
) -> float:
    """Add two rows for each joint of `held` (F,), which pull it to its place on the floor, places_m (F,2) along x and z, with
    information (F,) [1/m^2]; the robust cost. A joint that is robust_m away has a quarter of its weight (Geman-McClure)."""
    joints = posed[2]
    row, along = np.empty(3 + 3 * articulation[3].shape[0]), np.zeros(3)
    cost = 0.0
    for f in range(held.shape[0]):
        joint = held[f]
        x, z = places_m[f, 0] - joints[joint, 0], places_m[f, 1] - joints[joint, 2]
        trust = 1.0 / (1.0 + (x * x + z * z) / (robust_m * robust_m))
        for axis in range(2):
            along[0], along[2] = 1.0 - axis, float(axis)
            joint_row(joint, along, articulation, posed, row)
            add_row(row, z if axis else x, information[f] * trust * trust, H, b)
        cost += information[f] * (x * x + z * z) * trust
    return cost


@kernel
def pull_along_rays(
    triangle: Ints,
    origin: Array,
    rays: Array,
    distance_m: Array,
    information: Array,
    robust_m: float,
    centres: Array,
    surface: TriangleArrays,
    articulation: Articulation,
    posed: PosedJoints,
    H: Array,
    b: Array,
) -> float:
    """Add a row for each triangle (N,) whose distance from origin (3,) along rays (N,3) was measured; the robust cost.

    A residual of robust_m has a quarter of its weight (Geman-McClure). centres (T,3) of the triangles in the T-pose.
    """
    _, triangle_bones, triangle_weights, _, _ = surface
    rest, R, joints, _ = posed
    row = np.empty(3 + 3 * articulation[3].shape[0])
    cost = 0.0
    for n in range(triangle.shape[0]):
        t = triangle[n]
        along = 0.0
        for k in range(triangle_bones.shape[1]):
            wt = triangle_weights[t, k]
            if wt == 0.0:
                continue
            j = triangle_bones[t, k]
            for i in range(3):
                place = joints[j, i]
                for m in range(3):
                    place += R[j, i, m] * (centres[t, m] - rest[j, m])
                along += wt * rays[n, i] * (place - origin[i])
        residual = distance_m[n] - along
        trust = 1.0 / (1.0 + (residual / robust_m) ** 2)
        surface_row(
            centres[t], triangle_bones[t], triangle_weights[t], rays[n], articulation, posed, row
        )
        add_row(row, residual, information[n] * trust * trust, H, b)
        cost += information[n] * residual * residual * trust
    return cost
