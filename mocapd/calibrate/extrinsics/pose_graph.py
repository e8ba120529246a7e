"""Initial extrinsics from a board: a pose graph of cameras, an edge for each pair with common positions."""

from collections.abc import Mapping, Sequence

import numpy as np

from mocapd.calibrate.board.back_side import BackPrint, GluingPrior, usual_back
from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.extrinsics.board_reprojection import (
    POSE,
    Observations,
    ReprojectionProblem,
    residuals_px,
)
from mocapd.calibrate.extrinsics.mirrored_pictures import PrintPose, distances
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, board_pose
from mocapd.errors import ConfigError
from mocapd.geometry.reprojection import intrinsics_row
from mocapd.geometry.rigid_transforms import IDENTITY, RigidTransform, stack
from mocapd.types import Floats

FEWEST_SHARED = 3  # board positions for an edge: one may be wrong


def initial_scene(
    names: Sequence[str],
    intrinsics_of: Mapping[str, Intrinsics],
    views: Mapping[str, Mapping[int, BoardView]],
    board_m: Floats,
    gluing: GluingPrior | None = None,
) -> tuple[ReprojectionProblem, list[int]]:
    """The scene in the first camera's frame, and the indices of its board positions.

    `views[camera][index]`; a back has its usual offset. Cameras need no position common to all: they are chained along
    the spanning tree of the pairs with the most common positions. Raises ConfigError that names cameras without any in
    common with the others.
    """
    back = usual_back(board_m, gluing)
    poses = {
        name: {
            index: camera_from_board(pose, back)
            for index, pose in board_poses(views[name], intrinsics_of[name], board_m).items()
        }
        for name in names
    }
    relative = _span_pose_graph(names, poses)
    intrinsics = np.stack(
        [intrinsics_row(intrinsics_of[name].K, intrinsics_of[name].dist) for name in names]
    )
    camera_from_scene = stack([relative[name] for name in names])

    def scene_of(boards: Sequence[RigidTransform]) -> ReprojectionProblem:
        still = np.zeros(len(names)), np.zeros((len(boards), 2, POSE))
        return ReprojectionProblem(intrinsics, camera_from_scene, stack(boards), *still, back)

    def misfit_px(scene_from_board: RigidTransform, obs: Observations) -> float:
        """Median distance [px] of the corners of one position in all cameras."""
        off_px = residuals_px(scene_of([scene_from_board]), obs)
        return float(np.median(np.linalg.norm(off_px, axis=1)))

    indices = sorted({index for name in names for index in poses[name]})
    boards = []
    for index in indices:
        observing = [name for name in names if index in poses[name]]
        guesses = [relative[name].inverse() @ poses[name][index] for name in observing]
        corners = observations(names, views, [index], board_m)
        boards.append(min(guesses, key=lambda guess: misfit_px(guess, corners)))
    return scene_of(boards), indices


def observations(
    names: Sequence[str],
    views: Mapping[str, Mapping[int, BoardView]],
    indices: Sequence[int],
    board_m: Floats,
    lags: Mapping[str, Mapping[int, float]] | None = None,
) -> Observations:
    """Every corner of these board positions in every camera. `lags[camera][index]`: from the position's instant to
    that picture [frames]; None: none."""
    parts = [
        (camera, place, views[name][index], lags[name][index] if lags else 0.0)
        for camera, name in enumerate(names)
        for place, index in enumerate(indices)
        if index in views[name]
    ]
    counts = [len(view.ids) for _, _, view, _ in parts]
    return Observations(
        np.repeat([camera for camera, _, _, _ in parts], counts),
        np.repeat([place for _, place, _, _ in parts], counts),
        np.concatenate([board_m[view.ids] for _, _, view, _ in parts]),
        np.concatenate([view.corners_px for _, _, view, _ in parts]),
        np.repeat([view.back for _, _, view, _ in parts], counts),
        np.repeat([lag for _, _, _, lag in parts], counts),
    )


def board_poses(
    views: Mapping[int, BoardView], intrinsics: Intrinsics, board_m: Floats
) -> dict[int, PrintPose]:
    """By index; omits views without a valid pose."""
    K, dist = intrinsics.K, intrinsics.dist
    return {
        index: PrintPose(pose, view.back)
        for index, view in views.items()
        if (pose := board_pose(view, board_m, K, dist)) is not None
    }


def camera_from_board(print_pose: PrintPose, back: BackPrint) -> RigidTransform:
    """From the pose of a print on the front, or on a back with this offset."""
    pose = print_pose.camera_from_print
    return pose @ back.board_from_back.inverse() if print_pose.back else pose


def _span_pose_graph(
    names: Sequence[str], poses: Mapping[str, Mapping[int, RigidTransform]]
) -> dict[str, RigidTransform]:
    """camera_from_first of each camera, by Prim's algorithm with the most common positions first."""
    placed: dict[str, RigidTransform] = {names[0]: IDENTITY}
    while len(placed) < len(names):
        pairs = [
            (len(poses[a].keys() & poses[b].keys()), a, b)
            for a in placed
            for b in names
            if b not in placed
        ]
        shared, old, new = max(pairs, key=lambda pair: pair[0])
        if shared < FEWEST_SHARED:
            raise _apart(names, list(placed), poses)
        placed[new] = _relative(poses[new], poses[old]) @ placed[old]
    return placed


def _apart(
    names: Sequence[str], placed: Sequence[str], poses: Mapping[str, Mapping[int, RigidTransform]]
) -> ConfigError:
    alone = [name for name in names if name not in placed]
    if len(placed) == 1 and len(names) > 2:  # the first camera is the isolated one
        others = alone
        if max(len(poses[a].keys() & poses[b].keys()) for a in others for b in others if a != b):
            alone = list(placed)
    counts = ", ".join(f"{name} in {len(poses[name])} pictures" for name in names)
    return ConfigError(
        f"{', '.join(alone)} never sees the board at the same moment as another camera "
        f"(at least {FEWEST_SHARED} moments are needed; the board is seen by {counts})",
        "the room",
        "hold the board where two cameras see it, pair by pair; frames of one index must be of "
        "one moment",
    )


def _relative(a: Mapping[int, RigidTransform], b: Mapping[int, RigidTransform]) -> RigidTransform:
    """a_from_b: the medoid of the estimates of all common positions.

    A small flat board in a picture has two similar poses, and some views have the wrong one: so no mean, but the
    middle one.
    """
    said = [a[index] @ b[index].inverse() for index in sorted(a.keys() & b.keys())]
    return said[int(np.argmin(np.median(distances(stack(said)), axis=1)))]
