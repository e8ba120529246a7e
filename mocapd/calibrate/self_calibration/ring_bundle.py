"""A camera's pose from sleeve rings: each arm's rings are points at constant distances over all observations.

Bundle adjustment over one camera, the distances between neighbouring rings, and all points, which are
eliminated (Schur complement) [Triggs et al., Bundle adjustment - a modern synthesis, 2000, section 6.1].
From afar the pictures alone leave the orbit of the camera about the wearer nearly free; the constant lengths of the
arms determine it [Koenderink and van Doorn, Affine structure from motion, 1991].
"""

import numpy as np

from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.calibrate.self_calibration.body_rows import N_CAMERA, move_camera
from mocapd.calibrate.self_calibration.ring_pairs import RingPairs
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import camera_from_world, perspective_jacobians, to_camera
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats

_POINT_SD_M = 0.004  # a ring's middle
_LENGTH_SD_M = 0.007  # cloth shifts along the arm
_SPREAD = np.array([0.02, 0.07, 0.09])  # of each length over people, of its mean
# weight of all arms, and the most of one: their errors are correlated between observations
_INDEPENDENT, _MOST = 30.0, 0.25
_ROUNDS = 25
_GENTLE = 3  # first rounds, before rejecting outliers
_POINT_TAIL, _LENGTH_TAIL = 4.0, 6.0  # Geman-McClure, squared standard deviations
_LARGEST_STEP, _FARTHEST_M = 0.2, 0.3


def lengths_m(stature_m: float) -> Floats:
    """(P - 1,): mean distances between neighbouring rings of an arm."""
    rest = standard_skeleton(stature_m).rest_m
    shoulder, elbow, wrist = (rest[INDEX["left" + b]] for b in ("UpperArm", "LowerArm", "Hand"))
    upper, fore = np.linalg.norm(elbow - shoulder), np.linalg.norm(wrist - elbow)
    return np.array([0.55 * upper, 0.55 * fore, 0.4 * fore])


def place_by_rings(
    pairs: RingPairs, first: Camera, second: Camera, covariance: Floats, stature_m: float
) -> tuple[Camera, Floats]:
    """The second camera, and the covariance (6,6) of its motion, from the rings and its prior: pose `second` with this
    covariance of its world motion (v, omega)."""
    usual = lengths_m(stature_m)
    spread = np.zeros(N_CAMERA + len(usual))
    spread[N_CAMERA:] = (_SPREAD * usual) ** -2
    information = np.diag(spread)
    information[:N_CAMERA, :N_CAMERA] = np.linalg.inv(covariance)
    gain = min(_MOST, _INDEPENDENT / max(len(pairs.visible), 1))
    camera, lengths = second, usual.copy()
    points = _start(pairs, first, second)
    for i in range(_ROUNDS):
        H, b, back, own = _ring_system(pairs, first, camera, lengths, points, robust=i >= _GENTLE)
        away = np.concatenate([_motion(second, camera), lengths - usual])
        H = gain * H + information
        step = np.linalg.solve(H, gain * b - information @ away)
        step *= min(1.0, _LARGEST_STEP / max(float(np.abs(step).max()), 1e-12))
        moved = (own - back @ step).reshape(points.shape)
        far = np.linalg.norm(moved, axis=-1, keepdims=True)
        points = points + moved * np.minimum(1.0, _FARTHEST_M / np.maximum(far, 1e-9))
        camera = move_camera(camera, step[:N_CAMERA])
        lengths = lengths + step[N_CAMERA:]
    return camera, np.asarray(np.linalg.inv(H)[:N_CAMERA, :N_CAMERA], dtype=np.float64)


