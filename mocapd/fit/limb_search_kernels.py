"""Score many poses of one arm against the classified pictures, the rest of the body staying where it is."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays, PosedJoints
from mocapd.body.posing_kernels import quat_matrix, quat_multiply

Array = NDArray[np.float64]


class ArmSamples(NamedTuple):
    """Samples of one arm's surface in the T-pose: middles and normals (S,3), area (S,) [m^2], colour
    (S,); link (S,2): their two bones as places in `chain` (4,), the arm's joints, and weights (S,2)."""

    chain: NDArray[np.int64]
    points: Array
    normals: Array
    area: Array
    colour: NDArray[np.uint8]
    link: NDArray[np.int64]
    weights: Array


@njit(cache=True, nogil=True)
def score_arms(
    hypotheses: Array,
    samples: ArmSamples,
    parents: NDArray[np.int64],
    posed: PosedJoints,
    camera: CameraArrays,
    offset: Array,
    scale: float,
    base_z: NDArray[np.float32],
    image_ids: NDArray[np.uint8],
    pixel_weight: NDArray[np.uint8],
    scores: Array,
) -> None:
    """Add to scores (N,): area seen where the picture has its colour, less half of what it denies [m^2].

    hypotheses (N,3,4): local rotations of collar, upper arm and forearm; the hand keeps straight.
    posed: the body, of which the collar's parent is used. A sample counts when it faces the camera
    and base_z, the depth of the body without this arm, does not hide it.
    """
    chain, points, normals, area, colour, link, weights = samples
    rest, R, joints, quats = posed
    cam_R, cam_t, K, dist = camera
    h, w = image_ids.shape
    n_chain = chain.shape[0]
    G = np.empty((n_chain, 4))
    J = np.empty((n_chain, 3))
    M = np.empty((n_chain, 3, 3))
    A = np.empty((n_chain, 3, 4))
    p0 = parents[chain[0]]
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    k1, k2, p1, p2, k3 = dist[0], dist[1], dist[2], dist[3], dist[4]
    for n in range(hypotheses.shape[0]):
        for i in range(n_chain):
            j = chain[i]
            if i == 0:
                quat_multiply(quats[p0], hypotheses[n, 0], G[0])
                for a in range(3):
                    J[0, a] = joints[p0, a]
                    for b in range(3):
                        J[0, a] += R[p0, a, b] * (rest[j, b] - rest[p0, b])
            else:
                if i < n_chain - 1:
                    quat_multiply(G[i - 1], hypotheses[n, i], G[i])
                else:
                    G[i] = G[i - 1]
                for a in range(3):
                    J[i, a] = J[i - 1, a]
                    for b in range(3):
                        J[i, a] += M[i - 1, a, b] * (rest[j, b] - rest[chain[i - 1], b])
            quat_matrix(G[i], M[i])
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
            if seen == colour[v]:
                score += size
            elif seen > 0:
                score -= 0.5 * size
            else:
                score -= 0.5 * size * pixel_weight[t, u] / 255.0
        scores[n] += score
