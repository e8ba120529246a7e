"""The body with legs and neck: its shape, its surface, its derivatives, and a solver that uses them."""

import numpy as np
import pytest
import scipy  # its submodules load on first use: they take long to import

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.derivative_kernels import surface_row
from mocapd.body.joint_limit_kernels import limit_residuals
from mocapd.body.joint_limits import from_swing_twist
from mocapd.body.model import build_model, shape_of, shaped
from mocapd.body.pose_space import full_body
from mocapd.body.posing_kernels import difference, forward_kinematics, retract
from mocapd.body.shape import FACTORS, WHOLE_FACTORS, BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS, standard_skeleton
from mocapd.body.surface import LEFT_LEG, LEGS, RIGHT_LEG, Surface
from mocapd.body.surface_building import (
    build_surface,
    build_whole_surface,
    shape_derivatives,
    whole_tubes,
)
from mocapd.geometry import rotations
from mocapd.types import Floats, Ints
from tests.body.random_poses import random_local, random_root
from tests.body.soft_limits import soft_limit

STATURE_M = 1.74
SPACE = full_body()
MODEL = build_model(STATURE_M, SPACE)
UPPER = build_model(STATURE_M)
N = SPACE.n_shape
ODD = BodyShape(
    STATURE_M,
    np.array([1.04, 0.93, 1.03, 0.95, 1.12, 0.9, 1.15, 1.06, 0.95, 1.08, 1.2, 0.96]),
)
LEG = [INDEX[s + b] for s in ("left", "right") for b in ("UpperLeg", "LowerLeg", "Foot", "Toes")]


def whole(**factors: float) -> BodyShape:
    return BodyShape(STATURE_M, np.array([factors.get(name, 1.0) for name in WHOLE_FACTORS]))


def kinematics(rest: Floats, root: Floats, local: Floats) -> PosedJoints:
    out = PosedJoints(
        rest, np.zeros((N_JOINTS, 3, 3)), np.zeros((N_JOINTS, 3)), np.zeros((N_JOINTS, 4))
    )
    forward_kinematics(MODEL.parents, rest, root, local, out.R, out.joints, out.quats)
    return out


def moved(root: Floats, local: Floats, step: Floats) -> tuple[Floats, Floats]:
    out_root, out_local = np.empty(3), np.empty((N_JOINTS, 4))
    groups, shares = MODEL.group_of_joint, MODEL.share_of_joint
    retract(root, local, step, groups, shares, out_root, out_local)
    return out_root, out_local


# --- shape -----------------------------------------------------------------------------------


def test_legs_left_out_are_legs_of_one() -> None:
    seven = ODD.factors[: len(FACTORS)]
    short = BodyShape(STATURE_M, seven)
    long = BodyShape(STATURE_M, np.concatenate([seven, np.ones(5)]))
    assert skeleton_of(short).rest_m.tobytes() == skeleton_of(long).rest_m.tobytes()
    for build in (build_surface, build_whole_surface):
        assert build(short).vertices_m.tobytes() == build(long).vertices_m.tobytes()
    mean = skeleton_of(mean_shape(STATURE_M)).rest_m[LEG]
    assert mean.tobytes() == standard_skeleton(STATURE_M).rest_m[LEG].tobytes()


@pytest.mark.parametrize(
    ("factor", "a", "b"),
    [
        ("thigh_length", "leftUpperLeg", "leftLowerLeg"),
        ("thigh_length", "rightUpperLeg", "rightLowerLeg"),
        ("shank_length", "leftLowerLeg", "leftFoot"),
        ("shank_length", "rightLowerLeg", "rightFoot"),
        ("hip_width", "leftUpperLeg", "rightUpperLeg"),
        ("head_size", "neck", "head"),
    ],
)
def test_a_factor_scales_its_own_length(factor: str, a: str, b: str) -> None:
    def length_m(shape: BodyShape) -> float:
        rest = skeleton_of(shape).rest_m
        return float(np.linalg.norm(rest[INDEX[a]] - rest[INDEX[b]]))

    mean = length_m(whole())
    for name in WHOLE_FACTORS:
        if {name, b} != {"torso_length", "head"}:  # the torso's scales all heights above the hips
            scale = 1.1 if name == factor else 1.0
            assert length_m(whole(**{name: 1.1})) == pytest.approx(scale * mean)


def test_the_feet_stay_on_the_floor_and_all_else_is_raised() -> None:
    mean, tall = (
        skeleton_of(s).rest_m for s in (whole(), whole(thigh_length=1.1, shank_length=0.95))
    )
    thigh, shank = (
        mean[INDEX[a], 1] - mean[INDEX[b], 1]
        for a, b in (("leftUpperLeg", "leftLowerLeg"), ("leftLowerLeg", "leftFoot"))
    )
    for name, j in INDEX.items():
        if name.endswith(("Foot", "Toes")):
            np.testing.assert_allclose(tall[j], mean[j], atol=1e-12)
        elif "Leg" not in name:
            assert tall[j, 1] - mean[j, 1] == pytest.approx(0.1 * thigh - 0.05 * shank)
            np.testing.assert_allclose(tall[j, [0, 2]], mean[j, [0, 2]], atol=1e-12)


