"""Initial extrinsics from a board: a pose graph of cameras, an edge for each pair that shares positions."""

from collections.abc import Mapping, Sequence

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.extrinsics.board_reprojection import (
    Observations,
    ReprojectionProblem,
    residuals_px,
)
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, board_pose
from mocapd.errors import ConfigError
from mocapd.types import Floats

Pose = tuple[Floats, Floats]  # R (3,3), t_m (3,)
FEWEST_SHARED = 3  # board positions that join two cameras: one may be wrong


def first_scene(
    names: Sequence[str],
    lenses: Mapping[str, Intrinsics],
    views: Mapping[str, Mapping[int, BoardView]],
    board_m: Floats,
) -> tuple[ReprojectionProblem, list[int]]:
    """The scene in the first camera's frame, and the indices of its board positions.

    `views[camera][index]`. Cameras need not all see one position: they are chained along the
    spanning tree of the pairs with the most shared positions. Raises ConfigError that names the
    cameras which share none with the others.
    """
    poses = {name: _poses(views[name], lenses[name], board_m) for name in names}
    relative = _chained(names, poses)
    lens = np.stack([lens_row(lenses[name]) for name in names])
    camera_turn = np.stack([relative[name][0] for name in names])
    camera_t_m = np.stack([relative[name][1] for name in names])
    indices = sorted({index for name in names for index in poses[name]})
    boards = []
    for index in indices:
        seen = [name for name in names if index in poses[name]]
        guesses = [_product(_inverse(relative[name]), poses[name][index]) for name in seen]
        errors = [
            _misfit(guess, names, views, index, (lens, camera_turn, camera_t_m), board_m)
            for guess in guesses
        ]
        boards.append(guesses[int(np.argmin(errors))])
    board_turn = np.stack([R for R, _ in boards])
    board_t_m = np.stack([t for _, t in boards])
    still = np.zeros(len(names)), np.zeros((len(indices), 2, 6))
    return ReprojectionProblem(
        lens, camera_turn, camera_t_m, board_turn, board_t_m, *still
    ), indices


def observations(
    names: Sequence[str],
    views: Mapping[str, Mapping[int, BoardView]],
    indices: Sequence[int],
    board_m: Floats,
) -> Observations:
    """Every corner of these board positions in every camera."""
    parts = [
        (camera, place, views[name][index])
        for camera, name in enumerate(names)
        for place, index in enumerate(indices)
        if index in views[name]
    ]
    counts = [len(view.ids) for _, _, view in parts]
    return Observations(
        np.repeat([camera for camera, _, _ in parts], counts),
        np.repeat([place for _, place, _ in parts], counts),
        np.concatenate([board_m[view.ids] for _, _, view in parts]),
        np.concatenate([view.corners_px for _, _, view in parts]),
    )


def _poses(views: Mapping[int, BoardView], lens: Intrinsics, board_m: Floats) -> dict[int, Pose]:
    found = {index: board_pose(view, board_m, lens.K, lens.dist) for index, view in views.items()}
    return {index: pose for index, pose in found.items() if pose is not None}


def lens_row(lens: Intrinsics) -> Floats:
    """(9,): fx fy cx cy k1 k2 p1 p2 k3."""
    K = lens.K
    return np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2], *lens.dist])


def _chained(names: Sequence[str], poses: Mapping[str, Mapping[int, Pose]]) -> dict[str, Pose]:
    """camera_from_first of each camera, by Prim's tree with the most shared positions first."""
    placed: dict[str, Pose] = {names[0]: (np.eye(3), np.zeros(3))}
    while len(placed) < len(names):
        pairs = [
            (len(poses[a].keys() & poses[b].keys()), a, b)
            for a in placed
            for b in names
            if b not in placed
        ]
        shared, known, new = max(pairs, key=lambda pair: pair[0])
        if shared < FEWEST_SHARED:
            raise _apart(names, list(placed), poses)
        placed[new] = _product(_relative(poses[new], poses[known]), placed[known])
    return placed


def _apart(
    names: Sequence[str], placed: Sequence[str], poses: Mapping[str, Mapping[int, Pose]]
) -> ConfigError:
    alone = [name for name in names if name not in placed]
    if len(placed) == 1 and len(names) > 2:  # it is the first that is alone
        others = alone
        if max(len(poses[a].keys() & poses[b].keys()) for a in others for b in others if a != b):
            alone = list(placed)
    seen = ", ".join(f"{name} in {len(poses[name])} pictures" for name in names)
    return ConfigError(
        f"{', '.join(alone)} never sees the board at the same moment as another camera "
        f"(at least {FEWEST_SHARED} moments are needed; the board is seen by {seen})",
        "the room",
        "hold the board where two cameras see it, pair by pair; frames of one index must be of "
        "one moment",
    )


def _relative(a: Mapping[int, Pose], b: Mapping[int, Pose]) -> Pose:
    """a_from_b: of what each shared position says, the one nearest to all others.

    A flat board seen small has two poses that look alike, and some views take the wrong one: no
    mean, but the middle one.
    """
    said = [_product(a[index], _inverse(b[index])) for index in sorted(a.keys() & b.keys())]
    R = np.stack([one[0] for one in said])
    t = np.stack([one[1] for one in said])
    cosines = np.clip((np.einsum("aij,bij->ab", R, R) - 1.0) / 2.0, -1.0, 1.0)
    far = np.arccos(cosines) + np.linalg.norm(t[:, None] - t, axis=2)  # 1 rad as bad as 1 m
    return said[int(np.argmin(np.median(far, axis=1)))]


def _product(a: Pose, b: Pose) -> Pose:
    return a[0] @ b[0], a[0] @ b[1] + a[1]


def _inverse(a: Pose) -> Pose:
    return a[0].T, -a[0].T @ a[1]


def _misfit(
    guess: Pose,
    names: Sequence[str],
    views: Mapping[str, Mapping[int, BoardView]],
    index: int,
    cameras: tuple[Floats, Floats, Floats],
    board_m: Floats,
) -> float:
    """Median distance [px] of the corners of one position in all cameras."""
    seen = observations(names, views, [index], board_m)
    scene = ReprojectionProblem(
        *cameras, guess[0][None], guess[1][None], np.zeros(len(names)), np.zeros((1, 2, 6))
    )
    return float(np.median(np.linalg.norm(residuals_px(scene, seen), axis=1)))
