"""Gauss-Newton over cameras, body shape and the poses of all keyframes, until all pictures agree."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.calibrate.self_calibration.body_rows import (
    N_CAMERA,
    BodyRows,
    RowGatherer,
    average_cameras,
    camera_columns,
    cost_of,
    least_match_of,
    move_camera,
)
from mocapd.calibrate.self_calibration.camera_uncertainty import CameraUncertainty
from mocapd.calibrate.self_calibration.keyframes import Keyframe, initial_states, keyframe_views
from mocapd.calibrate.self_calibration.surface_residuals import free_body
from mocapd.errors import ConfigError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, apply_step
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.shirt.garment import shirt_labels
from mocapd.types import Camera, Floats, Rig

_SMALLEST, _LARGEST = 0.6, 1.6  # factors, as in the tracker


@dataclass(frozen=True, slots=True)
class SelfCalibrationParams:
    keyframes: int = 64
    rounds: int = 20
    averaged: int = 8  # last rounds: steps end in the noise of whole pixels; their mean halves it
    radius_px: int = 14  # work px, search radius for colours
    polish: int = 3  # rounds of the poses alone with the final extrinsics
    loose_s: float = 0.4  # weight of the initial poses, as of a prediction over this time
    joint_sd_rad: float = 0.5  # how far a pose may yield to a change of extrinsics or shape
    least_match: float = 0.6  # of an inlier keyframe
    tolerated_cost: float = 3.0  # of an inlier, relative to the median cost
    least_keyframes: int = 6
    # weight of all keyframes relative to the prior of people's shapes: their errors are correlated
    independent_frames: float = 8.0
    # standard deviation of the surface about the shape model
    off_sd_m: float = 0.02
    # inflation of the covariance of body and cameras relative to sleeve rings
    surface_uncertainty: float = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class SelfCalibrationReport:
    """Quality of the extrinsics.

    residual_px: RMS by camera, over the drawn shirt, of the distance of its pixels from their colour in the picture [px
    of the frames]; frames: inlier keyframes; match: share of the drawn shirt that the pictures confirm; factors
    (n_shape,): the wearer's proportions; uncertainties: by camera but the first, once the sleeve rings are added.
    """

    residual_px: Mapping[str, float]
    frames: int
    match: float
    factors: Floats
    uncertainties: Mapping[str, CameraUncertainty] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class _Evidence:
    """Normal equations H (n,n), b (n,) of shape and cameras, poses eliminated; follows: by keyframe the derivative of
    its pose by a step of those, and its own step; None for an outlier."""

    H: Floats
    b: Floats
    follows: list[tuple[Floats, Floats] | None]


class JointSolver:
    """Gauss-Newton over all cameras but the first, the body's shape, and every keyframe's pose."""

    def __init__(
        self,
        model: BodyModel,
        cameras: Sequence[Camera],
        keyframes: Sequence[Keyframe],
        params: SelfCalibrationParams,
    ) -> None:
        self._p, self._tracker = params, FitParams()
        self._body, self._factor_sd = free_body(model, params.off_sd_m)
        self._work = image_scales(cameras, self._tracker.work_width_px)
        self._n_shape = len(self._factor_sd)
        self._n = self._n_shape + N_CAMERA * (len(cameras) - 1)
        self._views: list[list[View]] = []
        # the unknowns: cameras, the factors (N,) of a free body, and a state per keyframe
        self._cameras = list(cameras)
        self._factors: Floats = np.ones(self._n_shape)
        self._states: list[MotionState] = []
        fitter = Fitter(model, shirt_labels(model), cameras, self._work, self._tracker)
        for keyframe in keyframes:
            frame_views = keyframe_views(keyframe, self._work)
            fits = [
                fitter.fit(s, frame_views, params.loose_s, 8)
                for s in initial_states(keyframe, cameras, model, np.ones(model.n_shape))
            ]
            best = min(fits, key=lambda fit: fit.cost)
            self._states.append(replace(best.state, factors=self._factors))
            self._views.append(frame_views)

    @property
    def cost(self) -> float:
        """The median cost of keyframes for each drawn pixel, at the present state."""
        return float(np.median([cost_of(frame) for frame in self._gather()]))

    def solve(self) -> tuple[Rig, SelfCalibrationReport, dict[str, Floats]]:
        """The final rig, its quality, and by camera but the first the covariance (6,6) of its motion.

        Raises ConfigError when too little agrees.
        """
        p = self._p
        history: list[tuple[tuple[Camera, ...], Floats]] = []
        for i in range(p.rounds):
            self._step(self._gather())
            if i >= p.rounds - p.averaged:
                history.append((tuple(self._cameras), self._factors))
        self._cameras = [
            average_cameras([cameras[i] for cameras, _ in history])
            for i in range(len(self._cameras))
        ]
        self._factors = np.mean([factors for _, factors in history], axis=0)
        self._states = [replace(state, factors=self._factors) for state in self._states]
        for _ in range(p.polish):
            self._follow(self._evidence(self._gather()), np.zeros(self._n))
        rows = self._gather()
        covariance: Floats = np.asarray(
            np.linalg.inv(self._with_prior(self._evidence(rows)).H), dtype=np.float64
        )
        covariances = {
            camera.name: covariance[k : k + N_CAMERA, k : k + N_CAMERA]
            for camera, k in zip(
                self._cameras[1:], range(self._n_shape, self._n, N_CAMERA), strict=True
            )
        }
        return Rig(tuple(self._cameras)), self._report(rows), covariances

    def _gather(self) -> list[list[BodyRows]]:
        """The rows of every keyframe's views."""
        labels = shirt_labels(self._body)
        fitter = Fitter(self._body, labels, self._cameras, self._work, self._tracker)
        gatherer = RowGatherer(fitter, self._p.radius_px)
        return [
            [gatherer.gather(s, view) for view in v]
            for s, v in zip(self._states, self._views, strict=True)
        ]

    def _evidence(self, rows: Sequence[Sequence[BodyRows]]) -> _Evidence:
        """Normal equations of all keyframes. Raises ConfigError when too few agree with the body."""
        p = self._p
        n = self._body.n_pose
        out = _Evidence(np.zeros((self._n, self._n)), np.zeros(self._n), [])
        tolerable = p.tolerated_cost * float(np.median([cost_of(frame) for frame in rows]))
        held = np.full(n, 1.0 / p.joint_sd_rad**2)
        held[:6] = 1e-3  # root and hips are free
        for frame, frame_views in zip(rows, self._views, strict=True):
            if least_match_of(frame) < p.least_match or cost_of(frame) > tolerable:
                out.follows.append(None)
                continue
            Hpp, bp = np.diag(held), np.zeros(n)
            Hps, Hss = np.zeros((n, self._n)), np.zeros((self._n, self._n))
            bs = np.zeros(self._n)
            for row, view in zip(frame, frame_views, strict=True):
                J = self._columns(row, view.index)
                Hpp += row.H[:n, :n]
                Hps += row.H[:n] @ J
                Hss += J.T @ row.H @ J
                bs += J.T @ row.b
                bp += row.b[:n]
            back: Floats = np.asarray(np.linalg.solve(Hpp, Hps), dtype=np.float64)
            own: Floats = np.asarray(np.linalg.solve(Hpp, bp), dtype=np.float64)
            out.H += Hss - Hps.T @ back
            out.b += bs - Hps.T @ own
            out.follows.append((back, own))
        counted = sum(follow is not None for follow in out.follows)
        if counted < p.least_keyframes:
            raise ConfigError(
                f"body and pictures agree in {counted} moments only, {p.least_keyframes} are needed",
                "room",
                "check the colours of each camera, then walk about again in the light of now",
            )
        gain = p.independent_frames / counted
        out.H *= gain
        out.b *= gain
        return out

    def _with_prior(self, evidence: _Evidence) -> _Evidence:
        """Adds the prior of people's shapes, in place."""
        n, prior = self._n_shape, 1.0 / self._factor_sd**2
        evidence.H[:n, :n] += np.diag(prior)
        evidence.H += 1e-9 * np.eye(self._n)
        evidence.b[:n] -= prior * (self._factors - 1.0)
        return evidence

    def _step(self, rows: Sequence[Sequence[BodyRows]]) -> None:
        """One step of cameras and shape, the poses following.

        All rows together give the step, with the poses eliminated (Schur complement). Alternating with the tracker's
        own fit failed: its cost differs a little, so cameras and poses drift together along directions that the
        pictures hardly constrain.
        """
        evidence, n = self._with_prior(self._evidence(rows)), self._n_shape
        step: Floats = np.asarray(np.linalg.solve(evidence.H, evidence.b), dtype=np.float64)
        self._factors = np.clip(self._factors + step[:n], _SMALLEST, _LARGEST)
        for i in range(1, len(self._cameras)):
            k = n + N_CAMERA * (i - 1)
            self._cameras[i] = move_camera(self._cameras[i], step[k : k + N_CAMERA])
        self._follow(evidence, step)

    def _follow(self, evidence: _Evidence, step: Floats) -> None:
        """Update the poses after a step of shape and cameras."""
        for k, (state, follow) in enumerate(zip(self._states, evidence.follows, strict=True)):
            root, local = state.root_m, state.local_xyzw
            if follow is not None:
                root, local = apply_step(self._body, root, local, follow[1] - follow[0] @ step)
            self._states[k] = replace(state, root_m=root, local_xyzw=local, factors=self._factors)

    def _columns(self, row: BodyRows, camera: int) -> Floats:
        """(P, n): maps the row's pose and shape columns to those of shape and cameras."""
        n_pose = self._body.n_pose
        J = np.zeros((n_pose + self._n_shape, self._n))
        J[n_pose:, : self._n_shape] = np.eye(self._n_shape)
        if camera > 0:
            k = self._n_shape + N_CAMERA * (camera - 1)
            J[:N_CAMERA, k : k + N_CAMERA] = camera_columns(row.at_m).T
        return J

    def _residual_px(self, frames: Sequence[Sequence[BodyRows]], camera: int) -> float:
        mine = [row for frame in frames for row in frame if row.camera == camera]
        visible = sum(float(row.visible.sum()) for row in mine)
        squared = sum(row.cost for row in mine) / self._tracker.row_weight
        return self._work[camera] * float(np.sqrt(squared / max(visible, 1.0)))

    def _report(self, rows: Sequence[Sequence[BodyRows]]) -> SelfCalibrationReport:
        good = [frame for frame in rows if least_match_of(frame) >= self._p.least_match]
        visible = sum(float(r.visible.sum()) for frame in good for r in frame)
        matched = sum(float(r.matched.sum()) for frame in good for r in frame)
        return SelfCalibrationReport(
            residual_px={c.name: self._residual_px(good, i) for i, c in enumerate(self._cameras)},
            frames=len(good),
            match=matched / max(visible, 1.0),
            factors=self._factors[: self._body.space.n_shape],
        )
