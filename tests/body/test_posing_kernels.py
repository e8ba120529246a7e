"""Compiled posing against the plain path: skeleton, surface, cameras; and its derivatives."""

import numpy as np
import pytest

from mocapd.body.arrays import PosedJoints, camera_arrays, plain
from mocapd.body.bones import NAMES
from mocapd.body.derivative_kernels import joint_shape_derivatives, surface_row
from mocapd.body.model import build_model, shaped
from mocapd.body.posing_kernels import (
    difference,
    forward_kinematics,
    quat_exp,
    quat_log,
    quat_multiply,
    retract,
    skin_and_project,
)
from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX, N_JOINTS, PARENTS, joint_positions
from mocapd.body.surface import LEGS, posed_vertices
from mocapd.body.surface_building import build_surface
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project, to_camera
from mocapd.types import Camera, Floats, Skeleton
from tests.body.random_poses import pose_of, random_local, random_root
from tests.geometry.rigs import ring

STATURE_M = 1.74
MODEL = build_model(STATURE_M)
SEEDS = range(4)


def skeleton(factors: Floats | None = None) -> Skeleton:
    rest = shaped(MODEL, np.ones(MODEL.n_shape) if factors is None else factors)[1]
    return Skeleton(NAMES, PARENTS, rest)


def kinematics(rest: Floats, root: Floats, local: Floats) -> tuple[Floats, Floats, Floats]:
    R, joints, turned = np.zeros((N_JOINTS, 3, 3)), np.zeros((N_JOINTS, 3)), np.zeros((N_JOINTS, 4))
    forward_kinematics(MODEL.parents, rest, root, local, R, joints, turned)
    return R, joints, turned


def posed_joints(rest: Floats, root: Floats, local: Floats) -> PosedJoints:
    return PosedJoints(rest, *kinematics(rest, root, local))


def moved(root: Floats, local: Floats, step: Floats) -> tuple[Floats, Floats]:
    out_root, out_local = np.empty(3), np.empty((N_JOINTS, 4))
    groups, shares = MODEL.group_of_joint, MODEL.share_of_joint
    retract(root, local, step, groups, shares, out_root, out_local)
    return out_root, out_local


# --- quaternions -----------------------------------------------------------------------------


def test_quaternion_kernels_equal_the_geometry_module() -> None:
    rng = np.random.default_rng(3)
    out, vector = np.empty(4), np.empty(3)
    for scale in (0.0, 1e-12, 1e-5, 9e-5, 1.1e-4, 0.3, 3.1):
        v = scale * rotations.rotate(rotations.exp(rng.normal(size=3)), np.array([1.0, 0.0, 0.0]))
        quat_exp(v[0], v[1], v[2], out)
        np.testing.assert_allclose(out, rotations.exp(v), rtol=1e-12, atol=1e-15)
        quat_log(out, vector)
        np.testing.assert_allclose(vector, v, rtol=1e-9, atol=1e-18)
        quat_log(-out, vector)  # the same rotation
        np.testing.assert_allclose(vector, v, rtol=1e-9, atol=1e-18)
    a, b = rotations.exp(rng.normal(size=(2, 3)))
    quat_multiply(a, b, out)
    np.testing.assert_allclose(out, rotations.multiply(a, b), atol=1e-15)


