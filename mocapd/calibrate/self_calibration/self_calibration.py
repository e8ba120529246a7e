"""Extrinsics from the wearer alone: chooses keyframes, places cameras, solves all together, finds gravity.

In two passes: the second starts from the poses that all cameras together give.
"""

from collections.abc import Sequence
from dataclasses import replace

from mocapd.body.model import BodyModel, build_model
from mocapd.calibrate.self_calibration.camera_uncertainty import uncertainty_of
from mocapd.calibrate.self_calibration.gravity_alignment import align_with_gravity
from mocapd.calibrate.self_calibration.initial_extrinsics import initial_extrinsics
from mocapd.calibrate.self_calibration.joint_solver import (
    JointSolver,
    SelfCalibrationParams,
    SelfCalibrationReport,
)
from mocapd.calibrate.self_calibration.joint_track import followed_together
from mocapd.calibrate.self_calibration.keyframes import choose_keyframes
from mocapd.calibrate.self_calibration.patch_tracks import PatchObservation
from mocapd.calibrate.self_calibration.ring_bundle import place_by_rings
from mocapd.calibrate.self_calibration.ring_pairs import ring_pairs
from mocapd.errors import ConfigError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.work_size import image_scales
from mocapd.geometry.camera_model import camera_from_world, centre, with_extrinsics
from mocapd.types import Camera, Rig


def extrinsics_from_body(
    observations: Sequence[PatchObservation],
    bare_cameras: Sequence[Camera],
    stature_m: float,
    params: SelfCalibrationParams | None = None,
    near: Rig | None = None,
) -> tuple[Rig, SelfCalibrationReport]:
    """The rig in world coordinates: floor at y = 0, the wearer at the origin facing +Z at the start.

    observations: from `PatchTracks` of the same cameras; near: earlier extrinsics, as another initial value.
    Raises ConfigError when the observations do not determine the extrinsics.
    """
    p = params if params is not None else SelfCalibrationParams()
    keyframes = choose_keyframes(
        observations, [camera.name for camera in bare_cameras], p.keyframes
    )
    model = build_model(stature_m)
    solvers = [JointSolver(model, initial_extrinsics(observations, bare_cameras), keyframes, p)]
    if near is not None:
        old = {camera.name: camera for camera in near.cameras}
        before = [with_extrinsics(c, camera_from_world(old[c.name])) for c in bare_cameras]
        solvers.append(JointSolver(model, before, keyframes, p))
    first_pass = _solve_pass(
        min(solvers, key=lambda solver: solver.cost), observations, stature_m, p
    )
    rig, report = _again(*first_pass, observations, model, p)
    return align_with_gravity(rig, observations, stature_m, report.factors), report


def _solve_pass(
    solver: JointSolver,
    observations: Sequence[PatchObservation],
    stature_m: float,
    params: SelfCalibrationParams,
) -> tuple[Rig, SelfCalibrationReport]:
    """One pass: by the whole body, then every camera but the first combined with the sleeve rings that it and the first
    one saw alone."""
    rig, report, covariances = solver.solve()
    first = rig.cameras[0]
    work = image_scales(rig.cameras, FitParams().work_width_px)
    cameras, uncertainties = [first], {}
    for other, image_scale in zip(rig.cameras[1:], work[1:], strict=True):
        pairs = ring_pairs(observations, (first, other), (work[0], image_scale))
        prior = params.surface_uncertainty**2 * covariances[other.name]
        camera, covariance = other, prior
        if len(pairs.visible):
            camera, covariance = place_by_rings(pairs, first, other, prior, stature_m)
        cameras.append(camera)
        uncertainties[camera.name] = uncertainty_of(camera, centre(first), covariance)
    return Rig(tuple(cameras)), replace(report, uncertainties=uncertainties)


def _again(
    rig: Rig,
    report: SelfCalibrationReport,
    observations: Sequence[PatchObservation],
    model: BodyModel,
    params: SelfCalibrationParams,
) -> tuple[Rig, SelfCalibrationReport]:
    """The second pass; returns the input when all cameras together see too little of the wearer."""
    together = followed_together(observations, rig, model, report.factors)
    keyframes = choose_keyframes(together, rig.names, params.keyframes)
    if len(keyframes) < params.least_keyframes:
        return rig, report
    try:
        solver = JointSolver(model, rig.cameras, keyframes, params)
        return _solve_pass(solver, observations, model.stature_m, params)
    except ConfigError:
        return rig, report
