"""Gauss-Newton over cameras, body shape and the poses of all keyframes, until all pictures agree."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.calibrate.self_calibration.body_rows import (
    N_CAMERA,
    BodyRows,
    RowGatherer,
    average_cameras,
    camera_columns,
    move_camera,
)
from mocapd.calibrate.self_calibration.camera_uncertainty import CameraUncertainty, uncertainty_of
from mocapd.calibrate.self_calibration.keyframes import Keyframe, initial_states, keyframe_views
from mocapd.calibrate.self_calibration.surface_residuals import FreeBody, free_body
from mocapd.errors import ConfigError
from mocapd.fit.body_drawing import image_scales
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, stepped
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry.camera_model import centre
from mocapd.shirt.garment import shirt_labels
from mocapd.types import Camera, Floats, Rig

_SMALLEST, _LARGEST = 0.6, 1.6  # factors, as in the tracker


@dataclass(frozen=True, slots=True)
class SelfCalibrationParams:
    """How the extrinsics are solved."""

    keyframes: int = 64
    rounds: int = 20
    averaged: int = (
        8  # last rounds: steps end in the noise of whole pixels, which their mean halves
    )
    radius_px: int = 14  # work px within which colours are looked for
    polish: int = 3  # rounds of the poses alone with the extrinsics that were found
    loose_s: float = 0.4  # a start is held to as loosely as a prediction over this time
    joint_sd_rad: float = 0.5  # how far a pose may yield to a change of extrinsics or shape
    least_match: float = 0.6  # of a keyframe that counts
    tolerated_cost: float = 3.0  # and its cost, against that of the middle one
    least_keyframes: int = 6
    # how many of them count in full against what is known of people: their errors are alike
    independent_frames: float = 8.0
    # how far a surface may be off from what the shape's factors make of it
    off_sd_m: float = 0.02
    # how much less is believed of body and cameras than their covariance says, beside sleeve rings
    surface_uncertainty: float = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class SelfCalibrationReport:
    """How well the extrinsics were solved.

    residual_px: RMS by camera, over the drawn shirt, of how far its pixels are from where their
    colour is seen [px of the frames]; frames: keyframes that agree; distance_m: of each camera from
    the first; match: share of the drawn shirt that the pictures confirm; factors (n_shape,): the
    wearer's proportions; uncertainties: by camera but the first.
    """

    residual_px: Mapping[str, float]
    frames: int
    distance_m: Mapping[str, float]
    match: float
    factors: Floats
    uncertainties: Mapping[str, CameraUncertainty]


@dataclass(slots=True, eq=False)
class _Scene:
    """What is solved for: cameras, the factors (N,) of a free body, and a state per keyframe."""

    cameras: list[Camera]
    factors: Floats
    states: list[MotionState]


@dataclass(slots=True, eq=False)
class _Evidence:
    """Normal equations H (n,n), b (n,) of shape and cameras without the poses; follows: by keyframe how
    its pose answers to a step of those, and its own step; None for one that is not believed."""

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
        self._body: FreeBody = free_body(model, params.off_sd_m)
        self._work = image_scales(cameras, self._tracker.work_width_px)
        self._n_shape = len(self._body.sd)
        self._n = self._n_shape + N_CAMERA * (len(cameras) - 1)
        self._views: list[list[View]] = []
        scene = _Scene(list(cameras), np.ones(self._n_shape), [])
        fitter = Fitter(model, shirt_labels(model), cameras, self._work, self._tracker)
        for keyframe in keyframes:
            seen = keyframe_views(keyframe, self._work)
            fits = [
                fitter.fit(s, seen, params.loose_s, 8)
                for s in initial_states(keyframe, cameras, model, np.ones(model.n_shape))
            ]
            best = min(fits, key=lambda fit: fit.cost)
            scene.states.append(replace(best.state, factors=scene.factors))
            self._views.append(seen)
        self._scene = scene

    @property
    def cost(self) -> float:
        """Of the middle keyframe as things are now, for each drawn pixel."""
        return float(np.median([_cost(frame) for frame in self._gather()]))

    def solve(self) -> tuple[Rig, SelfCalibrationReport, dict[str, Floats]]:
        """The rig at the end, how good it is, and by camera but the first the covariance (6,6) of its motion.

        Raises ConfigError when too little agrees.
        """
        p, scene = self._p, self._scene
        kept: list[tuple[tuple[Camera, ...], Floats]] = []
        for i in range(p.rounds):
            self._step(scene, self._gather())
            if i >= p.rounds - p.averaged:
                kept.append((tuple(scene.cameras), scene.factors))
        scene.cameras = [
            average_cameras([cameras[i] for cameras, _ in kept]) for i in range(len(scene.cameras))
        ]
        scene.factors = np.mean([factors for _, factors in kept], axis=0)
        scene.states = [replace(state, factors=scene.factors) for state in scene.states]
        for _ in range(p.polish):
            self._follow(scene, self._evidence(self._gather()), np.zeros(self._n))
        rows = self._gather()
        covariance: Floats = np.asarray(
            np.linalg.inv(self._informed(self._evidence(rows)).H), dtype=np.float64
        )
        covariances = {
            camera.name: covariance[k : k + N_CAMERA, k : k + N_CAMERA]
            for camera, k in zip(
                scene.cameras[1:], range(self._n_shape, self._n, N_CAMERA), strict=True
            )
        }
        return Rig(tuple(scene.cameras)), self._report(scene, rows, covariances), covariances

    def _gather(self) -> list[list[BodyRows]]:
        """The rows of every keyframe's views."""
        scene = self._scene
        body = self._body.model
        fitter = Fitter(body, shirt_labels(body), scene.cameras, self._work, self._tracker)
        gatherer = RowGatherer(fitter, self._p.radius_px)
        return [
            [gatherer.gather(s, view) for view in v]
            for s, v in zip(scene.states, self._views, strict=True)
        ]

    def _evidence(self, rows: Sequence[Sequence[BodyRows]]) -> "_Evidence":
        """What all keyframes say together. Raises ConfigError when too few agree with the body."""
        p = self._p
        n = self._body.model.n_pose
        out = _Evidence(np.zeros((self._n, self._n)), np.zeros(self._n), [])
        tolerable = p.tolerated_cost * float(np.median([_cost(frame) for frame in rows]))
        for frame, seen in zip(rows, self._views, strict=True):
            if _match(frame) < p.least_match or _cost(frame) > tolerable:
                out.follows.append(None)
                continue
            Hpp, bp = np.diag(self._pose_information()), np.zeros(n)
            Hps, Hss = np.zeros((n, self._n)), np.zeros((self._n, self._n))
            bs = np.zeros(self._n)
            for row, view in zip(frame, seen, strict=True):
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
        counted = sum(one is not None for one in out.follows)
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

    def _informed(self, found: "_Evidence") -> "_Evidence":
        """The same with what is known of people. Changes it."""
        n, prior = self._n_shape, 1.0 / self._body.sd**2
        found.H[:n, :n] += np.diag(prior)
        found.H += 1e-9 * np.eye(self._n)
        found.b[:n] -= prior * (self._scene.factors - 1.0)
        return found

    def _step(self, scene: _Scene, rows: Sequence[Sequence[BodyRows]]) -> None:
        """One step of cameras and shape, the poses following.

        All is moved by the same rows, with the poses eliminated (Schur complement). To alternate with
        the tracker's own fit was tried: its cost differs a little, and cameras and poses then drift
        together along what the pictures hardly tell.
        """
        found, n = self._informed(self._evidence(rows)), self._n_shape
        step: Floats = np.asarray(np.linalg.solve(found.H, found.b), dtype=np.float64)
        scene.factors = np.clip(scene.factors + step[:n], _SMALLEST, _LARGEST)
        for i in range(1, len(scene.cameras)):
            k = n + N_CAMERA * (i - 1)
            scene.cameras[i] = move_camera(scene.cameras[i], step[k : k + N_CAMERA])
        self._follow(scene, found, step)

    def _follow(self, scene: _Scene, found: "_Evidence", step: Floats) -> None:
        """The poses after a step of shape and cameras."""
        for k, (state, follow) in enumerate(zip(scene.states, found.follows, strict=True)):
            root, local = state.root_m, state.local_xyzw
            if follow is not None:
                root, local = stepped(self._body.model, root, local, follow[1] - follow[0] @ step)
            scene.states[k] = replace(state, root_m=root, local_xyzw=local, factors=scene.factors)

    def _pose_information(self) -> Floats:
        information = np.full(self._body.model.n_pose, 1.0 / self._p.joint_sd_rad**2)
        information[:6] = 1e-3  # root and hips are free
        return information

    def _columns(self, row: BodyRows, camera: int) -> Floats:
        """(P, n): how the row's pose and shape columns make up those of shape and cameras."""
        n_pose = self._body.model.n_pose
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

    def _report(
        self,
        scene: _Scene,
        rows: Sequence[Sequence[BodyRows]],
        covariances: Mapping[str, Floats],
    ) -> SelfCalibrationReport:
        good = [frame for frame in rows if _match(frame) >= self._p.least_match]
        visible = sum(float(r.visible.sum()) for frame in good for r in frame)
        matched = sum(float(r.matched.sum()) for frame in good for r in frame)
        first = centre(scene.cameras[0])
        uncertainties = {
            camera.name: uncertainty_of(camera, first, covariances[camera.name])
            for camera in scene.cameras[1:]
        }
        return SelfCalibrationReport(
            residual_px={c.name: self._residual_px(good, i) for i, c in enumerate(scene.cameras)},
            frames=len(good),
            distance_m={
                c.name: float(np.linalg.norm(centre(c) - first)) for c in scene.cameras[1:]
            },
            match=matched / max(visible, 1.0),
            factors=scene.factors[: self._body.model.space.n_shape],
            uncertainties=uncertainties,
        )


def _cost(frame: Sequence[BodyRows]) -> float:
    """Cost for each drawn pixel of the shirt."""
    return sum(r.cost for r in frame) / max(sum(float(r.visible.sum()) for r in frame), 1.0)


def _match(frame: Sequence[BodyRows]) -> float:
    """Share of the drawn shirt that is confirmed, in the camera that confirms least."""
    return min(row.match for row in frame)
