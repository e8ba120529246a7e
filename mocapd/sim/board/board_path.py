"""Where the board is held during a first setup: places, one after the other, as a function of time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, rays
from mocapd.sim.board.board_picture import PrintedBoard
from mocapd.types import Camera, Floats

# u, v of the board's middle in parts of the picture, distance [m], and turns [deg]: pitch about the
# picture's x, yaw about its y, roll in it
_LENS_PLACES = (
    (0.50, 0.50, 1.55, 0, 0, 0), (0.22, 0.28, 1.60, 18, 20, 0), (0.80, 0.24, 1.70, 20, -16, 90),
    (0.80, 0.74, 1.55, -22, -16, 0), (0.20, 0.76, 1.60, -24, 18, 90), (0.50, 0.20, 1.75, 34, 0, 90),
    (0.50, 0.80, 1.65, -34, 4, 90), (0.16, 0.50, 1.65, 4, 28, 0), (0.84, 0.50, 1.65, -4, -28, 0),
    (0.42, 0.45, 1.20, 24, 12, 10), (0.60, 0.55, 1.25, -20, -16, 80), (0.36, 0.38, 1.90, -24, 24, 0),
    (0.66, 0.60, 1.90, 28, -20, 15), (0.50, 0.50, 1.15, 0, 24, 90),
)  # fmt: skip
_LENS_SHARED = 0.5  # how far the board is turned from its camera to the middle of all cameras

# x y z of the middle [m], and turns [deg] from facing the middle of the cameras: pitch, yaw, roll
_ROOM_PLACES = (
    (0.00, 1.10, 0.45, 0, 0, 0), (-0.35, 1.30, 0.30, 18, 14, 0), (0.35, 1.30, 0.30, 20, -14, 90),
    (0.40, 0.85, 0.25, -20, -12, 0), (-0.40, 0.85, 0.25, -18, 12, 90), (0.00, 1.35, 0.05, 24, 0, 90),
    (0.00, 0.75, 0.10, -28, 6, 0), (-0.30, 1.10, -0.10, 5, 20, 45), (0.30, 1.10, -0.10, -5, -20, 0),
    (0.15, 1.00, 0.70, 15, 8, 20), (-0.15, 1.15, 0.70, -20, -8, 70), (0.00, 0.95, -0.25, -25, 0, 0),
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class BoardPlace:
    """Where the board is: its middle [m] and world_from_board quaternion (4,) xyzw."""

    middle_m: Floats
    quat_xyzw: Floats

    def pose(self, board: PrintedBoard) -> tuple[Floats, Floats]:
        """world_from_board R (3,3), t_m (3,)."""
        R = rotations.to_matrix(self.quat_xyzw)
        half = 0.5 * board.square_m * np.array([board.columns, board.rows, 0.0])
        return R, self.middle_m - R @ half


def interpolate(a: BoardPlace, b: BoardPlace, u: float) -> BoardPlace:
    """On the way from a (u = 0) to b (u = 1), starting and ending at rest."""
    s = u * u * (3.0 - 2.0 * u)
    return BoardPlace(
        a.middle_m + s * (b.middle_m - a.middle_m), rotations.slerp(a.quat_xyzw, b.quat_xyzw, s)
    )


def lens_places(cameras: Sequence[Camera]) -> list[BoardPlace]:
    """For each camera in its turn, places that together fill its picture to the corners.

    The others see many of them too.
    """
    eye = np.mean([centre(camera) for camera in cameras], axis=0)
    places = []
    for camera in cameras:
        for u, v, distance_m, *turns_deg in _LENS_PLACES:
            origin, ray = rays(camera, np.array([u, v]) * (np.array(camera.size_px) - 1.0))
            middle = origin + distance_m * ray
            own, shared = (
                rotations.from_matrix(axes) for axes in (camera.R.T, _facing(middle, eye))
            )
            facing = rotations.slerp(own, shared, _LENS_SHARED)
            places.append(_place_of(middle, facing, np.array(turns_deg, dtype=float)))
    return places


def room_places(cameras: Sequence[Camera]) -> list[BoardPlace]:
    """Places in the play area, facing the middle between the cameras and tilted."""
    eye = np.mean([centre(camera) for camera in cameras], axis=0)
    places = []
    for x, y, z, *turns_deg in _ROOM_PLACES:
        middle = np.array([x, y, z])
        facing = rotations.from_matrix(_facing(middle, eye))
        places.append(_place_of(middle, facing, np.array(turns_deg, dtype=float)))
    return places


def floor_place() -> BoardPlace:
    """Flat on the floor in the middle of the play area, printed side up, laid there askew."""
    up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    askew = rotations.exp(np.radians([0.0, 80.0, 0.0]))
    return BoardPlace(np.zeros(3), rotations.multiply(askew, rotations.from_matrix(up)))


def _facing(middle_m: Floats, eye_m: Floats) -> Floats:
    """world_from_board R (3,3) of a board at middle_m, upright, that faces eye_m."""
    away = (middle_m - eye_m) / np.linalg.norm(middle_m - eye_m)
    right = np.cross(away, np.array([0.0, 1.0, 0.0]))
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(away, right), away], axis=-1)


def _place_of(middle_m: Floats, facing_xyzw: Floats, turns_deg: Floats) -> BoardPlace:
    pitch, yaw, roll = (
        rotations.exp(np.radians(angle) * axis)
        for angle, axis in zip(turns_deg, np.eye(3), strict=True)
    )
    turned = rotations.multiply(rotations.multiply(pitch, yaw), roll)
    return BoardPlace(middle_m, rotations.canonical(rotations.multiply(facing_xyzw, turned)))
