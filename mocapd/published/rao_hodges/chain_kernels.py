"""Poses of all particles of a limb, and which points are inside of their ellipsoids."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Singles = NDArray[np.float32]


@kernel(error_model="numpy")
def _turn(R: Array, axis: Array, angle_rad: float, out: Array) -> None:
    """out (3,3) = R (3,3) times the rotation about a unit axis (3,), by Rodrigues' formula."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = axis[0], axis[1], axis[2]
    d = 1.0 - c
    a00, a01, a02 = c + d * x * x, d * x * y - s * z, d * x * z + s * y
    a10, a11, a12 = d * x * y + s * z, c + d * y * y, d * y * z - s * x
    a20, a21, a22 = d * x * z - s * y, d * y * z + s * x, c + d * z * z
    for i in range(3):
        r0, r1, r2 = R[i, 0], R[i, 1], R[i, 2]
        out[i, 0] = r0 * a00 + r1 * a10 + r2 * a20
        out[i, 1] = r0 * a01 + r1 * a11 + r2 * a21
        out[i, 2] = r0 * a02 + r1 * a12 + r2 * a22


@kernel(error_model="numpy")
def pose_chain(
    angles_rad: Array,
    roots_R: Array,
    roots_m: Array,
    parents: Ints,
    joints_m: Array,
    first_dof: Ints,
    axes: Array,
    R: Array,
    at_m: Array,
) -> None:
    """Rotations and joints of N particles. angles_rad (N,D); roots_R (N,3,3), roots_m (N,3): each one's root in the world;
    the chain as of `ChainArrays`. Fills R (N,E,3,3), world from ellipsoid, and at_m (N,E,3), the joints in the world."""
    for n in range(len(angles_rad)):
        for e in range(len(parents)):
            above = parents[e]
            above_R = roots_R[n] if above < 0 else R[n, above]
            for i in range(3):
                from_m = roots_m[n, i] if above < 0 else at_m[n, above, i]
                at_m[n, e, i] = (
                    from_m
                    + above_R[i, 0] * joints_m[e, 0]
                    + above_R[i, 1] * joints_m[e, 1]
                    + above_R[i, 2] * joints_m[e, 2]
                )
                for j in range(3):
                    R[n, e, i, j] = above_R[i, j]
            for d in range(first_dof[e], first_dof[e + 1]):
                _turn(R[n, e], axes[d], angles_rad[n, d], R[n, e])


@kernel(fastmath=True, error_model="numpy")
def share_inside(
    R: Array,
    at_m: Array,
    centres_m: Array,
    radii_m: Array,
    points_m: Singles,
    nearest: Singles,
    shares: Array,
    held: Array,
) -> None:
    """Which share of points is inside at least one ellipsoid, for each of N particles: the paper's weight.

    R (N,E,3,3), at_m (N,E,3) as of `pose_chain`; centres_m (E,3), radii_m (E,3); points_m (3,P), whose rows are x, y, z.
    Fills shares (N,) and held (N,E), which share of the points each ellipsoid holds, whatever the others do;
    nearest (P,) is for the kernel's own use.
    """
    count = points_m.shape[1]
    xs, ys, zs = points_m[0], points_m[1], points_m[2]
    for n in range(len(shares)):
        for p in range(count):
            nearest[p] = np.float32(4.0)
        for e in range(len(radii_m)):
            # rows of the map from the world to the unit ball: q = M (point - joint) - centre / radius
            r = R[n, e]
            ix, iy, iz = 1.0 / radii_m[e, 0], 1.0 / radii_m[e, 1], 1.0 / radii_m[e, 2]
            a0, a1, a2 = (
                np.float32(r[0, 0] * ix),
                np.float32(r[1, 0] * ix),
                np.float32(r[2, 0] * ix),
            )
            b0, b1, b2 = (
                np.float32(r[0, 1] * iy),
                np.float32(r[1, 1] * iy),
                np.float32(r[2, 1] * iy),
            )
            c0, c1, c2 = (
                np.float32(r[0, 2] * iz),
                np.float32(r[1, 2] * iz),
                np.float32(r[2, 2] * iz),
            )
            jx, jy, jz = (
                np.float32(at_m[n, e, 0]),
                np.float32(at_m[n, e, 1]),
                np.float32(at_m[n, e, 2]),
            )
            u, v, w = (
                np.float32(centres_m[e, 0] * ix),
                np.float32(centres_m[e, 1] * iy),
                np.float32(centres_m[e, 2] * iz),
            )
            inside = 0
            for p in range(count):
                x, y, z = xs[p] - jx, ys[p] - jy, zs[p] - jz
                qx = a0 * x + a1 * y + a2 * z - u
                qy = b0 * x + b1 * y + b2 * z - v
                qz = c0 * x + c1 * y + c2 * z - w
                q = qx * qx + qy * qy + qz * qz
                inside += q <= np.float32(1.0)
                nearest[p] = min(nearest[p], q)
            held[n, e] = inside / max(count, 1)
        inside = 0
        for p in range(count):
            inside += nearest[p] <= np.float32(1.0)
        shares[n] = inside / max(count, 1)
