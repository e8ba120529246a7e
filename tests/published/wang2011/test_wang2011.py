"""The paper's variant, on pictures painted by its own rasteriser: kernels, placement, solver, tracker."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import camera_arrays, pinhole_arrays, plain
from mocapd.body.model import build_model
from mocapd.body.posing_kernels import retract
from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.published.wang2011.centroid_ik import CentroidSolver, Target
from mocapd.published.wang2011.covariances import load_covariances
from mocapd.published.wang2011.drawing import (
    Grid,
    Posture,
    classified_patches,
    draw,
    posed_joints,
    posed_points,
    posture,
    triangle_points,
)
from mocapd.published.wang2011.params import Params, paper_params, tolerating
from mocapd.published.wang2011.patch_kernels import centroid_rows
from mocapd.published.wang2011.placement import Constraints, Guess, place
from mocapd.published.wang2011.segmenter import Wang2011Segmenter
from mocapd.published.wang2011.tracker import Wang2011Tracker
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database.database import DatabaseParams, PoseDatabase, build_database
from mocapd.shirt.pose_database.key_poses import arm_rotations
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.tracking.tracking_state import TrackingStateParams
from mocapd.types import Bytes, Camera, Floats, Frame, FrameSet, Rig, Tracking
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

STATURE_M = 1.75
FRAME_NS = 33_333_333
MODEL = build_model(STATURE_M)
COLOUR = shirt_labels(MODEL).label


def camera(name: str, azimuth_deg: float) -> Camera:
    a = np.radians(azimuth_deg)
    centre = np.array([2.7 * np.sin(a), 1.4, 2.7 * np.cos(a)])
    z = np.array([0.0, 1.15, 0.0]) - centre
    z /= np.linalg.norm(z)
    x = np.cross(z, [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])
    K = np.array([[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]])
    return Camera(name, (640, 480), K, np.zeros(5), R, -R @ centre)


RIG = Rig((camera("left", -25.0), camera("right", 35.0)))


def standing(arm: str = "side_low", x_m: float = 0.0, yaw_rad: float = 0.1) -> Posture:
    upper, lower = arm_rotations(arm)
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw_rad, 0.0]))
    mirror = np.array([1.0, -1.0, -1.0, 1.0])
    local[INDEX["leftUpperArm"]], local[INDEX["leftLowerArm"]] = upper, lower
    local[INDEX["rightUpperArm"]], local[INDEX["rightLowerArm"]] = upper * mirror, lower * mirror
    return posture(MODEL, np.array([x_m, 0.98, 0.0]), local)


def colours() -> ColourModel:
    shirt = standard_shirt()
    return ColourModel(
        names=shirt.colour_names,
        mean=shirt.srgb / 255.0,
        covariance=np.tile(0.03**2 * np.eye(3), (10, 1, 1)),
        version="standard-v1",
    )


@cache
def empty_room(light: tuple[float, ...]) -> Bytes:
    """A grey room; light: of all channels, or of each (BGR)."""
    rng = np.random.default_rng(1)
    grey = np.full((480, 640, 3), 105.0) + rng.normal(0.0, 2.0, (480, 640, 1))
    pixels = np.clip(grey * light, 0, 255).astype(np.uint8)
    pixels.flags.writeable = False
    return pixels


def picture(body: Posture | None, seen_by: Camera, light: tuple[float, ...] = (1.0,)) -> Bytes:
    """The room, with the body in it."""
    room = empty_room(light)
    if body is None:
        return room
    pixels = room.copy()
    seen = draw(MODEL, body, seen_by, Grid(0, 0, 640, 480, 1)).triangle_at
    paint = np.vstack([[70, 60, 50], standard_shirt().srgb])[:, ::-1].astype(float)
    painted = np.clip(paint * light, 0, 255).astype(np.uint8)
    pixels[seen >= 0] = painted[COLOUR[seen[seen >= 0]]]
    pixels.flags.writeable = False
    return pixels


def frame_set(
    body: Posture | None, seq: int, cameras: tuple[Camera, ...] = RIG.cameras
) -> FrameSet:
    t_ns = seq * FRAME_NS
    return FrameSet(t_ns, {c.name: Frame(c.name, seq, t_ns, picture(body, c)) for c in cameras})


@pytest.fixture(scope="module")
def database() -> PoseDatabase:
    return build_database(DatabaseParams(count=4000, cells=32))


def tracker(database: PoseDatabase, params: Params | None = None) -> Stepping:
    white = {c.name: np.eye(3) for c in RIG.cameras}
    made = Wang2011Tracker(RIG, STATURE_M, colours(), white, database, params)
    return Stepping(made, mean_shape(STATURE_M))


def arm_error_m(tracked: Floats, body: Posture) -> float:
    names = [s + b for s in ("left", "right") for b in ("UpperArm", "LowerArm", "Hand")]
    joints = [INDEX[name] for name in ["hips", "neck", *names]]
    return float(np.sqrt(((tracked[joints] - body.joints_m[joints]) ** 2).sum(axis=1).mean()))


# --- patches ---------------------------------------------------------------------------------


def test_patches_of_a_drawing_equal_numpy_twin() -> None:
    seen = draw(MODEL, standing(), RIG.cameras[0], Grid(100, 50, 200, 180, 2))
    patch_at = np.where(seen.triangle_at >= 0, MODEL.area[seen.triangle_at], 255)
    for p in range(N_AREAS):
        y, x = np.nonzero(patch_at == p)
        assert seen.count[p] == len(x)
        if len(x):
            np.testing.assert_allclose(seen.centroid[p], [x.mean(), y.mean()])
    drawn = seen.triangle_at[seen.triangle_at >= 0]
    np.testing.assert_array_equal(seen.samples, np.bincount(drawn, minlength=len(seen.samples)))


def test_a_colour_is_given_to_the_nearer_of_its_two_patches() -> None:
    shirt = standard_shirt()
    a, b = np.flatnonzero(shirt.colour_of_patch == 4)
    triangle_at = np.full((10, 20), -1, np.int32)
    triangle_at[5, 2], triangle_at[5, 17] = 0, 1
    patch = np.array([a, b], np.uint8)
    ids = np.zeros((10, 20), np.uint8)
    ids[4:7, 1:5], ids[4:7, 15:19] = 4, 4
    nearest = np.full((10, 10, 20, 2), -1, np.int16)
    nearest[3, :, :10], nearest[3, :, 10:] = (5, 2), (5, 17)
    count, centroid = classified_patches(ids, nearest, triangle_at, patch)
    assert count[a] == count[b] == 12
    assert centroid[a].tolist() == [2.5, 5.0]
    assert centroid[b].tolist() == [16.5, 5.0]


def test_centroid_derivative_equals_differences() -> None:
    body, c = standing(), RIG.cameras[0]
    points = triangle_points(MODEL)
    seen = draw(MODEL, body, c, Grid(0, 0, 320, 240, 2))
    wanted = seen.count >= 20
    wanted[0] = False
    J = np.empty((N_AREAS, 2, MODEL.n_pose))
    centroid_rows(
        seen.samples, wanted, seen.count, points, MODEL.area, plain(MODEL.surface), plain(MODEL.articulation),
        plain(posed_joints(MODEL, body)), plain(pinhole_arrays(camera_arrays(c), 1.0)), J,
    )  # fmt: skip

    def centroids(at: Posture) -> Floats:
        xy = project(c, posed_points(MODEL, at, points))
        out = np.zeros((N_AREAS, 2))
        for p in np.flatnonzero(wanted):
            here = MODEL.area == p
            out[p] = np.average(xy[here], axis=0, weights=seen.samples[here])
        return out

    for k in range(MODEL.n_pose):
        ends = []
        for h in (-1e-5, 1e-5):
            step = np.zeros(MODEL.n_pose)
            step[k] = h
            ends.append(centroids(_moved(body, step)))
        slope = (ends[1] - ends[0]) / 2e-5
        np.testing.assert_allclose(J[wanted, :, k], slope[wanted], atol=0.3, rtol=2e-3)


def _moved(body: Posture, step: Floats) -> Posture:
    root, local = np.empty(3), np.empty_like(body.local_xyzw)
    retract(
        body.root_m, body.local_xyzw, step, MODEL.group_of_joint, MODEL.share_of_joint, root, local
    )
    return posture(MODEL, root, local)


# --- placement and solver --------------------------------------------------------------------


def test_placement_finds_the_root_from_a_rough_guess() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(0.0, 0.3, (20, 3))
    root, q = np.array([0.3, 1.0, -0.2]), rotations.exp(np.array([0.1, 0.6, -0.1]))
    seen, starts = [], []
    for c in RIG.cameras:
        p = (root + rotations.rotate(q[None], points)) @ c.R.T + c.t_m
        xy = p[:, :2] / p[:, 2:]
        xy[:2] += 0.4  # two wrong patches
        seen.append(Constraints(c, points, xy, np.ones(len(points))))
        rough = rotations.multiply(rotations.exp(rng.normal(0.0, 0.25, 3)), q)
        in_camera = rotations.multiply(rotations.from_matrix(c.R), rough)
        starts.append(
            Guess(c, np.arange(1), np.ones(1), in_camera, in_camera,
                  c.R @ (root + rng.normal(0.0, 0.25, 3)) + c.t_m)
        )  # fmt: skip
    found_m, found_q = place(starts, seen)
    assert np.abs(found_m - root).max() < 0.01
    assert rotations.angle_rad(found_q, q) < 0.02


def test_solver_moves_the_pose_to_where_the_patches_are_seen() -> None:
    true = standing()
    rng = np.random.default_rng(0)
    spread = np.concatenate([np.full(3, 0.03), np.full(MODEL.n_pose - 3, 0.12)])
    start = _moved(true, rng.normal(0.0, spread))
    grid = Grid(0, 0, 320, 240, 2)
    targets = []
    for c in RIG.cameras:
        seen = draw(MODEL, true, c, grid)
        wanted = seen.count >= 20
        wanted[0] = False
        targets.append(Target(c, grid, grid.to_pixels(seen.centroid), wanted))
    solver = CentroidSolver(MODEL, load_covariances(), 4)
    found = solver.solve(targets, start, None, 1.0, 12)
    assert arm_error_m(found.joints_m, true) < 0.4 * arm_error_m(start.joints_m, true)
    # without evidence the two priors decide
    assert arm_error_m(solver.solve([], start, None, 1.0, 12).joints_m, start) < 1e-6
    between = solver.solve([], start, true, 1 / 30, 12)
    assert arm_error_m(between.joints_m, true) < arm_error_m(start.joints_m, true)


# --- segmenter -------------------------------------------------------------------------------------


def test_poor_classification_falls_back_on_a_reference_illumination() -> None:
    c, body = RIG.cameras[0], standing()
    light = (0.45, 0.6, 0.9)  # BGR
    W = np.diag(1.0 / np.array(light[::-1]))
    segmenter = Wang2011Segmenter(c, colours(), np.eye(3), Params())
    segmenter.look(picture(None, c))
    before = segmenter.look(picture(body, c, light))
    segmenter.references = (np.eye(3), W)
    after = segmenter.look(picture(body, c, light))
    assert after is not None
    assert before is None or 2 * np.count_nonzero(before.ids) < np.count_nonzero(after.ids)
    np.testing.assert_array_equal(segmenter.W, W)
    fixed = Wang2011Segmenter(c, colours(), np.eye(3), Params(adaptive_white_balance=False))
    fixed.references = (np.eye(3), W)
    fixed.look(picture(body, c, light))
    np.testing.assert_array_equal(fixed.W, np.eye(3))


def test_white_balance_follows_the_light_and_a_new_light_is_remembered() -> None:
    c, body = RIG.cameras[0], standing()
    light = (0.5, 0.8, 0.9)  # BGR, a lamp
    segmenter = Wang2011Segmenter(c, colours(), np.eye(3), Params())
    grid = Grid(0, 0, 320, 240, 2)
    seen = draw(MODEL, body, c, grid)
    refined = np.where(seen.triangle_at >= 0, COLOUR[seen.triangle_at], 0).astype(np.uint8)
    segmenter.learn(picture(body, c, light), grid, seen, COLOUR, refined)
    white = segmenter.W @ light[::-1]
    assert white.max() / white.min() < 1.2  # 1.8 before; the hue is right, brightness may lag
    assert len(segmenter.references) == 2


# --- tracker ---------------------------------------------------------------------------------


def test_follows_a_person_and_says_lost_when_nobody_is_there(database: PoseDatabase) -> None:
    t = tracker(database)
    states = [t.step(frame_set(None, seq)).body for seq in range(3)]
    assert all(state.tracking is Tracking.LOST for state in states)
    assert all(state.joints_m is None and not state.confidence.any() for state in states)
    for seq in range(3, 8):
        body = standing(x_m=0.02 * seq)
        state = t.step(frame_set(body, seq)).body
    assert state.tracking is Tracking.LIVE
    assert state.joints_m is not None
    assert state.pose is not None
    assert arm_error_m(state.joints_m, body) < 0.07
    assert state.confidence[INDEX["leftHand"]] > 0.5
    assert state.confidence[INDEX["leftFoot"]] == 0.0
    assert state.cameras == ("left", "right")
    np.testing.assert_allclose(np.linalg.norm(state.pose.quats_xyzw, axis=1), 1.0)
    after = [t.step(frame_set(None, seq)).body for seq in range(8, 28)]
    assert after[0].tracking is Tracking.COASTING
    coasted_s = sum(b.tracking is Tracking.COASTING for b in after) * FRAME_NS * 1e-9
    assert coasted_s == pytest.approx(TrackingStateParams().coast_s, abs=0.05)  # as every tracker
    assert after[-1].tracking is Tracking.LOST


def test_one_camera_and_then_none(database: PoseDatabase) -> None:
    t = tracker(database)
    t.step(frame_set(None, 0))
    for seq in range(1, 4):
        body = standing()
        state = t.step(frame_set(body, seq, RIG.cameras[:1])).body
    assert state.tracking is Tracking.LIVE
    assert state.joints_m is not None
    assert arm_error_m(state.joints_m, body) < 0.25
    assert t.step(FrameSet(40 * FRAME_NS, {})).body.tracking is Tracking.LOST


def test_the_same_frames_after_a_reset_give_the_same_output(database: PoseDatabase) -> None:
    t = tracker(database)
    sets = [frame_set(None, 0), *(frame_set(standing(x_m=0.03 * i), i) for i in range(1, 4))]
    runs = []
    for _ in range(2):
        t.reset()
        runs.append([t.step(frames).body.joints_m for frames in sets])
    assert runs[0][-1] is not None
    for a, b in zip(*runs, strict=True):
        assert (a is None) == (b is None)
        if a is not None and b is not None:
            np.testing.assert_array_equal(a, b)


def test_the_switches_make_the_papers_baseline(database: PoseDatabase) -> None:
    baseline = Params(pose_prior=False, adaptive_white_balance=False)
    for params in (baseline, tolerating(Params()), replace(baseline, threshold=4.0)):
        t = tracker(database, params)
        t.step(frame_set(None, 0))
        for seq in range(1, 4):
            state = t.step(frame_set(standing(), seq)).body
        assert state.tracking is Tracking.LIVE
    assert paper_params(baseline=True) == baseline
