"""Bundle adjustment of all cameras and board positions (Triggs et al. 2000).

The first camera is fixed; the board gives the scale. The pose of the print on the back of a two-sided board is an unknown,
too, if any camera saw it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import scipy  # its submodules load on first use: they take long to import
from numpy.typing import NDArray

from mocapd.calibrate.board.back_side import OFFSET, GluingPrior
from mocapd.calibrate.board.board_motion import board_paths, has_one_neighbour
from mocapd.calibrate.extrinsics.board_reprojection import (
    POSE,
    Observations,
    ReprojectionProblem,
    jacobians,
    residuals_px,
    with_steps,
)
from mocapd.calibrate.extrinsics.corner_noise import (
    corner_deviations_px,
    in_wrong_views,
    motion_deviations_px,
    usual_deviations_px,
)
from mocapd.calibrate.extrinsics.lower_triangles import lower_triangle, solved_lower
from mocapd.calibrate.extrinsics.solution_covariance import asked_covariances
from mocapd.calibrate.extrinsics.sparse_least_squares import least_squares_steps
from mocapd.calibrate.intrinsics.intrinsics_priors import IntrinsicsPriors, MeasuredIntrinsics
from mocapd.geometry.reprojection import INTRINSICS
from mocapd.geometry.rotations import cross_matrices
from mocapd.types import Floats, Ints

_FOLLOWED = 2.0  # longest gap [frames] for estimating the board's motion
_HELD_FOCAL, _HELD_MIDDLE, _HELD_DIST = 0.02, 0.006, (0.05, 0.1, 0.002, 0.002, 0.1)
_STRETCH = 5  # successive positions, whose errors may have a common cause


@dataclass(frozen=True, slots=True)
class BundleParams:
    """Robustness and termination."""

    corner_px: float = 1.0  # initial deviation of a corner; later rounds measure it,
    least_corner_px: float = 0.1  # with this lower bound
    outlier_sigmas: float = 5.0  # a corner with more robust deviations is an outlier,
    least_outlier_px: float = 1.5  # if it has more than this, too
    delay_frames: float = 0.3  # prior deviation of a camera's delay
    rounds: int = 2  # of the board's motion, from the solution before, at least,
    most_rounds: int = 4  # until the delays converge
    settled_frames: float = 0.01
    longest_gap: float = 1.5  # between positions for estimating the motion [frames]
    evaluations: int = 15
    priors: IntrinsicsPriors = field(default_factory=IntrinsicsPriors)
    gluing: GluingPrior = field(default_factory=GluingPrior)


@dataclass(frozen=True, slots=True, eq=False)
class Bundle:
    """The solution, and the mask of its inlier observations (N,).

    `focal_deviation` (C,): standard deviation of each focal length, relative to it; `place_deviation_m` (C,): of each
    camera's position relative to the first; `back_deviation` (4,): of the back's offset, None without views of the
    back.
    """

    scene: ReprojectionProblem
    used: NDArray[np.bool_]
    focal_deviation: Floats
    place_deviation_m: Floats
    back_deviation: Floats | None


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """Residuals and their sparse Jacobian, in standard deviations, as functions of the steps."""

    scene: ReprojectionProblem
    obs: Observations
    corner_px: Floats  # (N,): standard deviations
    size_px: Floats
    params: BundleParams

    @property
    def columns(self) -> int:
        """Intrinsics, cameras but the first, boards, delays but the first, the back if observed."""
        cameras, boards = len(self.scene.delay), len(self.scene.path)
        return cameras * INTRINSICS + (cameras - 1) * (POSE + 1) + boards * POSE + self.of_back

    @property
    def of_back(self) -> int:
        """Parameters of the back's print."""
        return OFFSET if self.obs.on_back.any() else 0

    def steps(self, x: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Intrinsics (C,9), cameras (C,6), boards (V,6), delay (C,) and back (4,) of a vector of parameters."""
        cameras, boards = len(self.scene.delay), len(self.scene.path)
        counts = [cameras * INTRINSICS, (cameras - 1) * POSE, boards * POSE, cameras - 1]
        intrinsics, poses, board_poses, delay, back = np.split(x, np.cumsum(counts))
        poses = np.concatenate([np.zeros(POSE), poses]).reshape(-1, POSE)
        return (
            intrinsics.reshape(-1, INTRINSICS),
            poses,
            board_poses.reshape(-1, POSE),
            np.concatenate([np.zeros(1), delay]),
            back if len(back) else np.zeros(OFFSET),
        )

    def error(self, x: Floats) -> Floats:
        """(2N + priors + C - 1,), and 4 for a back."""
        scene = with_steps(self.scene, *self.steps(x))
        priors = self.params.priors.residuals(scene.intrinsics, self.size_px)
        gluing = self.params.gluing
        return np.concatenate(
            [
                (residuals_px(scene, self.obs) / self.corner_px[:, None]).ravel(),
                priors.ravel(),
                scene.delay[1:] / self.params.delay_frames,
                ((scene.back.offset - gluing.mean) / gluing.deviation)[: self.of_back],
            ]
        )

    def slope(self, x: Floats) -> "scipy.sparse.csr_matrix":
        """d error by x."""
        intrinsics, cameras, boards, delay, back = self.steps(x)
        scene = with_steps(self.scene, intrinsics, cameras, boards, delay, back)
        values = np.concatenate(jacobians(scene, self.obs, cameras, boards), axis=2)
        values /= self.corner_px[:, None, None]
        columns = np.broadcast_to(self._columns()[:, None, :], values.shape)
        rows = np.arange(2 * len(values)).reshape(-1, 2, 1)
        rows = np.broadcast_to(rows, values.shape)
        free = columns >= 0
        corners = scipy.sparse.csr_matrix(
            (values[free], (rows[free], columns[free])), shape=(2 * len(values), self.columns)
        )
        blocks = self.params.priors.slope(scene.intrinsics, self.size_px)
        tight = [1.0 / self.params.delay_frames] * (len(delay) - 1)
        tight += [1.0 / deviation for deviation in self.params.gluing.deviation[: self.of_back]]
        own = scipy.sparse.block_diag(
            [
                *blocks,
                scipy.sparse.csr_matrix((0, self.columns - len(blocks) * INTRINSICS - len(tight))),
                scipy.sparse.csr_matrix(np.diag(tight)),
            ]
        )
        return scipy.sparse.vstack([corners, own]).tocsr()

    def _columns(self) -> Ints:
        """(N, 9+6+6+1+4): the parameters of each observation; -1: fixed."""
        place: Floats = np.arange(1, self.columns + 1, dtype=float)
        parts = [part.astype(np.int64) - 1 for part in self.steps(place)]
        intrinsics, cameras, boards, delay, back = parts
        camera, view = self.obs.camera, self.obs.view
        behind = np.where(self.obs.on_back[:, None], back, -1)
        return np.concatenate(
            [intrinsics[camera], cameras[camera], boards[view], delay[camera, None], behind], axis=1
        )


def adjust_bundle(
    scene: ReprojectionProblem,
    indices: Sequence[int],
    obs: Observations,
    size_px: Floats,
    params: BundleParams | None = None,
) -> Bundle:
    """The best fit of the scene to the observations: intrinsics, cameras, boards and delays.

    `indices` (V,): the frame of each board position; `size_px` (C,2): of the pictures. First a robust solution with
    simultaneous exposures, then one with delays, at last without the outliers.
    """
    params = params or BundleParams()
    one_sided = has_one_neighbour(indices, params.longest_gap)
    corner_px = np.full(len(obs.camera), params.corner_px)
    if params.longest_gap >= _FOLLOWED:
        corner_px = usual_deviations_px(scene, obs, params.corner_px)
    gentle = params if params.priors.measured else _held_lenses(scene, size_px, params)
    scene = _solve(_Problem(scene, obs, corner_px, size_px, gentle), robust=True)
    every = np.ones(len(obs.camera), bool)
    for done in range(params.most_rounds):
        before = scene.delay
        scene = _solve_moving(_Problem(scene, obs, corner_px, size_px, gentle), indices, every)
        settled = np.abs(scene.delay - before).max(initial=0.0) < params.settled_frames
        if done + 1 >= params.rounds and settled:
            break
    for _ in range(2 if gentle is not params else 0):
        right = ~in_wrong_views(scene, obs, _deviation_px(scene, obs, one_sided, params))
        scene = _solve_moving(_Problem(scene, obs, corner_px, size_px, params), indices, right)
    corner_px = corner_deviations_px(scene, obs, params.least_corner_px)
    error_px = np.linalg.norm(residuals_px(scene, obs), axis=1)
    used = error_px <= np.maximum(params.outlier_sigmas * corner_px, params.least_outlier_px)
    corner_px = np.hypot(corner_px, motion_deviations_px(scene, obs, one_sided))
    if params.longest_gap >= _FOLLOWED:
        used &= ~in_wrong_views(scene, obs, corner_px)
    problem = _Problem(scene, obs.of(used), corner_px[used], size_px, params)
    scene = _solve(problem, robust=False)
    return Bundle(scene, used, *_deviations(replace(problem, scene=scene)))


def _deviation_px(
    scene: ReprojectionProblem,
    obs: Observations,
    one_sided: NDArray[np.bool_],
    params: BundleParams,
) -> Floats:
    """(N,): one deviation for all corners, since errors of unconverged delays look like errors of moving corners; plus
    that of the motion."""
    usual_px = usual_deviations_px(scene, obs, params.least_corner_px)
    return np.hypot(usual_px, motion_deviations_px(scene, obs, one_sided))


def _solve_moving(
    problem: _Problem, indices: Sequence[int], right: NDArray[np.bool_]
) -> ReprojectionProblem:
    """The solution from the inlier observations (N,), with the board's motion of the previous solution."""
    scene, obs, params = problem.scene, problem.obs, problem.params
    placed = np.unique(obs.view[right])
    numbers = [indices[v] for v in placed.tolist()]
    boards = replace(scene, scene_from_board=scene.scene_from_board[placed])
    path = np.zeros_like(scene.path)
    path[placed] = board_paths(boards, numbers, params.longest_gap)
    one_sided = np.ones(len(indices), bool)
    one_sided[placed] = has_one_neighbour(numbers, params.longest_gap)
    scene = replace(scene, path=path)
    corner_px = _deviation_px(scene, obs, one_sided, params)
    return _solve(
        _Problem(scene, obs.of(right), corner_px[right], problem.size_px, params), robust=True
    )


def _held_lenses(scene: ReprojectionProblem, size_px: Floats, params: BundleParams) -> BundleParams:
    """Intrinsics near their separate solutions while the motion is unknown: pictures with time errors would distort them,
    and convergence back is slow."""
    if params.longest_gap < _FOLLOWED:
        return params
    lenses = scene.intrinsics
    deviation = np.empty_like(lenses)
    deviation[:, :2] = _HELD_FOCAL * lenses[:, :2]
    deviation[:, 2:4] = _HELD_MIDDLE * size_px[:, :1]
    deviation[:, 4:] = _HELD_DIST
    return replace(
        params, priors=replace(params.priors, measured=MeasuredIntrinsics(lenses.copy(), deviation))
    )


def _solve(problem: _Problem, robust: bool) -> ReprojectionProblem:
    """robust: distant corners weigh less; but for a recording in motion no prior is robust."""
    if problem.params.longest_gap < _FOLLOWED:
        return _solve_at_rest(problem, robust)
    corners = 2 * len(problem.corner_px) if robust else 0
    x = least_squares_steps(
        problem.error, problem.slope, problem.columns, corners, problem.params.evaluations
    )
    return with_steps(problem.scene, *problem.steps(x))


def _solve_at_rest(problem: _Problem, robust: bool) -> ReprojectionProblem:
    """Separate positions, often few and with a poor initial scene: trust regions converge from there, damping alone does
    not.

    Solved in steps y with x = inv(L^T) y, L L^T being the normal matrix at the start.

    In these the problem is nearly isotropic, and LSMR ends after a few iterations; in x it takes hundreds
    along the valleys of focal length and depth.
    """
    start = problem.slope(np.zeros(problem.columns))
    L = lower_triangle((start.T @ start).toarray())

    def step(y: Floats) -> Floats:
        return solved_lower(L, y, 1)

    def slope(y: Floats) -> "scipy.sparse.linalg.LinearOperator":
        J = problem.slope(step(y))
        return scipy.sparse.linalg.LinearOperator(
            J.shape,
            matvec=lambda v: J @ step(v.ravel()),
            rmatvec=lambda u: solved_lower(L, J.T @ u.ravel(), 0),
        )

    solution = scipy.optimize.least_squares(
        lambda y: problem.error(step(y)),
        np.zeros(problem.columns),
        jac=slope,
        method="trf",
        tr_solver="lsmr",
        # full Gauss-Newton steps
        tr_options={"regularize": False, "atol": 1e-7, "btol": 1e-7, "maxiter": 800},
        loss="soft_l1" if robust else "linear",
        ftol=1e-5,
        max_nfev=problem.params.evaluations,
    )
    return with_steps(problem.scene, *problem.steps(step(solution.x)))


def _deviations(problem: _Problem) -> tuple[Floats, Floats, Floats | None]:
    """Of the focal lengths (C,), relative, of the cameras' positions (C,) [m], and of the back's offset (4,)."""
    scene, obs = problem.scene, problem.obs
    cameras = len(scene.delay)
    at_rest = np.zeros(problem.columns)
    J = problem.slope(at_rest)
    error = problem.error(at_rest)
    first = cameras * INTRINSICS
    asked = np.array(
        [
            *(INTRINSICS * np.arange(cameras)),
            *range(first, first + (cameras - 1) * POSE),
            *range(problem.columns - problem.of_back, problem.columns),
        ]
    )
    stretch = np.repeat(obs.view // _STRETCH, 2)
    usual, covariance = asked_covariances(J, error, stretch, asked)
    deviation = np.sqrt(np.diag(usual))
    focal: Floats = deviation[:cameras] / scene.intrinsics[:, 0]
    place_m = np.zeros(cameras)
    for camera in range(1, cameras):
        at = slice(cameras + (camera - 1) * POSE, cameras + camera * POSE)
        pose = scene.camera_from_scene[camera]
        # the centre is -R^T t; a step turns R from the left and shifts t
        by_step = -pose.R.T @ np.hstack([cross_matrices(pose.t_m), np.eye(3)])
        place_m[camera] = np.sqrt(np.trace(by_step @ covariance[at, at] @ by_step.T))
    back = deviation[cameras + (cameras - 1) * POSE :] if problem.of_back else None
    return focal, place_m, back