# --- surface ---------------------------------------------------------------------------------


def pieces(surface: Surface) -> list[Ints]:
    """The triangles of each connected piece."""
    T = surface.triangles
    ends = (T.ravel(), T[:, [1, 2, 0]].ravel())
    n = len(surface.vertices_m)
    joined = scipy.sparse.coo_array((np.ones(T.size), ends), shape=(n, n))
    count, piece = scipy.sparse.csgraph.connected_components(joined)
    return [T[piece[T[:, 0]] == i] for i in range(count)]


@pytest.mark.parametrize("shape", [whole(), ODD])
def test_every_piece_is_closed_and_turned_outwards(shape: BodyShape) -> None:
    surface = build_whole_surface(shape)
    parts = pieces(surface)
    assert len(parts) == 8  # torso, arms, head, legs, feet
    for triangles in parts:
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        there, times = np.unique(edges, axis=0, return_counts=True)
        assert (times == 1).all()
        np.testing.assert_array_equal(there, np.unique(edges[:, ::-1], axis=0))
        a, b, c = np.moveaxis(surface.vertices_m[triangles], 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0  # six times the volume


def test_legs_are_mirrored_and_are_in_no_area_of_trunk_or_arms() -> None:
    surface = build_whole_surface(ODD)
    left, right = (
        np.unique(surface.triangles[surface.part == part]) for part in (LEFT_LEG, RIGHT_LEG)
    )
    here = surface.vertices_m[left] * np.array([-1.0, 1.0, 1.0])
    apart = np.abs(here[:, None] - surface.vertices_m[right][None]).max(axis=2)
    assert apart.min(axis=1).max() < 1e-9
    on_legs = (surface.part == LEFT_LEG) | (surface.part == RIGHT_LEG)
    assert not surface.area[on_legs].any()
    assert LEGS not in surface.part
    assert (surface.weights >= 0.0).all()
    np.testing.assert_allclose(surface.weights.sum(axis=1), 1.0, atol=1e-12)
    assert (surface.weights > 0).sum(axis=1).max() <= 4


def test_the_whole_body_is_as_tall_and_stands_on_the_floor() -> None:
    vertices = MODEL.vertices_m
    assert vertices[:, 1].min() == pytest.approx(0.0, abs=0.005)
    assert vertices[:, 1].max() == pytest.approx(STATURE_M, abs=0.02)
    joints = MODEL.rest_m
    for side in ("left", "right"):  # the toes' joint is within the shoe
        toes = joints[INDEX[side + "Toes"]]
        near = np.abs(vertices - toes).max(axis=1) < 0.06
        assert near.sum() > 8


def test_above_the_hips_it_is_the_upper_body() -> None:
    n, t = len(UPPER.vertices_m), len(UPPER.triangles)
    assert MODEL.vertices_m[:n].tobytes() == UPPER.vertices_m.tobytes()
    np.testing.assert_array_equal(MODEL.triangles[:t], UPPER.triangles)
    np.testing.assert_array_equal(MODEL.area[:t], UPPER.area)
    assert not MODEL.area[t:].any()
    np.testing.assert_array_equal(MODEL.d_vertices[: UPPER.n_shape, :n], UPPER.d_vertices)


def test_the_surface_is_linear_in_all_factors() -> None:
    d_vertices, d_rest = shape_derivatives(STATURE_M, whole_tubes, N)
    assert len(d_vertices) == len(d_rest) == N
    vertices, rest = shaped(MODEL, ODD.factors)
    np.testing.assert_allclose(vertices, build_whole_surface(ODD).vertices_m, atol=1e-9)
    np.testing.assert_allclose(rest, skeleton_of(shape_of(MODEL, ODD.factors)).rest_m, atol=1e-12)


# --- derivatives -----------------------------------------------------------------------------

STEP, TOLERANCE = 1e-5, 2e-9  # as argued in test_posing_kernels


def point_m(t: int, root: Floats, local: Floats, factors: Floats) -> Floats:
    """The centre of triangle t, posed: blended from its bones in plain numpy."""
    vertices, rest = shaped(MODEL, factors)
    posed = kinematics(rest, root, local)
    centre = vertices[MODEL.triangles[t]].mean(axis=0)
    out = np.zeros(3)
    for bone, weight in zip(MODEL.triangle_bones[t], MODEL.triangle_weights[t], strict=True):
        arm = rotations.rotate(posed.quats[bone], centre - rest[bone])
        out += weight * (arm + posed.joints[bone])
    return out


@pytest.mark.parametrize("part", [LEFT_LEG, RIGHT_LEG, 3])
def test_rows_of_legs_and_head_equal_central_differences(part: int) -> None:
    rng = np.random.default_rng(part)
    root, local = random_root(part), random_local(part)
    factors = 1.0 + 0.1 * rng.uniform(-1.0, 1.0, N)
    vertices, rest = shaped(MODEL, factors)
    posed = kinematics(rest, root, local)
    moving = np.zeros(MODEL.n_pose, bool)
    for t in rng.choice(np.flatnonzero(MODEL.part == part), 8, replace=False):
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
            step = np.zeros(len(row))
            step[k] = STEP
            ends = [point_m(t, *moved(root, local, s), factors) for s in (-step, step)]
            wanted[k] = g @ (ends[1] - ends[0]) / (2 * STEP)
        np.testing.assert_allclose(row, wanted, atol=TOLERANCE)
        moving |= np.abs(row) > 1e-3
    limb = {LEFT_LEG: "left_leg", RIGHT_LEG: "right_leg"}.get(part, "head")
    assert moving[SPACE.columns(limb)].all()
    other = {LEFT_LEG: "right_leg", RIGHT_LEG: "left_leg"}.get(part, "left_leg")
    assert not moving[SPACE.columns(other)].any()


# --- a solver --------------------------------------------------------------------------------


def solved(points_m: Floats, start: tuple[Floats, Floats], rounds: int) -> tuple[Floats, Floats]:
    """Gauss-Newton of the pose on joint centres (J,3) and on points beside them that tell of twists,
    within the joint limits."""
    root, local = start
    beside = np.array([0.06, 0.05, 0.07])
    P, G = SPACE.n_pose, len(SPACE.groups)
    row, residual, slope = np.empty(P), np.empty((G, 3)), np.empty((G, 3, 3))
    for _ in range(rounds):
        posed = kinematics(MODEL.rest_m, root, local)
        H, b = 1e-6 * np.eye(P), np.zeros(P)
        for n, wanted in enumerate(points_m):
            j = n % N_JOINTS
            point = MODEL.rest_m[j] + (beside if n >= N_JOINTS else 0.0)
            here = posed.joints[j] + posed.R[j] @ (point - MODEL.rest_m[j])
            for axis in np.eye(3):
                surface_row(
                    point, np.array([j], np.int32), np.ones(1), axis, plain(MODEL.articulation), plain(posed), row,
                )  # fmt: skip
                H += np.outer(row, row)
                b += row * float(axis @ (wanted - here))
        limit_residuals(local, plain(SPACE.limits), residual, slope)
        for g in range(G):
            at = slice(3 + 3 * g, 6 + 3 * g)
            H[at, at] += 0.1 * slope[g].T @ slope[g]
            b[at] -= 0.1 * slope[g].T @ residual[g]
        step: Floats = np.asarray(np.linalg.solve(H, b), dtype=np.float64)
        root, local = moved(root, local, step)
    return root, local


@pytest.mark.parametrize("seed", range(5))
def test_gauss_newton_recovers_a_whole_pose(seed: int) -> None:
    """From half way to a pose that bends every joint: joints to under 1 mm, also those of toes and head."""
    rng = np.random.default_rng(seed)
    rest = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    bent = rest.copy()
    limits = SPACE.limits
    for g, names in enumerate(SPACE.groups):
        low, high = (np.clip(a[g], -2.0, 2.0) for a in (limits.lower_rad, limits.upper_rad))
        angles = rng.uniform(0.7 * low, 0.7 * high) / len(names)
        bent[[INDEX[name] for name in names]] = from_swing_twist(
            angles, max(int(limits.axis[g]), 0)
        )
    bent[0] = rotations.exp(np.array([0.2, 0.9, -0.1]))
    assert soft_limit(limits, bent)[0] == 0.0
    truth = MODEL.rest_m[0] + np.array([0.2, -0.3, 0.4]), bent
    there = kinematics(MODEL.rest_m, *truth)
    beside = there.joints + np.einsum("jab,b->ja", there.R, np.array([0.06, 0.05, 0.07]))
    wanted = np.concatenate([there.joints, beside])
    half_way = rotations.slerp(rest, bent, np.full(N_JOINTS, 0.5))
    found = solved(wanted, (MODEL.rest_m[0].copy(), half_way), 12)
    apart = np.linalg.norm(kinematics(MODEL.rest_m, *found).joints - there.joints, axis=1)
    assert apart.max() < 1e-3
    back = np.empty(SPACE.n_pose)
    difference(*found, *truth, MODEL.joint_of_group, MODEL.share_of_joint, back)
    assert np.degrees(np.abs(back[3:]).max()) < 1.0
