"""How deep the arms are in the trunk, and the rows that push them out."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SLICES = 6
ALONG = np.array([0.0, 0.5, 1.0, 1.35])  # from elbow to wrist, the hand beyond
_RADIUS_M = 0.02  # of what is kept outside: less than an arm's, as cloth and flesh give way
_SHALLOW = 0.15  # of the half axes: nearer to the middle no way out is the nearest


class TorsoSlices(NamedTuple):
    """half_m (SLICES,3): half width, half depth, and how far before the line of hips and upper chest the middle is;
    low_m, high_m: the cylinder's ends above the hips, in the T-pose."""

    half_m: Array
    low_m: float
    high_m: float


class ArmChains(NamedTuple):
    """chain (2,4): collar, upper arm, forearm, hand of each side; first (2,): the pose parameter at which an arm's nine
    begin; hips, chest, top: the joints that the trunk is measured by."""

    chain: Ints
    first: Ints
    hips: int
    chest: int
    top: int


@kernel
def depth_in_torso(
    point: Array,
    hips: Array,
    top: Array,
    chest_R: Array,
    half_m: Array,
    low_m: float,
    high_m: float,
    outward: Array,
) -> float:
    """By how much the point (3,) is inside [m], 0 outside: of the smaller half axis, as much as is missing to the surface in
    the ellipse's own measure; outward (3,) is then less its gradient, but for the change of the half axes with height."""
    ax, ay, az = top[0] - hips[0], top[1] - hips[1], top[2] - hips[2]
    length = np.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    dx, dy, dz = point[0] - hips[0], point[1] - hips[1], point[2] - hips[2]
    height = dx * ax + dy * ay + dz * az
    if height <= low_m or height >= high_m:
        return 0.0
    place = (height - low_m) / (high_m - low_m) * half_m.shape[0] - 0.5
    k = min(max(int(np.floor(place)), 0), half_m.shape[0] - 2)
    share = min(max(place - k, 0.0), 1.0)
    wide = (1.0 - share) * half_m[k, 0] + share * half_m[k + 1, 0] + _RADIUS_M
    deep = (1.0 - share) * half_m[k, 1] + share * half_m[k + 1, 1] + _RADIUS_M
    ahead = (1.0 - share) * half_m[k, 2] + share * half_m[k + 1, 2]
    dx, dy, dz = dx - height * ax, dy - height * ay, dz - height * az
    u = (dx * chest_R[0, 0] + dy * chest_R[1, 0] + dz * chest_R[2, 0]) / wide
    v = (dx * chest_R[0, 2] + dy * chest_R[1, 2] + dz * chest_R[2, 2] - ahead) / deep
    rho = np.sqrt(u * u + v * v)
    if rho >= 1.0:
        return 0.0
    size = min(wide, deep)
    gx, gz = size * u / (max(rho, _SHALLOW) * wide), size * v / (max(rho, _SHALLOW) * deep)
    for i in range(3):
        outward[i] = gx * chest_R[i, 0] + gz * chest_R[i, 2]
    along = outward[0] * ax + outward[1] * ay + outward[2] * az
    outward[0] -= along * ax
    outward[1] -= along * ay
    outward[2] -= along * az
    depth: float = size * (1.0 - rho)
    return depth


@kernel
def push_arms_out(
    R: Array,
    joints: Array,
    parents: Ints,
    torso: tuple[Array, float, float],
    arms: tuple[Ints, Ints, int, int, int],
    information: float,
    H: Array,
    b: Array,
) -> float:
    """Add the rows of both arms to H (P,P), b (P,): information [1/m^2] of each point's depth; the cost [of the same unit as
    information times squared metres]. R (J,3,3), joints (J,3) as posed. The trunk does not give way."""
    half_m, low_m, high_m = torso
    chain, first, hips, chest, top = arms
    outward = np.empty(3)
    point = np.empty(3)
    row = np.empty(9)
    cost = 0.0
    for side in range(chain.shape[0]):
        elbow, wrist = joints[chain[side, 2]], joints[chain[side, 3]]
        for a in range(ALONG.shape[0]):
            for i in range(3):
                point[i] = elbow[i] + ALONG[a] * (wrist[i] - elbow[i])
            depth = depth_in_torso(
                point, joints[hips], joints[top], R[chest], half_m, low_m, high_m, outward
            )
            if depth <= 0.0:
                continue
            cost += information * depth * depth
            moving = 2 if a == 0 else 3  # the elbow does not move with the forearm
            for n in range(3):
                for i in range(3):
                    row[3 * n + i] = 0.0
                if n >= moving:
                    continue
                j = chain[side, n]
                p = parents[j]
                lx, ly, lz = (
                    point[0] - joints[j, 0],
                    point[1] - joints[j, 1],
                    point[2] - joints[j, 2],
                )
                # outward . (w x lever) = w . (lever x outward), w in the axes of the bone above
                tx = ly * outward[2] - lz * outward[1]
                ty = lz * outward[0] - lx * outward[2]
                tz = lx * outward[1] - ly * outward[0]
                for i in range(3):
                    row[3 * n + i] = R[p, 0, i] * tx + R[p, 1, i] * ty + R[p, 2, i] * tz
            k = first[side]
            for m in range(9):
                b[k + m] += information * row[m] * depth
                for n in range(9):
                    H[k + m, k + n] += information * row[m] * row[n]
    return cost
