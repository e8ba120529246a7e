"""A camera's intrinsics and distortion from pictures of a flat board (Zhang, A Flexible New Technique, PAMI 2000)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.errors import ConfigError
from mocapd.geometry.reprojection import camera_matrix, intrinsics_row, project_rows
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.types import Floats

# Which of k1 k2 p1 p2 k3 to solve for, the simplest first: a board that never comes near the edges of
# the picture does not constrain the higher ones, and a wrong one is worse than none.
_MODELS = (
    (True, False, False, False, False),
    (True, True, False, False, False),
    (True, True, True, True, False),
    (True, True, True, True, True),
)
_FOLDS = 4
# its type stubs do not allow leaving out the first guess
_CALIBRATE: Any = cv2.calibrateCameraExtended
_USUAL_FOCAL = 0.95  # in picture widths
_WORTH = 0.97  # a further coefficient must lower the held-out error to this part of it
# requirements for using intrinsics
FEWEST_VIEWS = 6
# of pictures up to 1280 px wide, in larger ones in proportion
_MOST_RMS_PX, _MOST_HELD_OUT_PX = 1.5, 2.0
_LEAST_TILT_RAD = 0.17  # between the boards of the most different views
_VIEW_RMS = 2.5  # a view with more than this many times the median error is an outlier


@dataclass(frozen=True, slots=True, eq=False)
class Intrinsics:
    """K (3,3) [px], dist (5,) k1 k2 p1 p2 k3, of pictures of `size_px`; `free` (5,): which were solved for.

    `rms_px`: of the views in the solution. `held_out_px`: cross-validation error, with only the board's pose fitted
    to each held-out view. `views`: indices of the views in the solution; `thrown_out`: of the outliers.
    `focal_deviation`: standard deviation of the focal length relative to it.
    """

    size_px: tuple[int, int]
    K: Floats
    dist: Floats
    free: NDArray[np.bool_]
    rms_px: float
    held_out_px: float
    views: tuple[int, ...]
    thrown_out: tuple[int, ...]
    focal_deviation: float

    def trusted(self, views: Mapping[int, BoardView]) -> dict[int, BoardView]:
        """Without the views that contradict this lens, by index: they are outliers of time and room, too."""
        return {index: view for index, view in views.items() if index not in self.thrown_out}


@dataclass(frozen=True, slots=True, eq=False)
class _Solution:
    rms_px: float
    K: Floats
    dist: Floats
    rotations: list[Floats]
    deviations: Floats
    per_view_px: Floats


def solve_intrinsics(
    views: Sequence[BoardView],
    board_m: Floats,
    size_px: tuple[int, int],
    where: str,
    most_deviation: float = 0.05,
) -> Intrinsics:
    """The intrinsics of camera `where`. Raises ConfigError naming what is wrong with the views.

    `board_m` (n,3): the board's corners by id; most_deviation: standard deviation of the focal length, relative to it.
    """
    if len(views) < FEWEST_VIEWS:
        raise ConfigError(
            f"the board is usable in {len(views)} pictures, a lens needs {FEWEST_VIEWS}",
            where,
            "show the board at more places and slants, in good light",
        )
    inliers = list(views)
    first = _solve(inliers, board_m, size_px, _MODELS[1], where)
    _refuse_parallel(first, views, board_m, size_px, where)
    bad = first.per_view_px > max(_VIEW_RMS * float(np.median(first.per_view_px)), 0.5)
    inliers = [view for view, out in zip(views, bad, strict=True) if not out]
    if len(inliers) < FEWEST_VIEWS:
        raise ConfigError(
            f"{int(bad.sum())} of {len(views)} views contradict the others",
            where,
            "give the size of the board as it is printed, and keep the board flat",
        )
    if bad.any():  # an outlier may have been the only view with another tilt
        first = _solve(inliers, board_m, size_px, _MODELS[1], where)
        _refuse_parallel(first, inliers, board_m, size_px, where)
    model, held_out_px = _best_model(inliers, board_m, size_px, where, first)
    solution = _solve(inliers, board_m, size_px, model, where, first)
    deviation = float((solution.deviations[:2] / np.diag(solution.K)[:2]).max())
    intrinsics = Intrinsics(
        size_px,
        solution.K,
        solution.dist,
        np.array(model),
        solution.rms_px,
        held_out_px,
        tuple(view.index for view in inliers),
        tuple(view.index for view, out in zip(views, bad, strict=True) if out),
        deviation,
    )
    _refuse_bad(intrinsics, where, most_deviation)
    return intrinsics


def _solve(
    views: Sequence[BoardView],
    board_m: Floats,
    size_px: tuple[int, int],
    model: tuple[bool, ...],
    where: str,
    start: _Solution | None = None,
) -> _Solution:
    """`start`: a solution of nearly the same views, which shortens the search."""
    k1, k2, p1, _, k3 = model
    flags = 0 if k3 else cv2.CALIB_FIX_K3
    flags |= (0 if k2 else cv2.CALIB_FIX_K2) | (0 if k1 else cv2.CALIB_FIX_K1)
    flags |= 0 if p1 else cv2.CALIB_ZERO_TANGENT_DIST
    K, dist = None, None
    if start is not None:
        flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        K, dist = start.K.copy(), np.where(model, start.dist, 0.0)
    try:
        result: Any = _CALIBRATE(
            [board_m[view.ids].astype(np.float32) for view in views],
            [view.corners_px.astype(np.float32) for view in views],
            size_px,
            K,
            dist,
            flags=flags,
        )
    except cv2.error:
        raise _parallel(where) from None
    rms_px, K, dist, rotations, _, deviations, _, per_view_px = result
    assert K is not None
    assert dist is not None
    if not (np.isfinite(K).all() and np.isfinite(dist).all() and K[0, 0] > 0 and K[1, 1] > 0):
        raise _parallel(where)
    return _Solution(
        float(rms_px),
        K,
        dist.ravel()[:5],
        [cv2.Rodrigues(r)[0] for r in rotations],
        deviations.ravel(),
        per_view_px.ravel(),
    )


def _best_model(
    views: Sequence[BoardView],
    board_m: Floats,
    size_px: tuple[int, int],
    where: str,
    start: _Solution,
) -> tuple[tuple[bool, ...], float]:
    """The simplest set of coefficients by cross-validation, and its held-out error [px]."""
    best, error_px = _MODELS[0], np.inf
    for model in _MODELS:
        squares: list[Floats] = []
        for fold in range(_FOLDS):
            rest = [view for i, view in enumerate(views) if i % _FOLDS != fold]
            solution = _solve(rest, board_m, size_px, model, where, start)
            squares += [
                pose_residuals_px(view, board_m, solution.K, solution.dist) ** 2
                for i, view in enumerate(views)
                if i % _FOLDS == fold
            ]
        held_out_px = float(np.sqrt(np.mean(np.concatenate(squares))))
        if held_out_px < _WORTH * error_px:
            best, error_px = model, held_out_px
    return best, error_px


def larger_than_hd(size_px: tuple[int, int]) -> float:
    """How many times wider than 1280 px, 1 for less: blur and motion of the board grow in px with the picture."""
    return max(1.0, size_px[0] / 1280)


def usual_camera_matrix(size_px: tuple[int, int]) -> Floats:
    """K (3,3) of a usual webcam: good enough to distinguish slants of a board."""
    focal = _USUAL_FOCAL * size_px[0]
    return camera_matrix(np.array([focal, focal, size_px[0] / 2, size_px[1] / 2]))


def board_pose(view: BoardView, board_m: Floats, K: Floats, dist: Floats) -> RigidTransform | None:
    """camera_from_board of one view; None where no pose fits."""
    points_m = board_m[view.ids]
    fits, rotation, t_m = cv2.solvePnP(points_m, view.corners_px, K, dist, flags=cv2.SOLVEPNP_IPPE)
    if not fits:
        return None
    rotation, t_m = cv2.solvePnPRefineLM(points_m, view.corners_px, K, dist, rotation, t_m)
    return RigidTransform(cv2.Rodrigues(rotation)[0].astype(float), t_m.astype(float).ravel())


def pose_residuals_px(view: BoardView, board_m: Floats, K: Floats, dist: Floats) -> Floats:
    """Reprojection errors (n,) of the corners, with the board's pose fitted."""
    camera_from_board = board_pose(view, board_m, K, dist)
    if camera_from_board is None:
        return np.full(len(view.ids), np.inf)
    rows = np.tile(intrinsics_row(K, dist), (len(view.ids), 1))
    expected = project_rows(rows, camera_from_board.apply(board_m[view.ids]))
    distances: Floats = np.linalg.norm(expected - view.corners_px, axis=1)
    return distances


