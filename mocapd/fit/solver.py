"""Fit pose and body shape to the classified pictures of all cameras at once, by Gauss-Newton.

Every iteration sums the terms of one body: the id maps of all cameras, each at its own instant, collisions of the arms with
the trunk, and the caller's terms. `solve_kernels` adds the priors and takes the step.
"""

from collections.abc import Collection, Sequence
from itertools import combinations

import numpy as np

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel, Shaped, Shaper
from mocapd.body.pose_space import SIDES
from mocapd.body.posing_kernels import forward_kinematics
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import FitParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.motion_state import MotionState, apply_step
from mocapd.fit.priors.pose_prior import (
    hidden_legs_prior,
    small_baseline_prior,
    wide_baseline_prior,
)
from mocapd.fit.solve_kernels import FREE_POSE, gauss_newton_step
from mocapd.fit.stereo_depth import compared_depths
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.fit.terms.collision_term import CollisionTerm
from mocapd.fit.terms.id_map_term import IdMapTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View, coarse
from mocapd.geometry.camera_model import project
from mocapd.types import Camera, Floats

_USUAL_HZ = 30.0  # spreads about a prediction are those of such a frame
# limits of human proportions
_LIMIT_SDS, _LEAST_LIMIT = 3.0, 0.1
_FEET_SHOWN_BY = 2
_FEET = [INDEX[side + bone] for side in SIDES for bone in ("Foot", "Toes")]


