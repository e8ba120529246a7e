"""What is sent of frames that do not know everything: leaves, missing joints, lost and damaged poses, another wearer."""

import math
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from mocapd.body.bones import PARENT_OF
from mocapd.body.skeleton import standard_skeleton
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.vmc.vmc_encoder import LEAF_CONFIDENCE, VmcEncoder
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.outputs.wire import Joint, SkeletonFrame
from tests.golden import stepping_left
from tests.outputs.receivers.evmc4u import Evmc4u
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.vmc.posed_by import posed

FRAME, REST = stepping_left.frame(), stepping_left.rest()
LOST = msgspec.structs.replace(FRAME, tracking="lost", joints={})


def encoder(mirror: bool = False) -> VmcEncoder:
    return VmcEncoder(vmc_heading(0.0, 0.0, by_root=False), mirror, "two", None)


def sent(to: VmcEncoder, frame: SkeletonFrame, rest: RestSkeleton | None = REST) -> list[bytes]:
    return [bytes(one) for one in to.encode(frame, rest, calibration=3, time_s=2.0)]


def told(datagrams: list[bytes]) -> dict[str, list[object]]:
    """Arguments by address, of bones by name."""
    messages = [one for datagram in datagrams for one in decoded(datagram)]
    return {
        str(one.values[0].value) if one.address.endswith("/Pos") else one.address: [
            value.value for value in one.values
        ]
        for one in messages
    }


def with_joint(name: str, **changes: object) -> SkeletonFrame:
    joint = msgspec.structs.replace(FRAME.joints[name], **changes)
    return msgspec.structs.replace(FRAME, joints=FRAME.joints | {name: joint})


def without(*names: str) -> SkeletonFrame:
    joints = {name: joint for name, joint in FRAME.joints.items() if name not in names}
    return msgspec.structs.replace(FRAME, joints=joints)


def test_toes_are_left_out_while_they_are_untracked() -> None:
    to = encoder()
    assert "LeftToes" in told(sent(to, FRAME))
    fading = with_joint("leftToes", c=LEAF_CONFIDENCE / 2.0)
    assert told(sent(to, fading)).keys() == told(sent(to, FRAME)).keys() - {"LeftToes"}
    assert "LeftToes" in told(sent(to, FRAME))


def test_mirrored_it_is_the_other_foot_whose_toes_are_left_out() -> None:
    names = told(sent(encoder(mirror=True), with_joint("leftToes", c=0.0))).keys()
    assert "RightToes" not in names
    assert "LeftToes" in names


@pytest.mark.parametrize("missing", [("upperChest",), ("leftShoulder", "leftHand"), ("head",)])
def test_bones_of_the_chain_are_sent_also_when_the_frame_lacks_them(
    missing: tuple[str, ...],
) -> None:
    numbers = told(sent(encoder(), without(*missing)))
    for name in missing:
        turned = numbers[name[0].upper() + name[1:]][4:]
        assert turned == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-12)  # as the bone above it
    assert len([name for name in numbers if not name.startswith("/")]) == 23


def test_a_bone_that_is_missing_does_not_move_those_below_it_elsewhere() -> None:
    whole = posed(Evmc4u(), sent(encoder(), FRAME))
    less = posed(Evmc4u(), sent(encoder(), without("leftHand")))
    np.testing.assert_allclose(less["LeftLowerArm"], whole["LeftLowerArm"], atol=1e-6)


def test_before_the_first_pose_nothing_is_said_to_be_loaded_and_no_bone_is_sent() -> None:
    to = encoder()
    for frame, rest in ((LOST, REST), (FRAME, None), (without("hips"), REST)):
        assert told(sent(to, frame, rest)) == {"/VMC/Ext/OK": [0, 3, 0, 0], "/VMC/Ext/T": [2.0]}


def test_lost_the_last_pose_stays_and_tracking_is_said_to_be_bad() -> None:
    to = encoder()
    before = told(sent(to, FRAME))
    after = told(sent(to, LOST))
    assert before["/VMC/Ext/OK"] == [1, 3, 0, 1]
    assert after == before | {"/VMC/Ext/OK": [1, 3, 0, 0]}
    assert told(sent(to, FRAME)) == before