def _parallel(where: str) -> ConfigError:
    return ConfigError(
        "the board is parallel to itself in all views: they leave the focal length open",
        where,
        "tilt the board by 30 degrees and more, to the left and right, up and down",
    )


def _refuse_parallel(
    solution: _Solution,
    views: Sequence[BoardView],
    board_m: Floats,
    size_px: tuple[int, int],
    where: str,
) -> None:
    """Parallel planes share their vanishing line and add nothing to one view (Zhang, section 4).

    Noise makes them yield any focal length, and at a long one it looks like tilts. So they must have tilts at a usual
    one, too.
    """
    K = usual_camera_matrix(size_px)
    usual = [board_pose(view, board_m, K, np.zeros(5)) for view in views]
    pairs = list(zip(views, solution.rotations, usual, strict=True))
    for rotations in (
        [(view, R) for view, R, _ in pairs],
        [(view, pose.R) for view, _, pose in pairs if pose is not None],
    ):
        # of the visible side
        normals = np.stack([(-1.0 if view.back else 1.0) * R[:, 2] for view, R in rotations])
        cosines = np.clip(normals @ normals.T, -1.0, 1.0)
        # a percentile, so that of many views one wrong one does not count as a tilt; of few it does, until it is thrown
        # out
        if np.percentile(np.arccos(cosines), 95) < _LEAST_TILT_RAD:
            raise _parallel(where)


def _refuse_bad(intrinsics: Intrinsics, where: str, most_deviation: float) -> None:
    larger = larger_than_hd(intrinsics.size_px)
    rms_px, held_out_px = intrinsics.rms_px / larger, intrinsics.held_out_px / larger
    if rms_px > _MOST_RMS_PX or held_out_px > _MOST_HELD_OUT_PX:
        raise ConfigError(
            f"the board fits badly: {intrinsics.rms_px:.2f} px, {intrinsics.held_out_px:.2f} px held out",
            where,
            "keep the board flat and still, the focus locked, and check that --board-size, the "
            "layout and the pictures (not cropped or stabilised) are right",
        )
    if intrinsics.focal_deviation > most_deviation:
        raise ConfigError(
            f"the focal length is known to {100 * intrinsics.focal_deviation:.1f} % only",
            where,
            "show the board nearer, and tilted by 30 degrees and more",
        )
