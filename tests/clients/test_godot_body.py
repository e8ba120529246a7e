"""The Godot add-on's XRBodyTracker, and what Godot 4's own XRBodyModifier3D makes of it and of GodotXRVmcTracker's.

The joints come from the add-on under Godot 3, the engine's part is re-implemented in
`tests/outputs/receivers/godot_xr_body.py`. `make engines` runs Godot 4 itself.
"""

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from mocapd.types import Floats
from tests.clients.godot.avatars import AVATARS, godot_name, heights_m, wearer_offsets_m
from tests.clients.played import Played
from tests.golden import make_osc, make_vmc
from tests.outputs.receivers.godot_xr_body import ROOT, VALID, XrJoint, driven, reference_axes
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker

TRACKED = 2 | 8
MILLIMETRE_M = 0.001
FLOOR_M = 0.002
FACING_MINUS_Z = np.diag(
    [-1.0, 1.0, -1.0]
)  # from mocapd's world, in which a person at rest faces +Z

Stream = Callable[[str], Played]


@pytest.fixture(scope="module")
def played(godot_told: dict[str, Any]) -> Stream:
    return lambda name: Played.read(godot_told[name])


def truth() -> dict[str, Floats]:
    told = json.loads(make_osc.JOINTS.read_text())
    return {godot_name(name): np.array(one["p_m"]) for name, one in told.items()}


def matrix(axes: Mapping[str, Any]) -> Floats:
    return np.array([axes["x"], axes["y"], axes["z"]]).T


def xr_joints(stream: Played) -> dict[str, XrJoint]:
    """As the add-on sets them, with the root under the hips."""
    joints = {
        godot_name(name): XrJoint(np.array(one["origin"]), matrix(one), int(one["flags"]))
        for name, one in stream.joints.items()
    }
    hips = joints["Hips"]
    heading = matrix(stream.persons["0"]["heading"])
    return {ROOT: XrJoint(hips.origin_m * (1.0, 0.0, 1.0), heading, hips.flags), **joints}


def greatest_error_m(placed: Mapping[str, Floats], world: Floats) -> float:
    return max(float(np.linalg.norm(placed[name] - world @ at_m)) for name, at_m in truth().items())


def test_bones_of_the_profile_point_along_their_y() -> None:
    offsets = wearer_offsets_m()
    axes = reference_axes(offsets)
    pairs = (("LeftUpperArm", "LeftLowerArm"), ("RightLowerArm", "RightHand"), ("LeftUpperLeg", "LeftLowerLeg"),
             ("RightLowerLeg", "RightFoot"), ("LeftFoot", "LeftToes"), ("Spine", "Chest"))  # fmt: skip
    for bone, below in pairs:
        along = offsets[below] / np.linalg.norm(offsets[below])
        assert axes[bone][:, 1] @ along > 0.8


@pytest.mark.parametrize("rotation_only", [True, False])
def test_an_avatar_is_posed_as_the_person_stands(played: Stream, rotation_only: bool) -> None:
    placed = driven(xr_joints(played("golden")), wearer_offsets_m(), rotation_only=rotation_only)
    assert greatest_error_m(placed, np.eye(3)) < MILLIMETRE_M


def test_an_avatar_of_half_the_size_stands_on_the_floor_with_its_own_bones(played: Stream) -> None:
    half = {name: 0.5 * offset_m for name, offset_m in wearer_offsets_m().items()}
    joints = xr_joints(played("golden"))
    placed = driven(joints, half, rotation_only=True, motion_scale=0.5)
    under = joints[ROOT].origin_m
    for name, at_m in truth().items():
        assert placed[name] == pytest.approx(under + 0.5 * (at_m - under), abs=MILLIMETRE_M)


@pytest.mark.parametrize("name", ["waving", "on one leg"])
@pytest.mark.parametrize("avatar", list(AVATARS))
def test_the_feet_of_any_avatar_stand_on_the_floor(played: Stream, avatar: str, name: str) -> None:
    stream, offsets = played(name), AVATARS[avatar]
    scale = stream.persons["0"]["motion_scale"][avatar]
    placed = driven(xr_joints(stream), offsets, rotation_only=True, motion_scale=scale)
    over_floor_m = {bone: placed[bone][1] - at_m for bone, at_m in heights_m(offsets).items()}
    assert min(over_floor_m.values()) == pytest.approx(0.0, abs=FLOOR_M)
    assert (over_floor_m["LeftFoot"] > 0.05) == (name == "on one leg")


def test_an_avatar_of_the_wearers_own_bones_is_as_high_as_the_wearer(played: Stream) -> None:
    for name in ("waving", "on one leg"):
        scale = played(name).persons["0"]["motion_scale"]["the wearer"]
        assert scale == pytest.approx(1.0, abs=0.005)


def test_the_root_looks_to_where_the_person_faces_along_its_minus_z(played: Stream) -> None:
    heading = matrix(played("golden").persons["0"]["heading"])
    assert np.allclose(heading @ heading.T, np.eye(3), atol=1e-5)
    assert np.isclose(np.linalg.det(heading), 1.0, atol=1e-5)
    forward = -heading[:, 2]
    turned = np.degrees(np.arctan2(forward[0], forward[2]))
    assert turned == pytest.approx(8.0, abs=1.0)  # the hips are turned by that to the left
    assert heading[:, 1] == pytest.approx((0.0, 1.0, 0.0))


def test_flags_are_honest(played: Stream) -> None:
    assert {one["flags"] for one in played("golden").joints.values()} == {VALID | TRACKED}
    assert {one["flags"] for one in played("coasting").joints.values()} == {VALID}
    unseen = played("no evidence").joints
    assert unseen["rightToes"]["flags"] == VALID
    assert unseen["rightFoot"]["flags"] == VALID | TRACKED
    assert played("lost first").joints == {}


def test_what_is_not_sent_holds_while_the_rest_moves(played: Stream) -> None:
    offsets = wearer_offsets_m()
    placed = driven(xr_joints(played("a joint is missing")), offsets, rotation_only=True)
    expected = truth()
    for name in ("LeftUpperArm", "RightHand", "Head", "LeftFoot"):
        assert np.linalg.norm(placed[name] - expected[name]) < MILLIMETRE_M
    reach_m = np.linalg.norm(placed["LeftHand"] - placed["LeftUpperArm"])
    assert reach_m == pytest.approx(
        np.linalg.norm(offsets["LeftLowerArm"] + offsets["LeftHand"]), abs=MILLIMETRE_M
    )


@pytest.mark.parametrize("rotation_only", [True, False])
@pytest.mark.parametrize("bundling", ["two", "one"])
def test_the_unmodified_vmc_tracker_poses_an_avatar_from_our_vmc(
    bundling: Any, rotation_only: bool
) -> None:
    assert not GodotXrVmcTracker().has_tracking_data
    receiver = GodotXrVmcTracker()
    for datagram in make_vmc.kept(bundling):
        receiver.receive(datagram)
    assert receiver.has_tracking_data
    placed = driven(receiver.tracker(), wearer_offsets_m(), rotation_only=rotation_only)
    toes = {name: at_m for name, at_m in placed.items() if name.endswith("Toes")}  # it sets none
    expected = {name: at_m for name, at_m in truth().items() if name not in toes}
    for name, at_m in expected.items():
        assert np.linalg.norm(placed[name] - FACING_MINUS_Z @ at_m) < MILLIMETRE_M
