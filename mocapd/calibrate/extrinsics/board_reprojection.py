"""Where the board's corners fall in the pictures, and how that changes with lenses and poses.

One row per observation: camera c saw corner p of the board in view v. All are arrays; poses are
camera_from_world and world_from_board.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats, Ints

LENS = 9  # fx fy cx cy k1 k2 p1 p2 k3
POSE = 6  # left rotation vector [rad], shift [m]
_NEAREST_M = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """N corners seen: camera (N,), view (N,), point_m (N,3) in the board's frame, pixels (N,2)."""

    camera: Ints
    view: Ints
    point_m: Floats
    pixels: Floats

    def of(self, keep: NDArray[np.bool_]) -> "Observations":
        """Those of a mask (N,)."""
        return Observations(
            self.camera[keep], self.view[keep], self.point_m[keep], self.pixels[keep]
        )


@dataclass(frozen=True, slots=True, eq=False)
class ReprojectionProblem:
    """C cameras and V board positions.

    lens (C,9); camera_from_world (C,3,3), (C,3); world_from_board (V,3,3), (V,3); delay (C,): how
    much later a camera exposes than the first, in frames; path (V,2,6): how the board moves on from
    each position, see `board_motion.paths`.
    """

    lens: Floats
    camera_turn: Floats
    camera_t_m: Floats
    board_turn: Floats
    board_t_m: Floats
    delay: Floats
    path: Floats


def exp_matrices(rotvec_rad: Floats) -> Floats:
    """Rotation vectors (N,3) to matrices (N,3,3) (Rodrigues)."""
    angle = np.linalg.norm(rotvec_rad, axis=1)[:, None, None]
    K = cross_matrices(rotvec_rad)
    small = angle < 1e-6
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 1.0, np.sin(safe) / safe)
    b = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    R: Floats = np.eye(3) + a * K + b * (K @ K)
    return R


def left_jacobians(rotvec_rad: Floats) -> Floats:
    """(N,3,3): d exp(w) = [J dw]x exp(w) (Barfoot, State Estimation for Robotics, eq. 7.77)."""
    angle = np.linalg.norm(rotvec_rad, axis=1)[:, None, None]
    K = cross_matrices(rotvec_rad)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    b = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    c = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    J: Floats = np.eye(3) + b * K + c * (K @ K)
    return J


def cross_matrices(v: Floats) -> Floats:
    """(N,3) to (N,3,3): [v]x u = v x u."""
    out = np.zeros((*v.shape[:-1], 3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return out


def moved(
    scene: ReprojectionProblem, lens: Floats, cameras: Floats, boards: Floats, delay: Floats
) -> ReprojectionProblem:
    """The scene with steps added: lens (C,9), cameras (C,6), boards (V,6), delay (C,)."""
    return ReprojectionProblem(
        scene.lens + lens,
        exp_matrices(cameras[:, :3]) @ scene.camera_turn,
        scene.camera_t_m + cameras[:, 3:],
        exp_matrices(boards[:, :3]) @ scene.board_turn,
        scene.board_t_m + boards[:, 3:],
        scene.delay + delay,
        scene.path,
    )


def residuals_px(scene: ReprojectionProblem, seen: Observations) -> Floats:
    """(N,2): projected minus observed."""
    turned, shift_m, _ = _on_its_way(scene, seen)
    world = turned + shift_m
    p = _turned(scene.camera_turn, seen.camera, world) + scene.camera_t_m[seen.camera]
    lens = scene.lens[seen.camera]
    xy = p[:, :2] / np.maximum(p[:, 2:], _NEAREST_M)
    pixels: Floats = _distorted(xy, lens) * lens[:, :2] + lens[:, 2:4]
    return pixels - seen.pixels


def _on_its_way(scene: ReprojectionProblem, seen: Observations) -> tuple[Floats, Floats, Floats]:
    """Of the corners, where the board is when their camera exposes.

    Turned (N,3) about the board's origin [m], that origin (N,3) [m], and the turn (N,3,3) since the position's own instant.
    """
    delay = scene.delay[seen.camera, None]
    path = scene.path[seen.view]
    way = delay * path[:, 0] + delay**2 * path[:, 1]
    since = exp_matrices(way[:, :3])
    turned = _turned(scene.board_turn, seen.view, seen.point_m)
    return (
        np.einsum("nij,nj->ni", since, turned),
        scene.board_t_m[seen.view] + way[:, 3:],
        since,
    )


def _turned(R: Floats, which: Ints, points: Floats) -> Floats:
    turned: Floats = np.einsum("nij,nj->ni", R[which], points)
    return turned


def _distorted(xy: Floats, lens: Floats) -> Floats:
    k1, k2, p1, p2, k3 = lens[:, 4:].T
    x, y = xy.T
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.column_stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ]
    )


