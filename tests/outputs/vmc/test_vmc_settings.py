"""Each setting of the VMC output as a receiver sees it: root, turn, yaw, mirror."""

import numpy as np
import pytest

from mocapd.body.bones import other_side
from mocapd.outputs.vmc.bone_names import is_leaf, unity_name, vrm1_name
from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.types import Floats
from tests.golden import stepping_left
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker
from tests.outputs.receivers.humanoid import PARENT_OF
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.vmc.posed_by import KINDS, READS_ROOT, Receiver, greatest_error_m, posed

EVERY = pytest.mark.parametrize("kind", KINDS)


def truth() -> dict[str, Floats]:
    return {name: np.array(one.p) for name, one in stepping_left.frame().joints.items()}


def sent(
    turn_deg: float = 0.0, yaw_deg: float = 0.0, by_root: bool = False, mirror: bool = False
) -> list[bytearray]:
    encoder = VmcEncoder(vmc_heading(turn_deg, yaw_deg, by_root), mirror, "two", None)
    return encoder.encode(stepping_left.frame(), stepping_left.rest(), calibration=3, time_s=0.0)


def turned(at_m: Floats, degrees: float) -> Floats:
    """About the world's +Y, counter-clockwise seen from above: +Z to +X."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    x, y, z = at_m
    return np.array([c * x + s * z, y, c * z - s * x])


@EVERY
def test_turned_by_half_the_person_faces_the_other_way(kind: type[Receiver]) -> None:
    joints = posed(kind(), sent(turn_deg=180.0))
    expected = {name: turned(at_m, 180.0) for name, at_m in truth().items()}
    assert greatest_error_m(joints, expected) < 0.001
    assert joints["LeftFoot"][0] < joints["RightFoot"][0]


@EVERY
@pytest.mark.parametrize("degrees", [90.0, -35.0])
def test_yaw_turns_to_the_left_about_the_origin(kind: type[Receiver], degrees: float) -> None:
    joints = posed(kind(), sent(yaw_deg=degrees))
    expected = {name: turned(at_m, degrees) for name, at_m in truth().items()}
    assert greatest_error_m(joints, expected) < 0.001


@EVERY
def test_turn_and_yaw_add_up(kind: type[Receiver]) -> None:
    joints = posed(kind(), sent(turn_deg=180.0, yaw_deg=-150.0))
    expected = {name: turned(at_m, 30.0) for name, at_m in truth().items()}
    assert greatest_error_m(joints, expected) < 0.001


@EVERY
@pytest.mark.parametrize("degrees", [0.0, 50.0])
def test_mirrored_the_right_hand_is_up_and_the_step_goes_to_the_right(
    kind: type[Receiver], degrees: float
) -> None:
    joints = posed(kind(), sent(yaw_deg=degrees, mirror=True))
    expected = {
        other_side(name): turned(at_m * (-1.0, 1.0, 1.0), degrees) for name, at_m in truth().items()
    }
    assert greatest_error_m(joints, expected) < 0.001
    assert joints["RightHand"][1] > joints["Head"][1]


@pytest.mark.parametrize("kind", READS_ROOT)
@pytest.mark.parametrize("degrees", [0.0, 180.0, 70.0])
def test_by_the_root_it_is_all_the_same_to_who_reads_the_root(
    kind: type[Receiver], degrees: float
) -> None:
    joints = posed(kind(), sent(turn_deg=degrees, by_root=True))
    expected = {name: turned(at_m, degrees) for name, at_m in truth().items()}
    assert greatest_error_m(joints, expected) < 0.001


def test_by_the_root_the_hips_stay_above_it() -> None:
    hips = posed(GodotXrVmcTracker(), sent(by_root=True))["Hips"]  # which ignores the root
    np.testing.assert_allclose(hips, (0.0, stepping_left.HIPS_M[1], 0.0), atol=1e-6)


def test_by_the_hips_the_root_is_never_anywhere_else() -> None:
    for datagrams in (sent(), sent(turn_deg=180.0), sent(yaw_deg=20.0, mirror=True)):
        roots = [one for d in datagrams for one in decoded(bytes(d)) if "Root" in one.address]
        assert [[v.value for v in one.values] for one in roots] == [["root", 0, 0, 0, 0, 0, 0, 1]]


def test_names_are_those_of_unity() -> None:
    bones = {f"{side}{bone}" for side in ("left", "right") for bone in (
        "Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes", "Eye",
        "ThumbMetacarpal", "ThumbProximal", "ThumbDistal",
        *(f + p for f in ("Index", "Middle", "Ring", "Little")
          for p in ("Proximal", "Intermediate", "Distal")),
    )} | {"hips", "spine", "chest", "upperChest", "neck", "head", "jaw"}  # fmt: skip
    assert {unity_name(bone) for bone in bones} == set(PARENT_OF)
    assert unity_name("leftThumbMetacarpal") == "LeftThumbProximal"
    assert unity_name("rightThumbDistal") == "RightThumbDistal"


def test_thumbs_of_older_avatars_are_called_as_in_newer_ones() -> None:
    old = ("leftThumbProximal", "rightThumbIntermediate", "leftThumbDistal", "leftHand", "hips")
    new = ("leftThumbMetacarpal", "rightThumbProximal", "leftThumbDistal", "leftHand", "hips")
    assert tuple(map(vrm1_name, old)) == new


def test_leaves_are_what_a_receiver_may_keep() -> None:
    for bone in ("leftToes", "rightEye", "jaw", "leftThumbDistal", "rightLittleProximal"):
        assert is_leaf(bone)
    for bone in ("hips", "upperChest", "neck", "head", "leftFoot", "rightHand", "leftShoulder"):
        assert not is_leaf(bone)
