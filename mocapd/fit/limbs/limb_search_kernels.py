"""Score many poses of one arm against the classified pictures, the rest of the body staying where it is.

And mirror the bones of a limb in depth: to one camera they look alike."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays, PosedJoints
from mocapd.body.posing_kernels import quat_inverse, quat_matrix, quat_multiply
from mocapd.fit.terms.collision_kernels import ALONG, TorsoSlices, depth_in_torso
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
_EDGE_PX = 2  # by how much the rest of the body may be drawn beside where it is


class ArmSamples(NamedTuple):
    """Samples of one arm's surface in the T-pose: middles and normals (S,3), area (S,) [m^2], label
    (S,); link (S,2): their two bones as places in `chain` (4,), the arm's joints, and weights (S,2)."""

    chain: NDArray[np.int64]
    points: Array
    normals: Array
    area: Array
    label: NDArray[np.uint8]
    link: NDArray[np.int64]
    weights: Array


@kernel
def trunk_depths(
    hypotheses: Array,
    chain: NDArray[np.int64],
    parents: NDArray[np.int64],
    posed: PosedJoints,
    torso: TorsoSlices,
    hips: int,
    chest: int,
    top: int,
    out: Array,
) -> None:
    """How deep each pose of an arm is in the trunk: out (N,) sum of squared depths [m^2]; see `score_arms`."""
    rest, R, joints, quats = posed
    half_m, low_m, high_m = torso
    n_chain = chain.shape[0]
    G = np.empty((n_chain, 4))
    J = np.empty((n_chain, 3))
    M = np.empty((n_chain, 3, 3))
    point = np.empty(3)
    outward = np.empty(3)
    for n in range(hypotheses.shape[0]):
        pose_arm(hypotheses[n], chain, parents, rest, R, joints, quats, G, J, M)
        out[n] = 0.0
        for a in range(ALONG.shape[0]):
            for i in range(3):
                point[i] = J[2, i] + ALONG[a] * (J[3, i] - J[2, i])
            depth = depth_in_torso(
                point, joints[hips], joints[top], R[chest], half_m, low_m, high_m, outward
            )
            out[n] += depth * depth


@kernel
def pose_arm(
    hypothesis: Array,
    chain: NDArray[np.int64],
    parents: NDArray[np.int64],
    rest: Array,
    R: Array,
    joints: Array,
    quats: Array,
    G: Array,
    J: Array,
    M: Array,
) -> None:
    """Global rotations G (4,4), M (4,3,3) and places J (4,3) of an arm's joints, the hand straight."""
    p0 = parents[chain[0]]
    for i in range(chain.shape[0]):
        j = chain[i]
        if i == 0:
            quat_multiply(quats[p0], hypothesis[0], G[0])
            for a in range(3):
                J[0, a] = joints[p0, a]
                for b in range(3):
                    J[0, a] += R[p0, a, b] * (rest[j, b] - rest[p0, b])
        else:
            if i < chain.shape[0] - 1:
                quat_multiply(G[i - 1], hypothesis[i], G[i])
            else:
                for a in range(
                    4
                ):  # by numbers: numba takes seconds to compile an array's assignment
                    G[i, a] = G[i - 1, a]
            for a in range(3):
                J[i, a] = J[i - 1, a]
                for b in range(3):
                    J[i, a] += M[i - 1, a, b] * (rest[j, b] - rest[chain[i - 1], b])
        quat_matrix(G[i], M[i])


@kernel
def is_beside(ids: NDArray[np.uint8], label: int, y0: int, x0: int, reach: int) -> bool:
    """Whether a label is in the square of `reach` pixels around a pixel of ids (h,w)."""
    h, w = ids.shape
    for y in range(max(0, y0 - reach), min(h, y0 + reach + 1)):
        for x in range(max(0, x0 - reach), min(w, x0 + reach + 1)):
            if ids[y, x] == label:
                return True
    return False