def _ring_system(
    pairs: RingPairs, first: Camera, second: Camera, lengths: Floats, points: Floats, robust: bool
) -> tuple[Floats, Floats, Floats, Floats]:
    """Normal equations H, b of camera motion and lengths, n = N_CAMERA + P - 1, from the rows of all rings and lengths, with
    the points (G,P,3) [m, world] eliminated; (G,3P,n) and (G,3P): derivative of the points by a step, and their own step."""
    G, P = pairs.visible.shape
    n = N_CAMERA + P - 1
    Hxx, Hxc = np.zeros((G, 3 * P, 3 * P)) + 1e-2 * np.eye(3 * P), np.zeros((G, 3 * P, n))
    Hcc, bx, bc = np.zeros((n, n)), np.zeros((G, 3 * P)), np.zeros(n)
    for xy, camera in zip(pairs.xy, (first, second), strict=True):
        r, J, weight = _ring_rows(pairs, xy, camera, points, robust)
        WJ = J * weight[..., None, None]
        for p in range(P):
            at = slice(3 * p, 3 * p + 3)
            Hxx[:, at, at] += np.einsum("gai,gaj->gij", WJ[:, p], J[:, p])
            bx[:, at] += np.einsum("gai,ga->gi", WJ[:, p], r[:, p])
        if camera is second:
            # x -> x + omega x x + v: the rows by omega are x x g
            turn = np.cross(points[:, :, None, :], J)
            C = np.concatenate([J, turn], axis=-1)
            WC = C * weight[..., None, None]
            Hxc[:, :, :N_CAMERA] += np.einsum("gpai,gpaj->gpij", WJ, C).reshape(G, 3 * P, N_CAMERA)
            Hcc[:N_CAMERA, :N_CAMERA] += np.einsum("gpai,gpaj->ij", WC, C)
            bc[:N_CAMERA] += np.einsum("gpai,gpa->i", WC, r)
    for k in range(P - 1):
        way = points[:, k + 1] - points[:, k]
        length = np.maximum(np.linalg.norm(way, axis=1), 1e-6)
        r_m = lengths[k] - length
        weight = (pairs.visible[:, k] & pairs.visible[:, k + 1]) / _LENGTH_SD_M**2
        if robust:
            weight = weight * (1.0 + (r_m / _LENGTH_SD_M) ** 2 / _LENGTH_TAIL) ** -2
        row = np.zeros((G, 3 * P))
        row[:, 3 * k : 3 * k + 3] = -way / length[:, None]
        row[:, 3 * k + 3 : 3 * k + 6] = way / length[:, None]
        Hxx += weight[:, None, None] * row[:, :, None] * row[:, None, :]
        bx += (weight * r_m)[:, None] * row
        Hxc[:, :, N_CAMERA + k] -= weight[:, None] * row
        Hcc[N_CAMERA + k, N_CAMERA + k] += weight.sum()
        bc[N_CAMERA + k] -= float(weight @ r_m)
    back: Floats = np.asarray(np.linalg.solve(Hxx, Hxc), dtype=np.float64)
    own: Floats = np.asarray(np.linalg.solve(Hxx, bx[..., None])[..., 0], dtype=np.float64)
    H = Hcc - np.einsum("gxi,gxj->ij", Hxc, back)
    return H, bc - np.einsum("gxi,gx->i", Hxc, own), back, own


def _ring_rows(
    pairs: RingPairs, xy: Floats, camera: Camera, points: Floats, robust: bool
) -> tuple[Floats, Floats, Floats]:
    """Residuals (G,P,2), their derivatives (G,P,2,3) by the points, and weights (G,P)."""
    at = to_camera(camera, points)
    depth = np.maximum(at[..., 2], 0.2)
    flat = at[..., :2] / depth[..., None]
    J = perspective_jacobians(flat, depth) @ camera.R
    r = xy - flat
    sd = _POINT_SD_M / depth
    weight = pairs.visible / sd**2
    if robust:
        weight = weight * (1.0 + (r**2).sum(axis=-1) / sd**2 / _POINT_TAIL) ** -2
    return r, J, weight


def _start(pairs: RingPairs, first: Camera, second: Camera) -> Floats:
    """Points (G,P,3) where both rays meet; invisible ones are at the middle of the arm."""
    weights = np.broadcast_to(pairs.visible.astype(np.float64), pairs.xy.shape[:-1])
    points, _ = triangulate((first, second), pairs.xy, weights)
    middle = np.nanmean(points, axis=1, keepdims=True)
    middle = np.where(np.isfinite(middle), middle, np.nanmedian(points, axis=(0, 1)))
    return np.where(np.isfinite(points), points, middle)


def _motion(before: Camera, after: Camera) -> Floats:
    """(6,): the world motion from the one camera to the other."""
    motion = camera_from_world(before).inverse() @ camera_from_world(after)
    return np.concatenate([motion.t_m, rotations.log(rotations.from_matrix(motion.R))])
