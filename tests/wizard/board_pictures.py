"""Pictures of the board for the steps that look at it, made once."""

from functools import cache

import numpy as np

from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.geometry import rotations
from mocapd.sim.board.board_picture import BoardFilm
from mocapd.types import Bytes, Camera, Floats
from mocapd.wizard.draft import DraftCamera
from tests.calibrate.board_scenes import PRINT, cameras, floor_pose, held_poses, middle_m
from tests.calibrate.seen_once import never_written

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052)
RIG = cameras(2)
EMPTY = never_written(np.full((480, 640, 3), 110, np.uint8))

# where the board's middle is in the picture, how far [m], and its turn (rotation vector [rad])
_CLOSE = (
    (0.30, 0.32, 0.62, (0.5, 0.1, 0.0)),
    (0.68, 0.34, 0.62, (0.4, -0.4, 0.0)),
    (0.70, 0.66, 0.62, (-0.5, -0.2, 0.1)),
    (0.32, 0.66, 0.64, (-0.4, 0.5, 0.0)),
    (0.50, 0.50, 0.55, (0.0, 0.0, 0.0)),
    (0.50, 0.50, 0.85, (0.0, 0.7, 0.8)),
    (0.45, 0.55, 0.80, (0.7, 0.0, 1.5)),
    (0.24, 0.50, 0.70, (0.1, 0.6, 0.2)),
    (0.76, 0.50, 0.70, (-0.1, -0.6, 0.2)),
    (0.50, 0.28, 0.70, (0.6, 0.2, 1.4)),
    (0.50, 0.74, 0.70, (-0.6, -0.2, 1.5)),
    (0.60, 0.42, 0.90, (-0.4, -0.5, 0.4)),
)


def draft_cameras(rig: tuple[Camera, ...] = RIG) -> tuple[DraftCamera, ...]:
    """The rig's cameras as those chosen."""
    return tuple(DraftCamera(one.name, f"sim:{one.name}", one.size_px) for one in rig)


def close_poses(camera: Camera, tilted: bool = True) -> list[tuple[Floats, Floats]]:
    """world_from_board: shown to one camera, all over its picture."""
    poses = []
    for u, v, distance_m, turn in _CLOSE:
        pixel = np.array([u * camera.size_px[0], v * camera.size_px[1], 1.0])
        middle = distance_m * np.linalg.solve(camera.K, pixel)
        R = rotations.to_matrix(rotations.exp(np.array(turn) if tilted else np.zeros(3)))
        t_m = middle - R @ middle_m()
        poses.append((camera.R.T @ R, camera.R.T @ (t_m - camera.t_m)))
    return poses


@cache
def film(camera: int) -> BoardFilm:
    """The camera's view of the board."""
    return BoardFilm(RIG[camera], PRINT)


@cache
def close_pictures(camera: int, tilted: bool = True, first: int = len(_CLOSE)) -> tuple[Bytes, ...]:
    """What this camera sees while the board is shown to it, at the first so many places."""
    return tuple(_close_picture(camera, tilted, i) for i in range(first))


@cache
def _close_picture(camera: int, tilted: bool, i: int) -> Bytes:
    pose = close_poses(RIG[camera], tilted)[i]
    return never_written(film(camera).picture(*pose, seed=i))


@cache
def held_pictures() -> tuple[dict[str, Bytes], ...]:
    """What both cameras see while the board is held in the play area, place by place."""
    return tuple(
        {
            one.name: never_written(film(c).picture(*pose, seed=100 * c + i))
            for c, one in enumerate(RIG)
        }
        for i, pose in enumerate(held_poses(11))
    )


@cache
def floor_pictures() -> dict[str, Bytes]:
    """The board on the floor."""
    return {
        one.name: never_written(film(c).picture(*floor_pose(), seed=50 + c))
        for c, one in enumerate(RIG)
    }
