"""Reprojection of the board's corners, and its derivatives by intrinsics and poses.

One row per observation: camera c observes corner p of the board in view v, on its front or its back. The
scene's frame is the first camera's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.board.back_side import OFFSET, BackPrint
from mocapd.geometry.reprojection import project_rows, projection_jacobians
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.geometry.rotations import cross_matrices, exp_matrices, left_jacobians
from mocapd.types import Floats, Ints

POSE = 6  # a step of a pose: left rotation vector [rad], shift [m]


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """N corners: camera (N,), view (N,), point_m (N,3) on the board's front, in its frame, pixels (N,2); on_back (N,): on
    the back instead, behind that point. lag (N,): time from the view's instant to this picture, by the camera's clock
    [frames]."""

    camera: Ints
    view: Ints
    point_m: Floats
    pixels: Floats
    on_back: NDArray[np.bool_]
    lag: Floats

    def of(self, keep: NDArray[np.bool_]) -> "Observations":
        """Those of a mask (N,)."""
        return Observations(*(part[keep] for part in self._parts))

    def with_others(self, others: "Observations") -> "Observations":
        """These, and then the others."""
        return Observations(*map(np.concatenate, zip(self._parts, others._parts, strict=True)))

    @property
    def _parts(self) -> tuple[NDArray[Any], ...]:
        return self.camera, self.view, self.point_m, self.pixels, self.on_back, self.lag


@dataclass(frozen=True, slots=True, eq=False)
class ReprojectionProblem:
    """C cameras and V board positions.

    intrinsics (C,9); camera_from_scene (C,); scene_from_board (V,); delay (C,): of a camera's exposure after its clock,
    relative to the first, in frames; path (V,2,6): the board's motion from each position, see `board_motion.board_paths`;
    back: the print on the board's back, if it has one.
    """

    intrinsics: Floats
    camera_from_scene: RigidTransform
    scene_from_board: RigidTransform
    delay: Floats
    path: Floats
    back: BackPrint


def with_steps(
    scene: ReprojectionProblem,
    intrinsics: Floats,
    cameras: Floats,
    boards: Floats,
    delay: Floats,
    back: Floats,
) -> ReprojectionProblem:
    """The scene with steps added: intrinsics (C,9), cameras (C,6), boards (V,6), delay (C,), back (4,)."""
    return ReprojectionProblem(
        scene.intrinsics + intrinsics,
        _apply_steps(scene.camera_from_scene, cameras),
        _apply_steps(scene.scene_from_board, boards),
        scene.delay + delay,
        scene.path,
        scene.back.with_step(back),
    )


def _apply_steps(poses: RigidTransform, steps: Floats) -> RigidTransform:
    """Rotation and translation, each by its own part of the steps (N,6)."""
    return RigidTransform(exp_matrices(steps[:, :3]) @ poses.R, poses.t_m + steps[:, 3:])


def residuals_px(scene: ReprojectionProblem, obs: Observations) -> Floats:
    """(N,2): projected minus observed."""
    arm_m, origin_m, _ = _on_its_way(scene, obs)
    points_m = scene.camera_from_scene[obs.camera].apply(arm_m + origin_m)
    return project_rows(scene.intrinsics[obs.camera], points_m) - obs.pixels


def placed_m(scene: ReprojectionProblem, obs: Observations) -> Floats:
    """(N,3) [m]: positions of the corners in the board's frame, those on the back on the back."""
    if not obs.on_back.any():
        return obs.point_m
    behind_m = scene.back.board_from_back.apply(obs.point_m)
    return np.where(obs.on_back[:, None], behind_m, obs.point_m)


def _on_its_way(scene: ReprojectionProblem, obs: Observations) -> tuple[Floats, Floats, Floats]:
    """The corners at the time of their camera's exposure.

    From the board's origin to the corner (N,3) [m], that origin (N,3) [m], and the rotation (N,3,3)
    since the position's own instant; in the scene.
    """
    delay = (scene.delay[obs.camera] + obs.lag)[:, None]
    path = scene.path[obs.view]
    way = delay * path[:, 0] + delay**2 * path[:, 1]
    since = exp_matrices(way[:, :3])
    scene_from_board = scene.scene_from_board[obs.view]
    at_rest_m = scene_from_board.rotate(placed_m(scene, obs))
    return (
        np.einsum("nij,nj->ni", since, at_rest_m),
        scene_from_board.t_m + way[:, 3:],
        since,
    )


def jacobians(
    scene: ReprojectionProblem, obs: Observations, cameras: Floats, boards: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """d residual by intrinsics (N,2,9), the camera's step (N,2,6), the board's (N,2,6), delay (N,2,1), back
    (N,2,4).

    `scene` already has the steps `cameras` (C,6) and `boards` (V,6).
    """
    arm_m, origin_m, since = _on_its_way(scene, obs)
    camera_from_scene = scene.camera_from_scene[obs.camera]
    turned_m = camera_from_scene.rotate(arm_m + origin_m)
    by_intrinsics, by_point = projection_jacobians(
        scene.intrinsics[obs.camera], turned_m + camera_from_scene.t_m
    )
    spin = left_jacobians(cameras[:, :3])[obs.camera]
    by_camera = np.concatenate([-by_point @ cross_matrices(turned_m) @ spin, by_point], axis=2)
    by_scene = by_point @ camera_from_scene.R
    spin = left_jacobians(boards[:, :3])[obs.view]
    scene_from_board = scene.scene_from_board[obs.view]
    at_rest_m = scene_from_board.rotate(placed_m(scene, obs))
    by_turn = -by_scene @ since @ cross_matrices(at_rest_m) @ spin
    by_board = np.concatenate([by_turn, by_scene], axis=2)
    velocity = _velocity(scene, obs, arm_m)
    by_back, back = np.zeros((len(arm_m), 2, OFFSET)), obs.on_back
    if back.any():
        turned = by_scene[back] @ since[back] @ scene_from_board.R[back]
        by_back[back] = turned @ scene.back.slopes(obs.point_m[back])
    return by_intrinsics, by_camera, by_board, by_scene @ velocity[..., None], by_back


def _velocity(scene: ReprojectionProblem, obs: Observations, arm_m: Floats) -> Floats:
    """(N,3) [m per frame] of the corners in the scene, `arm_m` from the board's origin."""
    path, delay = scene.path[obs.view], (scene.delay[obs.camera] + obs.lag)[:, None]
    speed = path[:, 0] + 2.0 * delay * path[:, 1]
    way = delay * path[:, 0] + delay**2 * path[:, 1]
    turning = np.einsum("nij,nj->ni", left_jacobians(way[:, :3]), speed[:, :3])
    return np.cross(turning, arm_m) + speed[:, 3:]


def corner_speeds_px(scene: ReprojectionProblem, obs: Observations) -> Floats:
    """(N,) [px per frame]: of the corners in the pictures."""
    arm_m, origin_m, _ = _on_its_way(scene, obs)
    camera_from_scene = scene.camera_from_scene[obs.camera]
    points_m = camera_from_scene.apply(arm_m + origin_m)
    _, by_point = projection_jacobians(scene.intrinsics[obs.camera], points_m)
    moving_m = camera_from_scene.rotate(_velocity(scene, obs, arm_m))
    speed: Floats = np.linalg.norm(np.einsum("nij,nj->ni", by_point, moving_m), axis=1)
    return speed