@kernel
def score_arms(
    hypotheses: Array,
    samples: ArmSamples,
    parents: NDArray[np.int64],
    posed: PosedJoints,
    camera: CameraArrays,
    offset: Array,
    scale: float,
    base_z: NDArray[np.float32],
    base_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    pixel_weight: NDArray[np.uint8],
    empty: float,
    covered: float,
    depth_m: NDArray[np.float32],
    depth_off_m: float,
    scores: Array,
) -> None:
    """Add to scores (N,): area seen where the picture has its label, less half of what it denies [m^2], and
    less a share `empty`, by pixel_weight, where it has none.

    hypotheses (N,3,4): local rotations of collar, upper arm and forearm; the hand keeps straight.
    posed: the body, of which the collar's parent is used. A sample counts when it faces the camera
    and base_z, the depth of the body without this arm, does not hide it. covered: share of what lies where the rest of
    the body is seen that contradicts; depth_m (h,w): of what is seen, NaN where unknown, or (0,0): a sample that is farther
    than depth_off_m from it is denied, one that is not, well before the rest of the body, is seen.
    """
    chain, points, normals, area, label, link, weights = samples
    rest, R, joints, quats = posed
    cam_R, cam_t, K, dist = camera
    h, w = image_ids.shape
    n_chain = chain.shape[0]
    G = np.empty((n_chain, 4))
    J = np.empty((n_chain, 3))
    M = np.empty((n_chain, 3, 3))
    A = np.empty((n_chain, 3, 4))
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    k1, k2, p1, p2, k3 = dist[0], dist[1], dist[2], dist[3], dist[4]
    knows_depths = depth_m.shape[0] > 0
    for n in range(hypotheses.shape[0]):
        pose_arm(hypotheses[n], chain, parents, rest, R, joints, quats, G, J, M)
        for i in range(n_chain):
            j = chain[i]
            for a in range(3):
                A[i, a, 3] = cam_t[a]
                for b in range(3):
                    A[i, a, b] = (
                        cam_R[a, 0] * M[i, 0, b]
                        + cam_R[a, 1] * M[i, 1, b]
                        + cam_R[a, 2] * M[i, 2, b]
                    )
                for b in range(3):
                    A[i, a, 3] += cam_R[a, b] * J[i, b] - A[i, a, b] * rest[j, b]
        score = 0.0
        for v in range(points.shape[0]):
            X = Y = Z = nx = ny = nz = 0.0
            px, py, pz = points[v, 0], points[v, 1], points[v, 2]
            qx, qy, qz = normals[v, 0], normals[v, 1], normals[v, 2]
            for b in range(2):
                f = weights[v, b]
                if f == 0.0:
                    continue
                m = A[link[v, b]]
                X += f * (m[0, 0] * px + m[0, 1] * py + m[0, 2] * pz + m[0, 3])
                Y += f * (m[1, 0] * px + m[1, 1] * py + m[1, 2] * pz + m[1, 3])
                Z += f * (m[2, 0] * px + m[2, 1] * py + m[2, 2] * pz + m[2, 3])
                nx += f * (m[0, 0] * qx + m[0, 1] * qy + m[0, 2] * qz)
                ny += f * (m[1, 0] * qx + m[1, 1] * qy + m[1, 2] * qz)
                nz += f * (m[2, 0] * qx + m[2, 1] * qy + m[2, 2] * qz)
            facing = -(nx * X + ny * Y + nz * Z)
            if facing <= 0.0 or Z <= 0.05:
                continue
            x, y = X / Z, Y / Z
            r2 = x * x + y * y
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
            yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
            u = round((fx * xd + cx - offset[0] + 0.5) * scale - 0.5)
            t = round((fy * yd + cy - offset[1] + 0.5) * scale - 0.5)
            if u < 0 or u >= w or t < 0 or t >= h:
                continue
            if base_z[t, u] + 0.02 < Z:
                continue
            seen = image_ids[t, u]
            size = area[v] * facing / np.sqrt(X * X + Y * Y + Z * Z)
            if knows_depths:
                away = abs(depth_m[t, u] - Z)
                if away > depth_off_m:
                    score -= size
                    continue
                if away <= depth_off_m and base_z[t, u] - Z > 2.0 * depth_off_m:
                    score += size  # before the rest of the body, whatever their labels are
                    continue
            if seen == label[v]:
                # where the rest of the body has that label, or all but, it is not the arm that is seen
                if not is_beside(base_ids, seen, t, u, _EDGE_PX):
                    score += size
            elif seen > 0 and seen == base_ids[t, u]:
                score -= (
                    covered * size
                )  # the rest of the body is seen there, so the arm is not before it
            elif seen > 0:
                score -= 0.5 * size
            else:
                score -= empty * size * pixel_weight[t, u] / 255.0
        scores[n] += score