def test_coasting_the_predicted_pose_is_sent_and_tracking_is_said_to_be_bad() -> None:
    to = encoder()
    sent(to, LOST)
    coasting = msgspec.structs.replace(with_joint("hips", p=(0.0, 1.0, 0.0)), tracking="coasting")
    numbers = told(sent(to, coasting))
    assert numbers["/VMC/Ext/OK"] == [1, 3, 0, 0]
    assert numbers["Hips"][1:4] == [-0.0, 1.0, 0.0]


@pytest.mark.parametrize("number", [math.nan, math.inf, 1e300, 1e9])
@pytest.mark.parametrize("field", ["p", "r"])
def test_a_pose_that_is_none_never_reaches_a_receiver(field: str, number: float) -> None:
    to = encoder()
    before = told(sent(to, FRAME))
    turned = (0.0, number, 0.0, 1.0)
    changed = {"p": (0.0, number, 0.0)} if field == "p" else {"r": turned, "l": turned}
    name = "hips" if field == "p" else "leftHand"
    after = told(sent(to, with_joint(name, **changed)))
    assert after == before | {"/VMC/Ext/OK": [1, 3, 0, 0]}


@pytest.mark.parametrize("number", [math.nan, math.inf, 1e300, 1e9])
def test_bones_that_are_none_never_reach_a_receiver(number: float) -> None:
    offsets_m = list(REST.offsets_m)
    offsets_m[REST.names.index("leftLowerArm")] = (number, 0.0, 0.0)
    rest = msgspec.structs.replace(REST, offsets_m=tuple(offsets_m))
    assert told(sent(encoder(), FRAME, rest)).keys() == told(sent(encoder(), LOST)).keys()


def test_another_wearer_has_other_bones() -> None:
    to = encoder()
    sent(to, FRAME)
    taller = rest_skeleton(standard_skeleton(1.95), instance="golden", stature_m=1.95)
    arm = told(sent(to, FRAME, taller))["LeftLowerArm"]
    own = told(sent(encoder(), FRAME))["LeftLowerArm"]
    assert arm[1] == pytest.approx(float(str(own[1])) * 1.95 / 1.75, rel=1e-5)


def test_bones_of_one_side_that_are_longer_are_so_on_the_other_in_the_mirror() -> None:
    offsets_m = list(REST.offsets_m)
    place = REST.names.index("leftLowerArm")
    offsets_m[place] = (0.5, 0.0, 0.0)
    uneven = msgspec.structs.replace(REST, offsets_m=tuple(offsets_m))
    numbers = told(sent(encoder(mirror=True), FRAME, uneven))
    assert numbers["RightLowerArm"][1:4] == [0.5, 0.0, 0.0]  # to Unity's right


@pytest.mark.parametrize(
    "rest",
    [
        msgspec.structs.replace(REST, names=(), parents=(), offsets_m=()),
        msgspec.structs.replace(REST, names=("spine", *REST.names[1:])),
        msgspec.structs.replace(REST, offsets_m=((0.0, 0.0, 0.0), *REST.offsets_m[1:])),
    ],
)
def test_a_body_without_hips_is_none(rest: RestSkeleton) -> None:
    assert told(sent(encoder(), FRAME, rest))["/VMC/Ext/OK"] == [0, 3, 0, 0]


def test_leaves_that_come_and_go_in_every_way_do_no_harm() -> None:
    fingers = [f"{side}{f}{p}" for side in ("left", "right") for f in ("Index", "Ring", "Little")
               for p in ("Proximal", "Intermediate", "Distal")]  # fmt: skip
    names = (*REST.names, *fingers)
    hands = [REST.names.index("leftHand")] * 9 + [REST.names.index("rightHand")] * 9
    rest = msgspec.structs.replace(
        REST,
        names=names,
        parents=(*REST.parents, *hands),
        offsets_m=(*REST.offsets_m, *((0.1, 0.0, 0.0),) * 18),
    )
    to = encoder()
    joint = Joint((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 1.0)
    for k in range(60):
        seen = {name: joint for bit, name in enumerate(fingers) if (k * 2654435761) >> bit & 1}
        frame = msgspec.structs.replace(FRAME, joints=FRAME.joints | seen)
        assert len(told(sent(to, frame, rest))) == 2 + 1 + 22 + len(seen)
        assert all(len(one) <= 1472 for one in sent(to, frame, rest))


def test_parents_of_the_wearer_are_those_of_the_stream() -> None:
    for name, parent in zip(REST.names, REST.parents, strict=True):
        assert PARENT_OF.get(name) == (REST.names[parent] if parent >= 0 else None)
    assert replace(stepping_left.body()[1]).names == REST.names
