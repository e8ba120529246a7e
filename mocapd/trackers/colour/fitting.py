"""Fit pose and body shape to the classified pictures of all cameras at once, by Gauss-Newton.

Every iteration renders the body's id map into each camera at that camera's own instant, gathers
the rows of `alignment_kernels.accumulate`, adds the priors and solves one small normal equation.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapd.body.joint_limit_kernels import limit_residuals
from mocapd.body.joint_limits import standard_limits
from mocapd.body.model import GROUPS, N_POSE, N_SHAPE, BodyModel, shaped
from mocapd.body.posing_kernels import (
    difference,
    forward_kinematics,
    joint_shape_derivatives,
    retract,
    skin_and_project,
)
from mocapd.body.shape import FACTOR_SD
from mocapd.body.skeleton import N_JOINTS
from mocapd.geometry.rotations import IDENTITY_XYZW
from mocapd.trackers.colour.alignment_kernels import accumulate, spiral
from mocapd.trackers.colour.params import Params
from mocapd.types import Camera, Floats
from mocapd.vision.raster_kernels import label_triangles, rasterise

Roi = tuple[int, int, int, int]  # x0, y0, x1, y1 [work px], x1 and y1 excluded
_MAX_WORK_PX = 480 * 480


@dataclass(frozen=True, slots=True, eq=False)
class MotionState:
    """A pose in motion: root_m (3,), local_xyzw (J,4), velocity (N_POSE,) per second, and what is
    known of the body: factors (N_SHAPE,) with their information matrix (N_SHAPE,N_SHAPE)."""

    root_m: Floats
    local_xyzw: Floats
    velocity: Floats
    factors: Floats
    information: Floats


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's evidence: ids and softness (h,w) over `roi`, taken dt_s after the asked instant."""

    index: int
    roi: Roi
    ids: NDArray[np.uint8]
    softness: NDArray[np.uint8]
    dt_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """The fitted state; per patch (21,) the rendered, matched and wrongly placed pixels; H (P,P): the
    information of the evidence alone on pose and shape."""

    state: MotionState
    visible: Floats
    matched: Floats
    unexplained: Floats
    H: Floats
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class PartialRender:
    """Part of the body drawn in one camera, with the posed joints."""

    ids: NDArray[np.uint8]
    zbuffer: NDArray[np.float32]
    R: Floats
    joints: Floats
    quats: Floats


def initial_information() -> Floats:
    """What is known of the proportions before anybody is seen."""
    return np.diag(1.0 / FACTOR_SD**2)


def _group_values(values: dict[str, tuple[float, float, float]], default: float) -> Floats:
    return np.array([values.get(names[0], (default,) * 3) for names in GROUPS]).ravel()


