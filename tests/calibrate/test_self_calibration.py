"""The room from a drawn body: what every camera would see of known poses gives the cameras back."""

import pickle
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mocapd.body.model import BodyModel, build_model
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.calibrate.self_calibration import self_calibration
from mocapd.calibrate.self_calibration.body_rows import RowGatherer, camera_columns, move_camera
from mocapd.calibrate.self_calibration.joint_solver import (
    JointSolver,
    SelfCalibrationParams,
    SelfCalibrationReport,
)
from mocapd.calibrate.self_calibration.joint_track import followed_together
from mocapd.calibrate.self_calibration.keyframes import Keyframe
from mocapd.calibrate.self_calibration.patch_tracks import MARKS, PatchObservation, PatchSighting
from mocapd.calibrate.self_calibration.ring_pairs import RingPairs, ring_pairs
from mocapd.calibrate.self_calibration.self_calibration import extrinsics_from_body
from mocapd.calibrate.self_calibration.surface_residuals import free_body
from mocapd.clock import nanoseconds
from mocapd.errors import ConfigError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, from_camera, to_camera
from mocapd.shirt.garment import shirt_labels
from mocapd.types import Camera, Floats, Rig
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

STATURE_M = 1.75
MODEL = build_model(STATURE_M)
CAMERAS = tuple(
    looking_at(name, np.array(eye_m), np.array([0.0, 1.1, 0.0]), roll_rad=0.02)
    for name, eye_m in (("left", (-1.4, 1.4, 2.3)), ("right", (1.5, 1.3, 2.2)))
)
FITTER = Fitter(MODEL, shirt_labels(MODEL), CAMERAS, [2, 2], FitParams())


def walking(i: int) -> MotionState:
    """Someone who steps about, turns a little and moves the arms."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    a = 0.4 * i
    local[0] = rotations.exp(np.array([0.0, 0.6 * np.sin(0.3 * i), 0.0]))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        local[INDEX[side + "UpperArm"]] = rotations.exp(
            np.array([0.0, -sign * 0.5 * (1 + np.sin(a)), -sign * 0.5 * (1 + np.cos(1.3 * a))])
        )
        local[INDEX[side + "LowerArm"]] = rotations.exp(
            np.array([0.0, -sign * 0.5 * (1 + np.sin(1.7 * a)), 0.0])
        )
    root = np.array([0.3 * np.sin(0.5 * i), 0.93, 0.3 * np.cos(0.37 * i) - 0.3])
    return MotionState(
        root,
        local,
        np.zeros(MODEL.n_pose),
        np.ones(MODEL.n_shape),
        initial_information(MODEL.space),
    )


def observations(
    n: int = 16, fitter: Fitter = FITTER, factors: Floats | None = None
) -> list[dict[str, PatchSighting]]:
    """Both cameras' sightings; each judges depth wrongly by a few percent, as a lone camera does."""
    rng = np.random.default_rng(0)
    out = []
    for i in range(n):
        state = walking(i) if factors is None else replace(walking(i), factors=factors)
        observation: dict[str, PatchSighting] = {}
        joints, quats = fitter.joints(state)
        for camera, drawing in zip(CAMERAS, fitter.drawings, strict=True):
            roi = drawing.region(state, 0.0, 24)
            assert roi is not None
            ids = drawing.render(state, 0.0, roi).copy()
            turned = rotations.multiply(rotations.from_matrix(camera.R), quats)
            wrong = rotations.exp(rng.normal(0.0, 0.03, 3))
            seen = to_camera(camera, joints) * (1.0 + rng.normal(0.0, 0.03))
            observation[camera.name] = PatchSighting(
                nanoseconds(0.3 * i), seen, rotations.multiply(wrong, turned), np.ones(N_JOINTS),
                ids, (2 * roi[0], 2 * roi[1], 2 * roi[2], 2 * roi[3]),
            )  # fmt: skip
        out.append(observation)
    return out


def lenses() -> list[Camera]:
    """The cameras with their places forgotten."""
    return [replace(c, R=np.eye(3), t_m=np.zeros(3)) for c in CAMERAS]