def jacobians(
    scene: ReprojectionProblem, seen: Observations, cameras: Floats, boards: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """d residual by lens (N,2,9), the camera's step (N,2,6), the board's (N,2,6), delay (N,2,1).

    `scene` is already moved by the steps `cameras` (C,6) and `boards` (V,6).
    """
    turned, shift_m, since = _on_its_way(scene, seen)
    world = turned + shift_m
    in_camera = _turned(scene.camera_turn, seen.camera, world)
    p = in_camera + scene.camera_t_m[seen.camera]
    lens = scene.lens[seen.camera]
    z = np.maximum(p[:, 2], _NEAREST_M)
    xy = p[:, :2] / z[:, None]
    by_lens = _by_lens(xy, lens)
    by_xy = lens[:, :2, None] * _distortion_slope(xy, lens)
    xy_by_p = np.zeros((len(z), 2, 3))
    xy_by_p[:, 0, 0] = xy_by_p[:, 1, 1] = 1.0 / z
    xy_by_p[:, :, 2] = -xy / z[:, None]
    by_p = by_xy @ xy_by_p
    spin = left_jacobians(cameras[:, :3])[seen.camera]
    by_camera = np.concatenate([-by_p @ cross_matrices(in_camera) @ spin, by_p], axis=2)
    by_world = by_p @ scene.camera_turn[seen.camera]
    spin = left_jacobians(boards[:, :3])[seen.view]
    at_rest = _turned(scene.board_turn, seen.view, seen.point_m)
    by_turn = -by_world @ since @ cross_matrices(at_rest) @ spin
    by_board = np.concatenate([by_turn, by_world], axis=2)
    path, delay = scene.path[seen.view], scene.delay[seen.camera, None]
    speed = path[:, 0] + 2.0 * delay * path[:, 1]
    way = delay * path[:, 0] + delay**2 * path[:, 1]
    turning = np.einsum("nij,nj->ni", left_jacobians(way[:, :3]), speed[:, :3])
    velocity = np.cross(turning, turned) + speed[:, 3:]
    return by_lens, by_camera, by_board, by_world @ velocity[..., None]


def _by_lens(xy: Floats, lens: Floats) -> Floats:
    x, y = xy.T
    r2 = x * x + y * y
    out = np.zeros((len(x), 2, LENS))
    seen = _distorted(xy, lens)
    out[:, 0, 0], out[:, 1, 1] = seen.T
    out[:, 0, 2] = out[:, 1, 3] = 1.0
    fx, fy = lens[:, 0], lens[:, 1]
    for column, power in ((4, r2), (5, r2**2), (8, r2**3)):
        out[:, 0, column], out[:, 1, column] = fx * x * power, fy * y * power
    out[:, 0, 6], out[:, 1, 6] = fx * 2 * x * y, fy * (r2 + 2 * y * y)
    out[:, 0, 7], out[:, 1, 7] = fx * (r2 + 2 * x * x), fy * 2 * x * y
    return out


def _distortion_slope(xy: Floats, lens: Floats) -> Floats:
    """d distorted by undistorted normalised coordinates (N,2,2)."""
    k1, k2, p1, p2, k3 = lens[:, 4:].T
    x, y = xy.T
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3))  # of radial, by x, over x
    out = np.empty((len(x), 2, 2))
    out[:, 0, 0] = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x
    out[:, 1, 1] = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x
    out[:, 0, 1] = out[:, 1, 0] = x * y * slope + 2 * p1 * x + 2 * p2 * y
    return out
