"""The world frame of the extrinsics: floor, up, front; and the agreement of the cameras."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.extrinsics.board_reprojection import Observations, ReprojectionProblem
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import normalised
from mocapd.geometry.reprojection import camera_matrix
from mocapd.geometry.rigid_transforms import RigidTransform, align_points, nearest_rotation
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats, Rig

_FRONT = 0.2  # least length of the mean direction to the cameras that defines a front


@dataclass(frozen=True, slots=True)
class PlayAreaError:
    """Distance of triangulated corners from a rigid board fitted to them [cm]; with the uncertainty of the cameras'
    positions, see `with_places`."""

    median_cm: float
    p95_cm: float

    def with_places(self, place_cm: float) -> "PlayAreaError":
        """Adds an error of `place_cm` of cameras together with all that they see, which no board shows."""
        return PlayAreaError(
            float(np.hypot(self.median_cm, place_cm)), float(np.hypot(self.p95_cm, place_cm))
        )


def world_on_floor(
    scene: ReprojectionProblem, position: int, middle_m: Floats, where: str, two_sided: bool = False
) -> RigidTransform:
    """world_from_scene of a board that lies on the floor, face up, at this position; its middle is the origin.

    +Z points from there to the middle of the cameras, which a person at rest faces. Raises ConfigError for cameras
    under the floor.
    """
    scene_from_board = scene.scene_from_board[position]
    world = _world(scene, -scene_from_board.R[:, 2], scene_from_board.apply(middle_m))
    heights_m = world.apply(camera_centres(scene))[:, 1]
    if two_sided and heights_m.max() < 0.0:
        raise ConfigError(
            "the board lies there on its front: its back is up, or all pictures are mirrored",
            where,
            "lay it down with the side up that says FRONT; if it did lie so, switch mirroring off in "
            "the cameras or the recorder",
        )
    if heights_m.min() < 0.0:
        raise ConfigError(
            f"with this floor a camera is {-100 * heights_m.min():.0f} cm under it",
            where,
            "lay the board flat on the floor, printed side up, and give the frame in which it lies",
        )
    return world


def guess_world(scene: ReprojectionProblem, board_m: Floats) -> RigidTransform:
    """world_from_scene without a floor: up is up in most pictures, the floor is below the lowest corner."""
    up = -scene.camera_from_scene.R[:, 1].sum(axis=0)
    corners = scene.scene_from_board[:, None].apply(board_m).reshape(-1, 3)
    world = _world(scene, up, corners.mean(axis=0))
    lowest_m = float(world.apply(corners)[:, 1].min())
    return RigidTransform(world.R, world.t_m - np.array([0.0, lowest_m, 0.0]))


def _world(scene: ReprojectionProblem, up: Floats, origin_m: Floats) -> RigidTransform:
    """world_from_scene: up as given, front towards the cameras."""
    y = up / np.linalg.norm(up)
    away = camera_centres(scene) - origin_m
    level = away - np.outer(away @ y, y)
    level /= np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-9)
    front = level.mean(axis=0)
    # cameras all around: the first is the front
    z = front if np.linalg.norm(front) > _FRONT else level[0]
    z = z / np.linalg.norm(z)
    R = np.stack([np.cross(y, z), y, z])
    return RigidTransform(R, -R @ origin_m)


def camera_centres(scene: ReprojectionProblem) -> Floats:
    """(C,3) positions of the cameras [m, scene]."""
    return scene.camera_from_scene.inverse().t_m


def rig_in_world(
    world_from_scene: RigidTransform,
    scene: ReprojectionProblem,
    names: Sequence[str],
    sizes_px: Sequence[tuple[int, int]],
) -> Rig:
    """The cameras of the scene as a rig of this world."""
    cameras = []
    for i, (name, size_px) in enumerate(zip(names, sizes_px, strict=True)):
        camera_from_scene, row = scene.camera_from_scene[i], scene.intrinsics[i]
        # project back onto rotations, from which a thousand products drift
        R = nearest_rotation(camera_from_scene.R @ world_from_scene.R.T)
        t_m = camera_from_scene.t_m - R @ world_from_scene.t_m
        cameras.append(Camera(name, size_px, camera_matrix(row), row[4:].copy(), R, t_m))
    return Rig(tuple(cameras))


def play_area_error(rig: Rig, obs: Observations) -> PlayAreaError | None:
    """Distance of triangulated corners from a rigid board, where two cameras and more see four corners.

    None without such a position of the board.
    """
    keys, corner = np.unique(np.column_stack([obs.view, obs.point_m]), axis=0, return_inverse=True)
    xy = np.full((len(rig.cameras), len(keys), 2), np.nan)
    for i, camera in enumerate(rig.cameras):
        own = obs.camera == i
        xy[i, corner.ravel()[own]] = normalised(camera, obs.pixels[own])
    points_m, _ = triangulate(rig.cameras, xy)
    valid = np.isfinite(points_m).all(axis=1)
    distances = []
    for view in np.unique(keys[valid, 0]):
        own = valid & (keys[:, 0] == view)
        if own.sum() >= 4:
            distances.append(_from_rigid(keys[own, 1:], points_m[own]))
    if not distances:
        return None
    cm = 100.0 * np.concatenate(distances)
    return PlayAreaError(float(np.median(cm)), float(np.percentile(cm, 95)))


def _from_rigid(board_m: Floats, points_m: Floats) -> Floats:
    """Distances (n,) of the points from a board fitted to them."""
    world_from_board = align_points(points_m, board_m)
    distances: Floats = np.linalg.norm(world_from_board.apply(board_m) - points_m, axis=1)
    return distances