def test_the_room_of_a_drawn_body_is_found_upright_and_in_metres() -> None:
    rig, report = extrinsics_from_body(
        observations(), lenses(), STATURE_M, SelfCalibrationParams(rounds=12, averaged=4)
    )
    true = CAMERAS[1].R @ CAMERAS[0].R.T
    found = rig.cameras[1].R @ rig.cameras[0].R.T
    angle = rotations.angle_rad(rotations.from_matrix(found), rotations.from_matrix(true))
    assert np.degrees(angle) < 1.0
    wanted_m = np.linalg.norm(centre(CAMERAS[1]) - centre(CAMERAS[0]))
    found_m = np.linalg.norm(centre(rig.cameras[1]) - centre(rig.cameras[0]))
    assert found_m == pytest.approx(wanted_m, rel=0.02)
    assert report.frames >= 12
    assert report.match > 0.9
    assert max(report.residual_px.values()) < 4.0
    for camera, placed in zip(CAMERAS, rig.cameras, strict=True):
        # gravity from how one stands, the floor from the hips' height
        tilt = np.degrees(np.arccos(np.clip(camera.R[:, 1] @ placed.R[:, 1], -1.0, 1.0)))
        assert tilt < 3.0
        assert centre(placed)[1] == pytest.approx(centre(camera)[1], abs=0.12)


def rotation_deg(rig: Rig) -> float:
    """How far the second camera is turned against the first, less how far it truly is."""
    turned = [b.R @ a.R.T for a, b in (rig.cameras, CAMERAS)]
    return float(np.degrees(rotations.angle_rad(*(rotations.from_matrix(R) for R in turned))))


def remember_solutions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solve and look for rings once for the same cameras, whatever the rings then count for.

    For one set of observations: `surface_uncertainty` weighs the rings against what is solved here.
    """
    solvers: dict[tuple[SelfCalibrationParams, bytes], JointSolver] = {}
    rings: dict[bytes, RingPairs] = {}

    class SolvedOnce(JointSolver):
        @cache  # noqa: B019  the solvers are gone with the test
        def solve(self) -> tuple[Rig, SelfCalibrationReport, dict[str, Floats]]:
            return super().solve()

    def solver(
        model: BodyModel,
        cameras: Sequence[Camera],
        keyframes: Sequence[Keyframe],
        params: SelfCalibrationParams,
    ) -> JointSolver:
        key = (replace(params, surface_uncertainty=1.0), pickle.dumps(cameras))
        if key not in solvers:
            solvers[key] = SolvedOnce(model, cameras, keyframes, params)
        return solvers[key]

    def pairs(
        seen: Sequence[PatchObservation], pair: tuple[Camera, Camera], scales: tuple[int, int]
    ) -> RingPairs:
        key = pickle.dumps(pair)
        if key not in rings:
            rings[key] = ring_pairs(seen, pair, scales)
        return rings[key]

    monkeypatch.setattr(self_calibration, "JointSolver", solver)
    monkeypatch.setattr(self_calibration, "ring_pairs", pairs)


def test_a_body_of_another_surface_does_not_turn_the_cameras(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A body that is centimetres off everywhere, as none of the shape's factors makes it."""
    remember_solutions(monkeypatch)
    free, sd = free_body(MODEL, 0.02)
    rng = np.random.default_rng(3)
    factors = np.ones(len(sd))
    factors[MODEL.n_shape :] += rng.normal(0.0, 0.012, len(sd) - MODEL.n_shape)
    seen = observations(
        20, Fitter(free, shirt_labels(MODEL), CAMERAS, [2, 2], FitParams()), factors
    )
    short = SelfCalibrationParams(
        rounds=8, averaged=4, surface_uncertainty=1e-3
    )  # the surface alone, no rings
    stiff = replace(short, off_sd_m=1e-4)
    free_rig, _ = extrinsics_from_body(seen, lenses(), STATURE_M, short)
    stiff_rig, _ = extrinsics_from_body(seen, lenses(), STATURE_M, stiff)
    ringed_rig, report = extrinsics_from_body(
        seen, lenses(), STATURE_M, replace(stiff, surface_uncertainty=2.0)
    )
    assert rotation_deg(free_rig) < 2.0
    assert rotation_deg(free_rig) < 0.7 * rotation_deg(stiff_rig)
    assert rotation_deg(ringed_rig) < 1.0
    assert rotation_deg(ringed_rig) < 3.0 * report.uncertainties["right"].rotation_deg


def test_the_surface_is_off_alike_on_both_sides() -> None:
    """What moves a point of the left side moves one of the right side by the mirrored way."""
    free, _ = free_body(MODEL, 0.02)
    ways = free.d_vertices[MODEL.n_shape :]
    mirror = np.array([-1.0, 1.0, 1.0])
    at = MODEL.vertices_m
    apart_m = np.linalg.norm(at[:, None] * mirror - at[None], axis=2)
    twin = apart_m.argmin(axis=1)
    # points in the plane of symmetry are their own twins; those of both tubes' ends have several
    sure = (apart_m.min(axis=1) < 1e-9) & ((apart_m < 1e-9).sum(axis=1) == 1)
    assert sure.mean() > 0.8
    sure &= np.abs(at[:, 0]) > 1e-6
    np.testing.assert_allclose(ways[:, twin[sure]], ways[:, sure] * mirror, atol=1e-9)


