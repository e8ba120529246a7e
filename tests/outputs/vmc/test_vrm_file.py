"""`.vrm` files: a Unity that has loaded the same avatar poses it as the person stands; bad files say what is wrong."""

import json
import math
import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.config.effective import load_config
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.outputs.vmc.vrm_file import MOST_JSON_BYTES, read_vrm
from mocapd.types import Floats
from tests.golden import stepping_left
from tests.outputs.receivers.humanoid import Quaternion, Transform
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.vmc.vrm_models import (
    POINT,
    STATURE_M,
    Model,
    Node,
    glb,
    model,
    posed_in_unity,
    world,
    write_vrm,
)

FRAME, REST = stepping_left.frame(), stepping_left.rest()
SCALE = STATURE_M / stepping_left.STATURE_M
HALF = math.sqrt(0.5)
# as Blender exports an armature: in centimetres and lying on its back
BLENDER = Node(None, (0.0, 0.0, 0.0), (HALF, 0.0, 0.0, HALF), 0.01)
TURNS: dict[str, Quaternion] = {
    name: tuple(
        rotations.exp(np.array([0.3 * k % 2 - 0.9, 0.7 * k % 3 - 1.2, 0.5 * k % 2])).tolist()
    )
    for k, name in enumerate(NAMES)
}

MODELS = {
    "vrm1": model(1),
    "vrm0": model(0),
    "vrm1-few-bones": model(1, without=("upperChest", "neck", "leftShoulder", "leftToes")),
    "vrm0-few-bones": model(0, without=("chest", "upperChest", "rightShoulder", "rightToes")),
    "vrm1-own-axes": model(1, turns=TURNS),
    "vrm0-own-axes": model(0, turns=TURNS),
    "vrm1-blender": model(1, top=BLENDER),
    "vrm0-blender": model(0, top=BLENDER),
    "vrm1-moved": model(1, top=Node(None, (0.3, -0.1, 0.2), (0.0, 0.6, 0.0, 0.8), 2.0)),
    "vrm1-nodes-between": model(1, between=("spine", "leftLowerArm", "head"), turns=TURNS),
    "vrm0-everything": model(0, top=BLENDER, between=("hips", "neck"), turns=TURNS, without=("chest",)),
}  # fmt: skip


def sent(path: Path, mirror: bool = False, turn_deg: float = 0.0) -> dict[str, Transform]:
    """What is told of each bone, by Unity's name."""
    where = vmc_heading(turn_deg, 0.0, by_root=False)
    encoder = VmcEncoder(where, mirror, "one", read_vrm(path))
    (datagram,) = encoder.encode(FRAME, REST, calibration=3, time_s=0.0)
    out: dict[str, Transform] = {}
    for one in decoded(bytes(datagram)):
        if one.address == "/VMC/Ext/Bone/Pos":
            px, py, pz, qx, qy, qz, qw = (float(v.value or 0.0) for v in one.values[1:])
            out[str(one.values[0].value)] = (px, py, pz), (qx, qy, qz, qw)
    return out


def expected(avatar: Model) -> dict[str, Floats]:
    """Every bone, and a point on it, turned about the joint above as the person's bone is, from the hips on."""
    about = np.array([-1.0, 1.0, -1.0]) if avatar.version == 0 else np.ones(3)
    at_rest = {name: np.array(one[0][0]) * about for name, one in world(avatar.nodes).items()}
    turns = {name: one[0][1] for name, one in world(avatar.nodes).items()}
    above: dict[str, str | None] = {}
    for name in avatar.bones:
        node = avatar.nodes[name].above
        while node is not None and node not in avatar.bones:
            node = avatar.nodes[node].above
        above[name] = node
    scale = at_rest["hips"][1] / REST.offsets_m[0][1]
    out: dict[str, Floats] = {}
    for name, parent in above.items():
        turned = np.array(FRAME.joints[name].r)
        if parent is None:
            out[name] = np.array(FRAME.joints["hips"].p) * scale
        else:
            way = at_rest[name] - at_rest[parent]
            out[name] = out[parent] + rotations.rotate(np.array(FRAME.joints[parent].r), way)
        point = rotations.rotate(np.array(turns[name]), np.array(POINT)) * about
        out[f"{name}+"] = out[name] + rotations.rotate(turned, point)
    return out


@pytest.mark.parametrize("which", MODELS)
def test_unity_poses_the_avatar_as_the_person_stands(which: str, tmp_path: Path) -> None:
    avatar = MODELS[which]
    found = posed_in_unity(avatar, sent(write_vrm(tmp_path / "a.vrm", avatar)))
    for name, at_m in expected(avatar).items():
        np.testing.assert_allclose(found[name], at_m, atol=1e-4, err_msg=name)


@pytest.mark.parametrize("which", ["vrm0", "vrm1", "vrm0-few-bones", "vrm1-few-bones"])
def test_bones_that_the_avatar_lacks_are_not_told(which: str, tmp_path: Path) -> None:
    avatar = MODELS[which]
    names = sent(write_vrm(tmp_path / "a.vrm", avatar)).keys()
    assert {name[0].upper() + name[1:] for name in avatar.bones} == names