class Fitter:
    """Buffers and constants for fitting one body in one rig; holds no state between calls."""

    def __init__(
        self, model: BodyModel, cameras: Sequence[Camera], factors: Sequence[int], params: Params
    ) -> None:
        """`factors`: by how much each camera's frames are averaged down to work pictures."""
        self.model, self.cameras, self.factors, self.params = model, tuple(cameras), factors, params
        self._spiral = spiral(params.first_radius_px)
        self._spiral_r2 = (self._spiral**2).sum(axis=1)
        self._R = np.zeros((N_JOINTS, 3, 3))
        self._joints = np.zeros((N_JOINTS, 3))
        self._global = np.zeros((N_JOINTS, 4))
        self._d_joints = np.zeros((N_SHAPE, N_JOINTS, 3))
        V = len(model.vertices_m)
        self._xy, self._depth = np.empty((V, 2)), np.empty(V)
        self._zbuffer = np.empty(_MAX_WORK_PX, np.float32)
        # by camera, so that the last rendering of each can be used again
        self._triangle_at = [np.empty(_MAX_WORK_PX, np.int32) for _ in cameras]
        self._ids = [np.empty(_MAX_WORK_PX, np.uint8) for _ in cameras]
        p = params
        self._prediction_sd = np.concatenate([
            np.full(3, p.root_sd_m),
            _group_values({
                "hips": (p.hips_sd_rad,) * 3, "spine": (p.spine_sd_rad,) * 3,
                "leftShoulder": (p.collar_sd_rad,) * 3, "rightShoulder": (p.collar_sd_rad,) * 3,
                "leftUpperArm": (p.arm_sd_rad,) * 3, "rightUpperArm": (p.arm_sd_rad,) * 3,
            }, p.arm_sd_rad),
        ])  # fmt: skip
        # where a joint likes to be when nothing is seen of it: spread about the T-pose
        self._rest_information = np.concatenate([
            np.zeros(3),
            1.0 / _group_values({
                "hips": (1e3, 1e3, 1e3), "spine": (0.5, 0.5, 0.4),
                "leftShoulder": (0.2, 0.2, 0.2), "rightShoulder": (0.2, 0.2, 0.2),
                "leftUpperArm": (2.0, 2.0, 2.0), "rightUpperArm": (2.0, 2.0, 2.0),
            }, 1.0) ** 2,
        ])  # fmt: skip
        # an elbow bends about y (forward from the T-pose), twists about x, and hardly about z
        for g in (4, 7):
            self._rest_information[3 + 3 * g : 6 + 3 * g] = 1.0 / np.array([0.5, 3.0, 1.5]) ** 2
        self._limits = standard_limits()
        self._excess = np.zeros((len(GROUPS), 3))
        self._d_excess = np.zeros((len(GROUPS), 3, 3))
        self._identity = np.tile(IDENTITY_XYZW, (N_JOINTS, 1))

    # --- moving and rendering ---

    def moved(self, state: MotionState, dt_s: float, damping: float = 1.0) -> tuple[Floats, Floats]:
        """root_m and local_xyzw after dt_s at the state's velocity."""
        root, local = np.empty(3), np.empty((N_JOINTS, 4))
        m = self.model
        retract(
            state.root_m, state.local_xyzw, state.velocity * (dt_s * damping),
            m.group_of_joint, m.share_of_joint, root, local,
        )  # fmt: skip
        return root, local

    def step_between(self, a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> Floats:
        """The pose step (N_POSE,) from pose b to pose a, each (root_m, local_xyzw)."""
        out = np.empty(N_POSE)
        m = self.model
        difference(a[0], a[1], b[0], b[1], m.joint_of_group, m.share_of_joint, out)
        return out

    def joints(self, state: MotionState) -> tuple[Floats, Floats]:
        """Joint centres (J,3) and global rotations (J,4) of a state."""
        rest = shaped(self.model, state.factors)[1]
        forward_kinematics(
            self.model.parents, rest, state.root_m, state.local_xyzw,
            self._R, self._joints, self._global,
        )  # fmt: skip
        return self._joints.copy(), self._global.copy()

    def _pose(self, root: Floats, local: Floats, rest: Floats) -> None:
        forward_kinematics(
            self.model.parents, rest, root, local, self._R, self._joints, self._global
        )

    def _project(
        self, index: int, root: Floats, local: Floats, vertices: Floats, rest: Floats, roi: Roi
    ) -> None:
        m, camera, factor = self.model, self.cameras[index], self.factors[index]
        self._pose(root, local, rest)
        skin_and_project(
            vertices, m.bones, m.weights, rest, self._R, self._joints,
            camera.R, camera.t_m, camera.K, camera.dist,
            np.array([float(roi[0] * factor), float(roi[1] * factor)]), 1.0 / factor,
            self._xy, self._depth,
        )  # fmt: skip

    def region(self, index: int, state: MotionState, dt_s: float, margin: int) -> Roi | None:
        """The work-picture region around the body as this camera sees it; None when it is not in view."""
        camera, factor = self.cameras[index], self.factors[index]
        w, h = camera.size_px[0] // factor, camera.size_px[1] // factor
        vertices, rest = shaped(self.model, state.factors)
        self._project(index, *self.moved(state, dt_s), vertices, rest, (0, 0, w, h))
        seen = self._depth > 0.2
        if seen.sum() < len(seen) // 2:
            return None
        lo, hi = self._xy[seen].min(axis=0), self._xy[seen].max(axis=0)
        x0, y0 = max(0, int(lo[0]) - margin) & ~1, max(0, int(lo[1]) - margin) & ~1
        x1, y1 = min(w, int(hi[0]) + margin), min(h, int(hi[1]) + margin)
        return (x0, y0, x1, y1) if x1 - x0 >= 16 and y1 - y0 >= 16 else None

    def render(self, index: int, state: MotionState, dt_s: float, roi: Roi) -> NDArray[np.uint8]:
        """The id map (h,w) of the state in this camera at dt_s. The array is the fitter's own buffer."""
        vertices, rest = shaped(self.model, state.factors)
        return self._rendered(index, *self.moved(state, dt_s), vertices, rest, roi)[0]

    def last_rendered(self, index: int, roi: Roi) -> NDArray[np.uint8]:
        """The id map that `fit` or `render` drew last in this camera and region; the fitter's own buffer."""
        return self._buffers(index, roi)[0]

    def _buffers(self, index: int, roi: Roi) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        return (
            self._ids[index][: h * w].reshape(h, w),
            self._triangle_at[index][: h * w].reshape(h, w),
        )

    def render_parts(
        self, index: int, state: MotionState, dt_s: float, roi: Roi, triangles: NDArray[np.int64]
    ) -> PartialRender:
        """Only these triangles of the body; the arrays are the fitter's own buffers."""
        m = self.model
        vertices, rest = shaped(m, state.factors)
        self._project(index, *self.moved(state, dt_s), vertices, rest, roi)
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        ids, triangle_at = self._buffers(index, roi)
        zbuffer = self._zbuffer[: h * w].reshape(h, w)
        rasterise(self._xy, self._depth, m.triangles[triangles], zbuffer, triangle_at)
        label_triangles(triangle_at, m.colour[triangles], ids)
        return PartialRender(ids, zbuffer, self._R, self._joints, self._global)

    def _rendered(
        self, index: int, root: Floats, local: Floats, vertices: Floats, rest: Floats, roi: Roi
    ) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
        self._project(index, root, local, vertices, rest, roi)
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        ids, triangle_at = self._buffers(index, roi)
        zbuffer = self._zbuffer[: h * w].reshape(h, w)
        rasterise(self._xy, self._depth, self.model.triangles, zbuffer, triangle_at)
        label_triangles(triangle_at, self.model.colour, ids)
        return ids, triangle_at

    # --- fitting ---

    def fit(
        self,
        prediction: MotionState,
        views: Sequence[View],
        dt_s: float,
        iterations: int,
        learn_shape: bool,
        rendered: bool = False,
    ) -> Fit:
        """Fit all views, starting at and held loosely to `prediction`, dt_s after the last fit.

        rendered: `render` has just drawn the prediction into every view, so that the first
        iteration need not draw it again.
        """
        p, m = self.params, self.model
        state = prediction
        n_shape = N_SHAPE if learn_shape else 0
        P = N_POSE + n_shape
        prior = 1.0 / (self._prediction_sd**2 * max(dt_s * 30.0, 0.5))
        diagonal = np.arange(N_POSE)
        visible, matched, unexplained = np.zeros(21), np.zeros(21), np.zeros(21)
        H = np.zeros((P, P))
        start = (prediction.root_m, prediction.local_xyzw)
        cost = 0.0
        for iteration in range(iterations):
            along = iteration / max(iterations - 1, 1)
            radius = p.first_radius_px + along * (p.last_radius_px - p.first_radius_px)
            row_step = p.early_row_step if iteration < iterations - 1 else p.last_row_step
            n_offsets = int(np.searchsorted(self._spiral_r2, radius * radius, side="right"))
            H = np.zeros((P, P))
            b = np.zeros(P)
            visible[:] = matched[:] = unexplained[:] = 0.0
            cost = 0.0
            vertices, rest = shaped(m, state.factors)
            for view in views:
                root, local = self.moved(state, view.dt_s)
                if rendered and iteration == 0:
                    ids, triangle_at = self._buffers(view.index, view.roi)
                    self._pose(root, local, rest)
                else:
                    ids, triangle_at = self._rendered(
                        view.index, root, local, vertices, rest, view.roi
                    )
                joint_shape_derivatives(m.parents, m.d_rest, self._R, self._d_joints)
                camera, factor = self.cameras[view.index], self.factors[view.index]
                cost += accumulate(
                    ids, triangle_at, view.ids, view.softness, self._spiral, n_offsets,
                    radius, 0.6 * radius, iteration & 1, row_step, m.triangles, m.patch, vertices, m.d_vertices,
                    m.triangle_bones, m.triangle_weights, rest, m.d_rest, m.parents,
                    m.joint_of_group, m.group_of_joint, m.share_of_joint, self._R, self._joints,
                    self._d_joints, n_shape, camera.R, camera.t_m,
                    camera.K[0, 0] / factor, camera.K[1, 1] / factor, p.row_weight,
                    H, b, visible, matched, unexplained,
                )  # fmt: skip
            H += np.triu(H, 1).T
            pose = (state.root_m, state.local_xyzw)
            A = H.copy()
            A[diagonal, diagonal] += prior + self._rest_information
            b[:N_POSE] += prior * self.step_between(start, pose)
            b[:N_POSE] += self._rest_information * self.step_between(
                (state.root_m, self._identity), pose
            )
            self._add_limits(state.local_xyzw, A, b)
            if learn_shape:
                A[N_POSE:, N_POSE:] += prediction.information
                b[N_POSE:] += prediction.information @ (prediction.factors - state.factors)
            step = np.asarray(np.linalg.solve(A, b), dtype=np.float64)
            state = self._stepped(state, step)
        return Fit(state, visible, matched, unexplained, H, cost)

    def _add_limits(self, local: Floats, A: Floats, b: Floats) -> None:
        """Pull joints back into their range, softly."""
        q = self._limits
        self._excess[:] = self._d_excess[:] = 0.0
        limit_residuals(
            local, q.joint, q.share, q.axis, q.lower_rad, q.upper_rad, self._excess, self._d_excess
        )
        information = 1.0 / self.params.limit_sd_rad**2
        for g in np.flatnonzero(self._excess.any(axis=1)):
            D = self._d_excess[g]
            span = slice(3 + 3 * g, 6 + 3 * g)
            A[span, span] += information * D.T @ D
            b[span] -= information * D.T @ self._excess[g]

    def _stepped(self, state: MotionState, step: Floats) -> MotionState:
        m = self.model
        root, local = np.empty(3), np.empty((N_JOINTS, 4))
        retract(
            state.root_m, state.local_xyzw, step[:N_POSE],
            m.group_of_joint, m.share_of_joint, root, local,
        )  # fmt: skip
        factors = state.factors
        if len(step) > N_POSE:
            factors = np.clip(factors + step[N_POSE:], 0.6, 1.6)
        return replace(state, root_m=root, local_xyzw=local, factors=factors)

    def shape_information(self, H: Floats) -> Floats:
        """What the evidence says of the shape factors when the pose is free: Schur complement (N_SHAPE,N_SHAPE)."""
        Hpp = H[:N_POSE, :N_POSE] + np.diag(self._rest_information + 1e-3)
        Hps = H[:N_POSE, N_POSE:]
        return H[N_POSE:, N_POSE:] - Hps.T @ np.linalg.solve(Hpp, Hps)