# --- forward ---------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", SEEDS)
def test_kinematics_equals_the_plain_path(seed: int) -> None:
    body = skeleton(1.0 + 0.1 * np.random.default_rng(seed).uniform(-1, 1, MODEL.n_shape))
    root, local = random_root(seed), random_local(seed)
    R, joints, turned = kinematics(body.rest_m, root, local)
    pose = pose_of(body, root, local)
    np.testing.assert_allclose(joints, joint_positions(body, pose), atol=1e-12)
    np.testing.assert_allclose(rotations.canonical(turned), pose.quats_xyzw, atol=1e-12)
    np.testing.assert_allclose(R, rotations.to_matrix(pose.quats_xyzw), atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_skinning_and_projection_equal_the_plain_path(seed: int) -> None:
    root, local = random_root(seed), random_local(seed)
    body = skeleton()
    posed = posed_joints(body.rest_m, root, local)
    surface = build_surface(mean_shape(STATURE_M))
    used = np.unique(surface.triangles[surface.part != LEGS])
    world = posed_vertices(surface, body, pose_of(body, root, local), posed.joints)[used]
    camera, offset, scale = ring(3)[seed % 3], np.array([37.0, -14.0]), 0.5
    xy, depth = np.empty((len(used), 2)), np.empty(len(used))
    skin_and_project(
        MODEL.vertices_m, plain(MODEL.skin), plain(posed), plain(camera_arrays(camera)), offset, scale, xy, depth,
    )  # fmt: skip
    # block k of a picture averaged down by two covers pixels 2k and 2k + 1: its centre is 2k + 0.5
    wanted = (project(camera, world) - offset + 0.5) * scale - 0.5
    np.testing.assert_allclose(depth, to_camera(camera, world)[:, 2], atol=1e-12)
    np.testing.assert_allclose(xy, wanted, atol=1e-8)


def test_points_behind_the_camera_are_marked() -> None:
    here = ring(1)[0]
    behind = Camera("back", here.size_px, here.K, here.dist, here.R, here.t_m - [0.0, 0.0, 9.0])
    body = skeleton()
    posed = posed_joints(body.rest_m, body.rest_m[0], random_local(0, 0.0))
    n = len(MODEL.vertices_m)
    xy, depth = np.zeros((n, 2)), np.zeros(n)
    skin_and_project(
        MODEL.vertices_m, plain(MODEL.skin), plain(posed), plain(camera_arrays(behind)), np.zeros(2), 1.0, xy, depth,
    )  # fmt: skip
    assert (depth < 0).all()
    assert np.isfinite(xy).all()


# --- the pose as a manifold ------------------------------------------------------------------


@pytest.mark.parametrize("seed", SEEDS)
def test_difference_undoes_retract(seed: int) -> None:
    """Rotations stay under pi: there the logarithm has one value."""
    step = np.random.default_rng(seed).uniform(-1.0, 1.0, MODEL.n_pose) * 1.7
    root, local = random_root(seed), random_local(seed)
    there = moved(root, local, step)
    back = np.empty(MODEL.n_pose)
    difference(*there, root, local, MODEL.joint_of_group, MODEL.share_of_joint, back)
    np.testing.assert_allclose(back, step, atol=1e-12)


def test_retract_in_place_and_by_nothing() -> None:
    root, local = random_root(0), random_local(0)
    there = moved(root, local, np.zeros(MODEL.n_pose))
    np.testing.assert_array_equal(there[0], root)
    np.testing.assert_allclose(there[1], local, atol=1e-15)
    step = np.full(MODEL.n_pose, 0.2)
    wanted = moved(root, local, step)
    retract(root, local, step, MODEL.group_of_joint, MODEL.share_of_joint, root, local)
    np.testing.assert_array_equal(root, wanted[0])
    np.testing.assert_array_equal(local, wanted[1])


def test_a_group_turns_in_its_parent_s_frame_and_shares_its_bend() -> None:
    root, local = random_root(1), random_local(1)
    for g, names in enumerate(MODEL.space.groups):
        step = np.zeros(MODEL.n_pose)
        step[3 + 3 * g : 6 + 3 * g] = turn = np.array([0.3, -0.2, 0.5])
        _, there = moved(root, local, step)
        for name, j in INDEX.items():
            share = 1.0 / len(names) if name in names else 0.0
            wanted = rotations.multiply(rotations.exp(share * turn), local[j])
            np.testing.assert_allclose(there[j], wanted, atol=1e-12)


# --- derivatives -----------------------------------------------------------------------------

# Central differences of a function with third derivative f''' err by h^2 |f'''| / 6 from curvature
# and by eps |f| / h from rounding. Here a point is within a few metres of the axes it turns about, so
# |f|, |f'''| < 5 for |g| = 1: with h = 1e-5 that is 1e-10 and 1e-10. An error in the formula would
# be of the size of a lever arm, centimetres: eight orders of magnitude more.
STEP = 1e-5
TOLERANCE = 2e-9


def point_m(t: int, root: Floats, local: Floats, factors: Floats) -> Floats:
    """The centre of triangle t, posed: blended from its bones in plain numpy."""
    vertices, rest = shaped(MODEL, factors)
    pose = pose_of(Skeleton(NAMES, PARENTS, rest), root, local)
    joints = joint_positions(Skeleton(NAMES, PARENTS, rest), pose)
    centre = vertices[MODEL.triangles[t]].mean(axis=0)
    out = np.zeros(3)
    for bone, weight in zip(MODEL.triangle_bones[t], MODEL.triangle_weights[t], strict=True):
        arm = rotations.rotate(pose.quats_xyzw[bone], centre - rest[bone])
        out += weight * (arm + joints[bone])
    return out


@pytest.mark.parametrize("seed", SEEDS)
def test_surface_row_equals_central_differences(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root, local = random_root(seed), random_local(seed)
    factors = 1.0 + 0.1 * rng.uniform(-1.0, 1.0, MODEL.n_shape)
    vertices, rest = shaped(MODEL, factors)
    posed = posed_joints(rest, root, local)
    for t in rng.integers(0, len(MODEL.triangles), 12):
        g = rng.normal(size=3)
        g /= np.linalg.norm(g)
        corners = MODEL.triangles[t]
        row = np.full(MODEL.n_pose, np.nan)
        surface_row(
            vertices[corners].mean(axis=0), MODEL.triangle_bones[t], MODEL.triangle_weights[t],
            g, plain(MODEL.articulation), plain(posed), row,
        )  # fmt: skip
        wanted = np.empty_like(row)
        for k in range(len(row)):
            ends = []
            for h in (-STEP, STEP):
                step = np.zeros(len(row))
                step[k] = h
                ends.append(point_m(t, *moved(root, local, step), factors))
            wanted[k] = g @ (ends[1] - ends[0]) / (2 * STEP)
        np.testing.assert_allclose(row, wanted, atol=TOLERANCE)
        assert np.abs(row).max() > 1e-2


@pytest.mark.parametrize("seed", SEEDS)
def test_joint_shape_derivatives_equal_differences(seed: int) -> None:
    """Joints are linear in the factors while the rotations stay: differences are exact."""
    root, local = random_root(seed), random_local(seed)
    R, joints, _ = kinematics(MODEL.rest_m, root, local)
    out = np.zeros((MODEL.n_shape, N_JOINTS, 3))
    joint_shape_derivatives(MODEL.parents, MODEL.d_rest, R, out)
    for n in range(MODEL.n_shape):
        factors = np.ones(MODEL.n_shape)
        factors[n] += 0.1
        there = kinematics(shaped(MODEL, factors)[1], root, local)[1]
        np.testing.assert_allclose(out[n], (there - joints) / 0.1, atol=1e-12)