@pytest.mark.parametrize("version", [0, 1])
def test_offsets_are_the_files_own_and_travel_is_scaled_to_its_legs(
    version: int, tmp_path: Path
) -> None:
    told = sent(write_vrm(tmp_path / "a.vrm", model(version)))
    wearer = dict(zip(REST.names, REST.offsets_m, strict=True))
    x, y, z = wearer["leftLowerArm"]
    assert told["LeftLowerArm"][0] == pytest.approx((-x * SCALE, y * SCALE, z * SCALE), abs=1e-6)
    hips_m = np.array(stepping_left.HIPS_M) * SCALE * (-1.0, 1.0, 1.0)
    assert told["Hips"][0] == pytest.approx(tuple(hips_m), abs=1e-6)


@pytest.mark.parametrize("version", [0, 1])
def test_mirrored_the_avatars_right_hand_is_up(version: int, tmp_path: Path) -> None:
    avatar = model(version)
    path = write_vrm(tmp_path / "a.vrm", avatar)
    plain, mirror = (posed_in_unity(avatar, sent(path, mirror=one)) for one in (False, True))
    np.testing.assert_allclose(mirror["rightHand"], plain["leftHand"] * (-1.0, 1.0, 1.0), atol=1e-5)


def test_turned_by_half_the_avatar_faces_the_other_way(tmp_path: Path) -> None:
    avatar = MODELS["vrm0-everything"]
    path = write_vrm(tmp_path / "a.vrm", avatar)
    plain, turned = (posed_in_unity(avatar, sent(path, turn_deg=one)) for one in (0.0, 180.0))
    for name in avatar.bones:
        np.testing.assert_allclose(turned[name], plain[name] * (-1.0, 1.0, -1.0), atol=1e-4)


def test_a_node_may_be_a_matrix(tmp_path: Path) -> None:
    avatar = model(1, top=BLENDER, turns=TURNS)
    document: Any = avatar.document()
    for node in document["nodes"]:
        turn, scale = np.array(node.pop("rotation")), node.pop("scale")[0]
        matrix = np.eye(4)
        matrix[:3, :3] = rotations.to_matrix(turn) * scale
        matrix[:3, 3] = node.pop("translation")
        node["matrix"] = matrix.T.ravel().tolist()
    path = tmp_path / "a.vrm"
    path.write_bytes(glb(document))
    found = posed_in_unity(avatar, sent(path))
    for name, at_m in expected(avatar).items():
        np.testing.assert_allclose(found[name], at_m, atol=1e-4, err_msg=name)


def test_thumbs_of_both_versions_are_the_same_bones(tmp_path: Path) -> None:
    thumbs = {
        "leftThumbMetacarpal": Node("leftHand", (0.02, 0.0, 0.02)),
        "leftThumbProximal": Node("leftThumbMetacarpal", (0.03, 0.0, 0.01)),
    }
    for version in (0, 1):
        nodes = {**model(version).nodes, **thumbs}
        avatar = read_vrm(write_vrm(tmp_path / "a.vrm", Model(nodes, version)))
        parents = {
            name: avatar.names[parent]
            for name, parent in zip(avatar.names, avatar.parents, strict=True)
        }
        assert parents["leftThumbProximal"] == "leftThumbMetacarpal"
        assert parents["leftThumbMetacarpal"] == "leftHand"


def test_newer_words_go_before_older_ones(tmp_path: Path) -> None:
    document: Any = model(1).document()
    document["extensions"]["VRM"] = {"humanoid": {"humanBones": []}}
    (tmp_path / "a.vrm").write_bytes(glb(document))
    assert read_vrm(tmp_path / "a.vrm").hips_height_m > 0.5


# -- bad files -----------------------------------------------------------------------------------

Change = Callable[[Any], object]