@kernel
def _mirror(v: Array, ray: Array, out: Array) -> None:
    """v (3,) with its part along a unit vector (3,) turned round."""
    along = v[0] * ray[0] + v[1] * ray[1] + v[2] * ray[2]
    for i in range(3):
        out[i] = v[i] - 2.0 * along * ray[i]


@kernel
def shortest_turn(a: Array, b: Array, out: Array) -> None:
    """Fill out (4,) with the smallest rotation that turns direction a (3,) into direction b (3,)."""
    scale = np.sqrt((a[0] ** 2 + a[1] ** 2 + a[2] ** 2) * (b[0] ** 2 + b[1] ** 2 + b[2] ** 2))
    w = 1.0 + (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / scale
    out[0] = (a[1] * b[2] - a[2] * b[1]) / scale
    out[1] = (a[2] * b[0] - a[0] * b[2]) / scale
    out[2] = (a[0] * b[1] - a[1] * b[0]) / scale
    out[3] = w
    if w < 1e-6:  # right round, about any axis across
        if abs(a[0]) < 0.9 * np.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2):
            out[0], out[1], out[2], out[3] = 0.0, a[2], -a[1], 0.0
        else:
            out[0], out[1], out[2], out[3] = -a[2], 0.0, a[0], 0.0
    length = np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3])
    for i in range(4):
        out[i] /= length


@kernel
def mirrored_in_depth(
    joints_m: Array, globals_xyzw: Array, parent_xyzw: Array, eye_m: Array, out: Array
) -> None:
    """Fill out (3,2,4) with the local rotations of a limb's two bones, the lower, the upper, both of them mirrored in depth.

    joints_m (3,3): where the bones begin and end; globals_xyzw (2,4): theirs, and that of the bone before, parent_xyzw (4,);
    eye_m (3,): the camera's centre, which sees the middle joint along its ray.
    """
    ray, bones, flipped = np.empty(3), np.empty((2, 3)), np.empty((2, 3))
    turn, inverse = np.empty(4), np.empty(4)
    turned = np.empty((2, 4))
    for i in range(3):
        ray[i] = joints_m[1, i] - eye_m[i]
        bones[0, i], bones[1, i] = joints_m[1, i] - joints_m[0, i], joints_m[2, i] - joints_m[1, i]
    length = np.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    for i in range(3):
        ray[i] /= length
    for k in range(2):
        _mirror(bones[k], ray, flipped[k])
    for n in range(3):
        for k in range(2):
            if n == 2 or k != n:
                shortest_turn(bones[k], flipped[k], turn)
                quat_multiply(turn, globals_xyzw[k], turned[k])
            else:
                for i in range(
                    4
                ):  # by numbers: numba takes seconds to compile an array's assignment
                    turned[k, i] = globals_xyzw[k, i]
        for k in range(2):
            quat_inverse(parent_xyzw if k == 0 else turned[0], inverse)
            quat_multiply(inverse, turned[k], out[n, k])
