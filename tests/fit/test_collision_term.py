"""Arms and the trunk: where it is, and the rows that push out of it."""

import numpy as np
import pytest

from mocapd.body.arrays import plain
from mocapd.body.model import Shaper, build_model
from mocapd.body.posing_kernels import forward_kinematics
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.motion_state import apply_step
from mocapd.fit.terms.collision_kernels import SLICES, TorsoSlices, depth_in_torso, push_arms_out
from mocapd.fit.terms.collision_term import TorsoHull, arm_chains
from mocapd.geometry import rotations
from mocapd.types import Floats

MODEL = build_model(1.75)
BODY = Shaper(MODEL)(np.ones(MODEL.n_shape))
TORSO = TorsoHull.of(MODEL).slices_of(BODY)
ARMS = arm_chains(MODEL)
ROOT = MODEL.rest_m[0].copy()


def arms_inside(into_rad: float) -> Floats:
    """Local rotations of a body whose upper arms hang and whose bent forearms go into the belly."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        local[INDEX[side + "UpperArm"]] = rotations.exp(np.array([0.0, 0.0, -1.35 * sign]))
        local[INDEX[side + "LowerArm"]] = rotations.exp(np.array([0.0, 0.0, -into_rad * sign]))
    return local


def depth_and_rows(root: Floats, local: Floats, torso: TorsoSlices = TORSO) -> tuple[float, Floats]:
    R, joints, quats = np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3)), np.empty((N_JOINTS, 4))
    forward_kinematics(MODEL.parents, BODY.rest, root, local, R, joints, quats)
    H, b = np.zeros((MODEL.n_pose, MODEL.n_pose)), np.zeros(MODEL.n_pose)
    cost = push_arms_out(R, joints, MODEL.parents, plain(torso), plain(ARMS), 1.0, H, b)
    return cost, b


def test_the_trunk_is_as_large_as_a_trunk() -> None:
    half_m = TORSO.half_m
    assert (half_m[:, 0] > 0.10).all()
    assert (half_m[:, 0] < 0.24).all()
    assert (half_m[:, 1] > 0.07).all()
    assert (half_m[:, 1] < 0.18).all()


def test_arms_that_hang_or_are_held_out_are_outside() -> None:
    upright = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    assert depth_and_rows(ROOT, upright)[0] == 0.0
    assert depth_and_rows(ROOT, arms_inside(0.0))[0] == 0.0


@pytest.mark.parametrize("side", ["left", "right"])
def test_rows_are_the_derivatives_of_the_cost(side: str) -> None:
    local = arms_inside(0.6)
    torso = TORSO._replace(half_m=np.tile(TORSO.half_m.mean(axis=0), (SLICES, 1)))
    cost, b = depth_and_rows(ROOT, local, torso)
    assert cost > 0.0
    columns = MODEL.space.columns(f"{side}_arm")
    for p in range(columns.start, columns.stop):
        step = np.zeros(MODEL.n_pose)
        step[p] = 1e-5
        ahead, _ = depth_and_rows(*apply_step(MODEL, ROOT, local, step), torso)
        back, _ = depth_and_rows(*apply_step(MODEL, ROOT, local, -step), torso)
        # the cost falls along b: d(depth^2)/dp = -2 b
        assert (ahead - back) / 2e-5 == pytest.approx(-2.0 * b[p], rel=1e-3, abs=1e-6)


def test_a_step_leads_out() -> None:
    root, local = ROOT, arms_inside(0.9)
    before, _ = depth_and_rows(root, local)
    for _ in range(6):
        R, joints, quats = (
            np.empty((N_JOINTS, 3, 3)),
            np.empty((N_JOINTS, 3)),
            np.empty((N_JOINTS, 4)),
        )
        forward_kinematics(MODEL.parents, BODY.rest, root, local, R, joints, quats)
        H, b = np.eye(MODEL.n_pose) * 0.01, np.zeros(MODEL.n_pose)
        push_arms_out(R, joints, MODEL.parents, plain(TORSO), plain(ARMS), 1.0, H, b)
        root, local = apply_step(
            MODEL, root, local, np.asarray(np.linalg.solve(H, b), dtype=np.float64)
        )
    assert depth_and_rows(root, local)[0] < 0.1 * before


def test_the_way_out_is_the_nearest_side() -> None:
    outward = np.empty(3)
    R = np.eye(3)
    hips, top = BODY.rest[INDEX["hips"]], BODY.rest[INDEX["upperChest"]]
    ahead = float(TORSO.half_m[:, 2].mean())
    middle = 0.5 * (hips + top) + [0.0, 0.0, ahead]
    beside = middle + [0.10, 0.0, 0.0]
    depth = depth_in_torso(beside, hips, top, R, *TORSO, outward)
    assert depth > 0.0
    assert outward[0] > 2.0 * np.abs(outward[1:]).max()
    behind = middle - [0.0, 0.0, 0.07]
    assert depth_in_torso(behind, hips, top, R, *TORSO, outward) > 0.0
    assert -outward[2] > 2.0 * np.abs(outward[:2]).max()