def bones_of(document: Any) -> dict[str, Any]:
    bones: dict[str, Any] = document["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]
    return bones


def node_of(document: Any, bone: str) -> dict[str, Any]:
    node: dict[str, Any] = document["nodes"][bones_of(document)[bone]["node"]]
    return node


CHANGES: dict[str, tuple[Change, str]] = {
    "no-extension": (lambda d: d.pop("extensions"), "without a humanoid"),
    "other-extension": (lambda d: d["extensions"].update(VRMC_vrm={"specVersion": "1.0"}), "without a humanoid"),
    "no-hips": (lambda d: bones_of(d).pop("hips"), "has no hips"),
    "no-arms": (lambda d: [bones_of(d).pop(f"{s}UpperArm") for s in ("left", "right")], "no leftUpperArm, rightUpperArm"),
    "node-beyond": (lambda d: bones_of(d).update(head={"node": 999}), "'head' is node 999"),
    "node-before": (lambda d: bones_of(d).update(head={"node": -1}), "'head' is node -1"),
    "node-twice": (lambda d: bones_of(d).update(head=bones_of(d)["neck"]), "the same node"),
    "node-no-number": (lambda d: bones_of(d).update(head={"node": "x"}), "no VRM avatar"),
    "child-beyond": (lambda d: node_of(d, "head").update(children=[10**6]), "child 1000000"),
    "two-parents": (lambda d: node_of(d, "head")["children"].append(bones_of(d)["leftHand"]["node"]), "two parents"),
    "in-a-circle": (lambda d: node_of(d, "head")["children"].append(0), "is below itself"),
    "not-below": (lambda d: node_of(d, "hips").update(children=[]), "not below its hips"),
    "on-the-floor": (lambda d: node_of(d, "hips").update(translation=[0, 0, 0]), "above the floor"),
    "far-away": (lambda d: node_of(d, "head").update(translation=[0, 1e30, 0]), "too large"),
    "no-rotation": (lambda d: node_of(d, "head").update(rotation=[0, 0, 0, 0]), "rotation"),
    "flat": (lambda d: d["nodes"][0].update(scale=[1, 1, 0]), "scaled to nothing"),
    "no-matrix": (lambda d: node_of(d, "head").update(matrix=[0] * 16), "matrix"),
    "short-matrix": (lambda d: node_of(d, "head").update(matrix=[1] * 15), "no VRM avatar"),
    "null-nodes": (lambda d: d.update(nodes=None), "no VRM avatar"),
}  # fmt: skip


@pytest.mark.parametrize("which", CHANGES)
def test_an_avatar_that_does_not_do_says_why_where_and_the_mend(which: str, tmp_path: Path) -> None:
    change, why = CHANGES[which]
    document: Any = json.loads(json.dumps(model(1).document()))
    change(document)
    path = tmp_path / "odd.vrm"
    path.write_bytes(glb(document))
    with pytest.raises(InputError) as raised:
        read_vrm(path)
    assert why in raised.value.what
    assert raised.value.where == str(path)
    assert raised.value.fix


GOOD = glb(model(1).document())


def document(nodes: bytes, one: Model | None = None) -> bytes:
    """A file with these nodes, of an avatar or of nothing; the avatar's bones are the deepest of them."""
    extensions: dict[str, Any] = {}
    if one is not None:
        whole: Any = one.document()
        extensions = whole["extensions"]
        for number, bone in enumerate(extensions["VRM"]["humanoid"]["humanBones"]):
            bone["node"] = 19_999 - number
    text = b'{"nodes":[' + nodes + b'],"extensions":' + json.dumps(extensions).encode() + b"}"
    return GOOD[:12] + struct.pack("<I", len(text)) + GOOD[16:20] + text


FILES = {
    "empty": (b"", "not a binary glTF"),
    "text": (b'{"asset": {}}' * 9, "not a binary glTF"),
    "fbx": (b"Kaydara FBX Binary  \x00\x1a\x00" * 9, "not a binary glTF"),
    "header-only": (GOOD[:12], "not a binary glTF"),
    "old": (GOOD[:4] + struct.pack("<I", 1) + GOOD[8:], "version 1"),
    "cut": (GOOD[:500], "ends within its JSON"),
    "long": (GOOD[:12] + struct.pack("<I", MOST_JSON_BYTES + 1) + GOOD[16:], "larger than 16 MB"),
    "many-nodes": (document(b"{}," * 40_000 + b"{}"), "no VRM avatar"),
    "more-nodes": (document(b"{}," * 500_000 + b"{}"), "more parts than any avatar"),
    "children": (document(b'{"children":[' + b"1," * 5_000_000 + b"1]}"), "more parts than any"),
    "deep": (
        document(b",".join(b'{"children":[%d]}' % k for k in range(1, 20_000)) + b",{}", model(0)),
        "more than 500 nodes above it",
    ),
    "garbage": (GOOD[:20] + bytes(range(256)) * 99, "no VRM avatar"),
}


@pytest.mark.parametrize("which", FILES)
def test_a_file_that_is_no_vrm_says_so(which: str, tmp_path: Path) -> None:
    data, why = FILES[which]
    path = tmp_path / "odd.vrm"
    path.write_bytes(data)
    with pytest.raises(InputError, match=why):
        read_vrm(path)


def test_what_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo.vrm")
    for path in (tmp_path / "fifo.vrm", tmp_path, tmp_path / "none.vrm", Path("/dev/zero")):
        with pytest.raises(InputError):
            read_vrm(path)


def test_it_is_set_in_the_configuration_relative_to_its_file(tmp_path: Path) -> None:
    write_vrm(tmp_path / "me.vrm", model(1))
    config = tmp_path / "config.toml"
    config.write_text("[vmc]\nvrm = 'me.vrm'\n")
    section: Any = load_config({}, file=config, env={}).config.outputs["vmc"]
    assert section.vrm == str(tmp_path / "me.vrm")
    config.write_text("[vmc]\nvrm = 'you.vrm'\n")
    with pytest.raises(InputError, match=r"you\.vrm: no such file"):
        load_config({}, file=config, env={})


def test_straight_bones_are_known_to_be_straight(tmp_path: Path) -> None:
    assert read_vrm(write_vrm(tmp_path / "a.vrm", model(0))).is_straight
    assert not read_vrm(
        write_vrm(tmp_path / "a.vrm", model(0, turns={"head": TURNS["chest"]}))
    ).is_straight