class Fitter:
    """Buffers and constants for fitting one body in one rig; holds no state between calls."""

    def __init__(
        self,
        model: BodyModel,
        labels: SurfaceLabels,
        cameras: Sequence[Camera],
        image_scales: Sequence[int],
        params: FitParams,
        each: Each = in_turn,
    ) -> None:
        """labels: of the pictures' pixels; image_scales: by how much each camera's frames are averaged down."""
        self.model, self.labels, self.params, self.each = model, labels, params, each
        self.shaper = Shaper(model)
        self.drawings = [
            IdMapRenderer(self.shaper, labels, camera, scale)
            for camera, scale in zip(cameras, image_scales, strict=True)
        ]
        self.trunk = CollisionTerm(model, params.collision_information)
        self._id_maps = IdMapTerm(self.drawings, model, params, each)
        self._from_eyes_m = [camera.R.T @ camera.t_m for camera in cameras]
        self.prediction_sd = _prediction_sd(model, params)
        most = np.maximum(_LIMIT_SDS * model.space.factor_sd, _LEAST_LIMIT)
        self._factor_limits = 1.0 + np.stack([-most, most])
        self._wide_baseline_prior, self._hidden_legs_prior, self._small_baseline_prior = (
            plain(prior(model, params))
            for prior in (wide_baseline_prior, hidden_legs_prior, small_baseline_prior)
        )

    def joints(self, state: MotionState) -> tuple[Floats, Floats]:
        """Joint centres (J,3) and global rotations (J,4) of a state."""
        posed = self._pose_joints(state, self.shaper(state.factors))
        return posed.joints, posed.quats

    def fit(
        self,
        prediction: MotionState,
        views: Sequence[View],
        dt_s: float,
        iterations: int,
        learn_shape: bool = False,
        rendered: bool = False,
        fine: int | None = None,
        motion: Floats | None = None,
        terms: Sequence[Term] = (),
    ) -> Fit:
        """Fit all views, starting at and held loosely to `prediction`, dt_s after the last fit.

        rendered: the prediction was drawn last into every view, so that the first iteration need
        not draw it again. fine: how many of the iterations, the last ones, look at all pixels
        (None: as many as the parameters say). motion (n_pose,n_pose): information of
        the prediction; None for the usual, loose one. terms: further rows of the normal equations.
        """
        p, m, n_pose = self.params, self.model, self.model.n_pose
        state, cost, measured = prediction, 0.0, 0.0
        if motion is None:
            motion = np.diag(1.0 / (self.prediction_sd**2 * max(_USUAL_HZ * dt_s, 0.5)))
        fine = p.fine_iterations if fine is None else fine
        priors = self._wide_baseline_prior
        from_one_side = self.has_small_baseline(prediction, views)
        if from_one_side:
            priors = self._small_baseline_prior
        elif m.space.whole and views and not self.show_feet(prediction, views):
            priors = self._hidden_legs_prior
        evidence = held = np.zeros((n_pose, n_pose))
        coarsely = [coarse(view) for view in views]
        # a slice would be another kernel
        shape_information = np.ascontiguousarray(prediction.information)
        k, first_fine = 0, iterations - fine
        may_hurry = bool(views) and not from_one_side and fine > 1
        while k < iterations:
            is_fine, body = k >= first_fine, self.shaper(state.factors)
            # proportions are a matter of a few pixels
            n_shape = m.n_shape if learn_shape and is_fine else 0
            search = self._id_maps.search(k / max(iterations - 1, 1), is_fine, k & 1)
            pictures = views if is_fine else coarsely
            redraw = not rendered or k > 0
            evidence, pull = self._id_maps.system(state, body, pictures, search, n_shape, redraw)
            held, posed = evidence.copy(), self._pose_joints(state, body)
            cost, measured = self.trunk.add(posed, body, held, pull), 0.0
            for term in terms:
                added = term.add(posed, body, held, pull)
                cost += added
                measured += added if term.is_measured else 0.0
            step = gauss_newton_step(
                held, pull, state.root_m, state.local_xyzw, prediction.root_m, prediction.local_xyzw,
                motion, priors, prediction.factors - state.factors, shape_information, self._factor_limits - state.factors,
            )  # fmt: skip
            root_m, local_xyzw = apply_step(m, state.root_m, state.local_xyzw, step[:n_pose])
            factors = state.factors + step[n_pose:] if n_shape else state.factors
            state = MotionState(root_m, local_xyzw, state.velocity, factors, state.information)
            # where views cross, two looks at all pixels do the rest of what is that close
            k += 1
            if may_hurry and k < first_fine:
                is_close = np.abs(step[:n_pose] / self.prediction_sd).max() < p.close_sds
                k = first_fine if is_close else k
        counts = self._id_maps.counts(views)
        misplaced, in_depth, nearer_px = compared_depths(self.drawings, views, p)
        return Fit(
            state, *counts, evidence, self._id_maps.cost(views) + cost + misplaced, held[:n_pose, :n_pose] + motion,
            in_depth, nearer_px, measured,
        )  # fmt: skip

    def has_small_baseline(self, state: MotionState, views: Sequence[View]) -> bool:
        """Whether all cameras see the body from about the same side."""
        return self.look_from_one_side(state, [view.index for view in views])

    def look_from_one_side(self, state: MotionState, cameras: Collection[int]) -> bool:
        """The same of cameras, by index; False of none."""
        rays = [state.root_m + self._from_eyes_m[i] for i in cameras]
        least = np.cos(self.params.small_baseline_rad)
        return bool(rays) and all(
            a @ b > least * np.sqrt((a @ a) * (b @ b)) for a, b in combinations(rays, 2)
        )

    def show_feet(self, state: MotionState, views: Sequence[View]) -> bool:
        """Whether two views and more have both feet within their pictures."""
        feet_m, showing = self.joints(state)[0][_FEET], 0
        for view in views:
            camera = self.drawings[view.index].camera
            feet_px = project(camera, feet_m)
            showing += bool(((feet_px >= 0.0) & (feet_px < camera.size_px)).all())
            if showing == _FEET_SHOWN_BY:
                return True
        return False

    def common_line_of_sight(self, state: MotionState, views: Sequence[View]) -> Floats | None:
        """The mean direction (3,) from these cameras to the body, a unit vector; None if they see it from several sides."""
        if not self.has_small_baseline(state, views):
            return None
        return self._direction(state, [view.index for view in views])

    def line_of_sight(self, state: MotionState, cameras: Collection[int]) -> Floats | None:
        """The unit vector (3,) to the body from the only one of these cameras; None of several, which tell its depth."""
        return self._direction(state, cameras) if len(cameras) == 1 else None

    def _direction(self, state: MotionState, cameras: Collection[int]) -> Floats:
        """The unit vector (3,) of the mean way from these cameras to the body."""
        way_m = np.sum([state.root_m + self._from_eyes_m[i] for i in cameras], axis=0)
        return np.asarray(way_m / np.linalg.norm(way_m))

    def shape_information(self, H: Floats) -> Floats:
        """What the evidence H (P,P) says of the shape factors (n_shape,n_shape) when the pose is free within the usual range
        of poses: the Schur complement of H, with the pose first."""
        n = self.model.n_pose
        of_pose = H[:n, :n] + self._wide_baseline_prior[1] + FREE_POSE * np.eye(n)
        of_both = H[:n, n:]
        return np.asarray(H[n:, n:] - of_both.T @ np.linalg.solve(of_pose, of_both))

    def _pose_joints(self, state: MotionState, body: Shaped) -> PosedJoints:
        """At the frame set's own instant."""
        R, joints_m = np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3))
        posed = PosedJoints(body.rest, R, joints_m, np.empty((N_JOINTS, 4)))
        forward_kinematics(
            self.model.parents, body.rest, state.root_m, state.local_xyzw, R, joints_m, posed.quats
        )
        return posed


def _prediction_sd(model: BodyModel, p: FitParams) -> Floats:
    """Standard deviations (n_pose,) about a prediction over a usual frame."""
    by_group = {
        "hips": (p.hips_sd_rad,) * 3, "spine": (p.spine_sd_rad,) * 3,
        "leftShoulder": (p.collar_sd_rad,) * 3, "rightShoulder": (p.collar_sd_rad,) * 3,
    }  # fmt: skip
    return np.concatenate([
        np.full(3, p.root_sd_m), model.space.by_group(by_group, p.arm_sd_rad)
    ])  # fmt: skip