def test_the_camera_columns_are_the_derivative_of_moving_the_camera() -> None:
    """A small motion of the camera and the same motion of root and hips draw the same picture."""
    state = walking(3)
    roi = FITTER.drawings[1].region(state, 0.0, 24)
    assert roi is not None
    ids = FITTER.drawings[1].render(state, 0.0, roi).copy()
    view = View(1, roi, ids, np.full(ids.shape, 255, np.uint8), 0.0)
    motion = np.array([0.03, -0.02, 0.05, 0.004, 0.01, -0.006])
    turn = rotations.exp(motion[3:])
    moved_root = rotations.rotate(turn, state.root_m) + motion[:3]
    local = state.local_xyzw.copy()
    local[0] = rotations.multiply(turn, local[0])
    by_body = (
        FITTER.drawings[1]
        .render(replace(state, root_m=moved_root, local_xyzw=local), 0.0, roi)
        .copy()
    )
    cameras = (CAMERAS[0], move_camera(CAMERAS[1], motion))
    fitter = Fitter(MODEL, shirt_labels(MODEL), cameras, [2, 2], FitParams())
    assert np.mean(fitter.drawings[1].render(state, 0.0, roi) != by_body) < 1e-3
    rows = RowGatherer(fitter, 10).gather(state, view)
    # the step that the columns ask for leads back, to first order
    T = camera_columns(rows.at_m)
    step = np.linalg.solve(T @ rows.H[:6, :6] @ T.T + 1e-3 * np.eye(6), T @ rows.b[:6])
    back = move_camera(cameras[1], step.astype(np.float64))
    before = np.linalg.norm(
        cameras[1].R @ state.root_m + cameras[1].t_m - to_camera(CAMERAS[1], state.root_m)
    )
    after = np.linalg.norm(to_camera(back, state.root_m) - to_camera(CAMERAS[1], state.root_m))
    assert after < 0.6 * before


def test_a_camera_that_never_saw_the_wearer_is_named() -> None:
    alone = [{"left": m["left"]} for m in observations(4)]
    with pytest.raises(ConfigError, match="'right'"):
        extrinsics_from_body(alone, lenses(), STATURE_M)


def off_m(seen: PatchObservation, i: int) -> float:
    """How far the marks of the i-th pose are from the truth, in the camera that places them worst."""
    true = FITTER.joints(walking(i))[0][MARKS]
    by_camera = [
        np.linalg.norm(from_camera(c, seen[c.name].joints_m[MARKS]) - true, axis=1).mean()
        for c in CAMERAS
    ]
    return float(max(by_camera))


def test_both_cameras_together_place_the_body_where_it_is() -> None:
    seen = observations(6)
    together = followed_together(seen, Rig(CAMERAS), MODEL, np.ones(MODEL.n_shape))
    after = [off_m(m, i) for i, m in enumerate(together)]
    assert float(np.mean(after)) < 0.015
    assert float(np.mean([off_m(m, i) for i, m in enumerate(seen)])) > 3.0 * float(np.mean(after))


def test_a_body_that_was_followed_is_kept_when_each_camera_alone_has_it_wrong() -> None:
    """Four frames of somebody who stands still; of the last both cameras think that the arms hang."""
    first, hanging = observations(1)[0], observations(5)[4]
    wrong = {
        name: replace(s, joints_m=hanging[name].joints_m, quats_xyzw=hanging[name].quats_xyzw)
        for name, s in first.items()
    }
    frames = [
        {
            name: replace(s, t_ns=nanoseconds(k / 30))
            for name, s in (wrong if k == 3 else first).items()
        }
        for k in range(4)
    ]
    together = followed_together(frames, Rig(CAMERAS), MODEL, np.ones(MODEL.n_shape))
    assert off_m(together[3], 0) < 0.015


def test_an_observation_of_one_camera_or_of_another_picture_is_left_empty() -> None:
    seen = observations(2)
    nobody = {name: replace(s, ids=np.zeros_like(s.ids)) for name, s in seen[1].items()}
    together = followed_together(
        [{"left": seen[0]["left"]}, nobody], Rig(CAMERAS), MODEL, np.ones(MODEL.n_shape)
    )
    assert together == [{}, {}]
