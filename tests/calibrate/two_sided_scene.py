"""Four simulated webcams around a wearer who holds a board that is printed on both sides."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec, corners_m
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, project
from mocapd.sim.board.board_picture import PrintedBoard
from mocapd.types import Camera, Floats, Rig
from tests.geometry.rigs import looking_at

# the default board on A1, on cardboard, glued on as well as a person does it
SPEC = BoardSpec(BoardKind.CHARUCO, 5, 7, 0.11, 0.0825, two_sided=True)
PRINT = PrintedBoard(
    5, 7, 0.11, 0.0825, "DICT_4X4_1000", two_sided=True,
    thickness_m=0.005, back_shift_m=(0.0012, -0.0008), back_turn_rad=0.004,
)  # fmt: skip
MIDDLE_M = np.array([0.275, 0.385, 0.0])
Pose = tuple[Floats, Floats]


def cameras_around(radius_m: float = 2.0) -> tuple[Camera, ...]:
    """A quarter of a turn apart, at different heights."""
    angles = np.radians([40.0, 130.0, 225.0, 315.0])
    return tuple(
        looking_at(
            f"cam{i}",
            np.array([radius_m * np.sin(a), 1.2 + 0.15 * i, radius_m * np.cos(a)]),
            np.array([0.0, 0.75, 0.0]),
        )
        for i, a in enumerate(angles)
    )


def turned_poses(n: int, seed: int = 4) -> list[Pose]:
    """world_from_board: held up, its front to all sides one after the other, tilted, here and there."""
    rng = np.random.default_rng(seed)
    poses = []
    for i in range(n):
        around = rotations.exp(np.array([0.0, 2.0 * np.pi * i * 0.618, 0.0]))
        tilt = rotations.exp(np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(-0.8, 0.8)]))
        # x right, y down and z away from somebody who looks along -z of the world
        R = rotations.to_matrix(rotations.multiply(around, tilt)) @ np.diag([1.0, -1.0, -1.0])
        place = rng.uniform([-0.3, 0.55, -0.3], [0.3, 1.15, 0.3])
        poses.append((R, place - R @ MIDDLE_M))
    return poses


def lying() -> Pose:
    """world_from_board of a board flat on the floor, front up, its middle at the origin."""
    R = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    return R, -R @ MIDDLE_M


def hidden_from(i: int) -> int:
    """The camera before which the wearer stands at position i: no position is seen by all four."""
    return i % 4


def view_of(
    camera: Camera, pose: Pose, index: int, board: PrintedBoard = PRINT, noise_px: float = 0.1
) -> BoardView | None:
    """The corners that a camera has in its picture, of the side that it sees; None at a slant or outside."""
    R, t_m = pose
    away = R[:, 2] @ (R @ MIDDLE_M + t_m - centre(camera))
    away /= np.linalg.norm(R @ MIDDLE_M + t_m - centre(camera))
    points_m = corners_m(SPEC)
    back = bool(away < 0.0)
    if abs(away) < 0.35:
        return None
    if back:
        c, s = np.cos(board.back_turn_rad), np.sin(board.back_turn_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        shift_m = np.array([*board.back_shift_m, board.thickness_m])
        points_m = (points_m - MIDDLE_M) @ turn.T + MIDDLE_M + shift_m
    px = project(camera, points_m @ R.T + t_m)
    px = px + noise_px * np.random.default_rng([index, len(camera.name)]).standard_normal(px.shape)
    if not ((px > 0) & (px < np.array(camera.size_px) - 1)).all():
        return None
    return BoardView(index, np.arange(len(px)), px, 0.4, back)


def views_of(
    rig: Sequence[Camera], poses: Sequence[Pose], board: PrintedBoard = PRINT
) -> dict[str, dict[int, BoardView]]:
    """By camera and index, each position hidden from one camera."""
    return {
        camera.name: {
            i: view
            for i, pose in enumerate(poses)
            if c != hidden_from(i) and (view := view_of(camera, pose, i, board)) is not None
        }
        for c, camera in enumerate(rig)
    }


def mirrored(views: dict[int, BoardView], width_px: int = 640) -> dict[int, BoardView]:
    """As in a mirrored picture: left is right, and what is seen passes for the other side."""
    return {
        i: replace(
            view,
            corners_px=view.corners_px * [-1.0, 1.0] + [width_px - 1.0, 0.0],
            back=not view.back,
        )
        for i, view in views.items()
    }


def true_lenses(rig: Sequence[Camera]) -> dict[str, Intrinsics]:
    """As the step Lens finds them."""
    free = np.ones(5, bool)
    return {c.name: Intrinsics(c.size_px, c.K, c.dist, free, 0.1, 0.1, (), (), 0.003) for c in rig}


def off_m(true: Sequence[Camera], found: Rig) -> tuple[Floats, float]:
    """How far each camera (C,) is from its place [m], and by what part distances between them are too long.

    Where front is in the room is not known to a rig all around: it is turned about the floor's normal
    to fit best, and nothing else.
    """
    a = np.array([centre(camera) for camera in true])
    b = np.array([centre(camera) for camera in found.cameras])
    plane_a, plane_b = a[:, 0] + 1j * a[:, 2], b[:, 0] + 1j * b[:, 2]
    turn = np.vdot(plane_b, plane_a)
    plane_b = plane_b * turn / abs(turn)
    error = np.hypot(abs(plane_a - plane_b), a[:, 1] - b[:, 1])
    pairs = np.triu_indices(len(a), 1)
    far_a, far_b = (np.linalg.norm(x[:, None] - x, axis=2)[pairs] for x in (a, b))
    return error, float(far_b.sum() / far_a.sum() - 1.0)
