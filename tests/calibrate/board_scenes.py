"""Simulated cameras before which a simulated board is held: what the tests calibrate from."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.sim.board.board_picture import BoardFilm, BoardLight, PrintedBoard
from mocapd.types import Camera, Floats
from tests.geometry.rigs import looking_at

PRINT = PrintedBoard(5, 6, 0.07, 0.052, "DICT_4X4_1000")
TARGET_M = np.array([0.0, 0.25, 0.0])


def cameras(n: int = 2) -> tuple[Camera, ...]:
    """Webcams with distortion, side by side, about 1 m from where the board is held."""
    x = np.linspace(-0.4, 0.4, n) if n > 1 else np.zeros(1)
    return tuple(
        looking_at(f"cam{i}", np.array([x[i], 0.9 + 0.1 * i, 0.85]), TARGET_M) for i in range(n)
    )


def floor_pose() -> tuple[Floats, Floats]:
    """world_from_board of a board flat on the floor, printed side up, its middle at the origin."""
    R = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    return R, -R @ middle_m()


def middle_m() -> Floats:
    """The middle of the board in its frame."""
    return 0.5 * PRINT.square_m * np.array([PRINT.columns, PRINT.rows, 0.0])


def held_poses(n: int, seed: int = 1, tilt_rad: float = 0.6) -> list[tuple[Floats, Floats]]:
    """world_from_board: held up towards the cameras, tilted all ways, here and there."""
    rng = np.random.default_rng(seed)
    # x right, y down, z away from the cameras, which look down on it a little
    facing = rotations.to_matrix(rotations.exp(np.array([-0.5, 0, 0]))) @ np.diag([1.0, -1.0, -1.0])
    poses = []
    for i in range(n):
        a = 2.0 * np.pi * i * 0.382
        tilt = tilt_rad * np.array([np.sin(a), np.cos(a), 0.3 * np.sin(3 * a)])
        R = rotations.to_matrix(rotations.exp(tilt)) @ facing
        place = TARGET_M + rng.uniform([-0.22, -0.15, -0.15], [0.22, 0.15, 0.2])
        poses.append((R, place - R @ middle_m()))
    return poses


def write_pictures(
    folder: Path,
    rig: Sequence[Camera],
    poses: Sequence[tuple[Floats, Floats]],
    board: PrintedBoard = PRINT,
    light: BoardLight | None = None,
    mirrored: bool = False,
) -> Path:
    """A folder of pictures per camera, of a kind that is quickly read; the folder."""
    for c, camera in enumerate(rig):
        film = BoardFilm(camera, board)
        (folder / camera.name).mkdir(parents=True)
        for i, (R, t_m) in enumerate(poses):
            picture = film.picture(R, t_m, light, seed=100 * c + i)
            if mirrored:
                picture = picture[:, ::-1].copy()
            cv2.imwrite(str(folder / camera.name / f"{i:04d}.bmp"), picture)
    return folder


def corners_px(camera: Camera, board_m: Floats, pose: tuple[Floats, Floats]) -> Floats:
    """Where the camera sees points of the board."""
    R, t_m = pose
    return project(camera, board_m @ R.T + t_m)
