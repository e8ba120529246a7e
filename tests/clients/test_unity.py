"""The Unity package: what its components do on stand-ins for UnityEngine, and what Unity wants of a package.

Unity itself is not run. Decoding and skeleton mathematics are played to in `test_streams.py`.
"""

import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.clients.played import Played
from tests.clients.unity.make_metas import assets, meta_of
from tests.clients.unity.unity_player import PACKAGE
from tests.golden import make_osc, stepping_left

MILLIMETRE_M = 0.001
UNITY_FROM_WORLD = np.array([-1.0, 1.0, 1.0])

Stream = Callable[[str], Played]


@pytest.fixture(scope="module")
def scene(unity_told: dict[str, Any]) -> dict[str, Any]:
    """A receiver and an avatar: nothing comes, the golden pose comes, the person is lost, all is switched off."""
    told: dict[str, Any] = unity_told["scene"]
    return told


@pytest.fixture(scope="module")
def golden(unity_told: dict[str, Any]) -> dict[str, Any]:
    return Played.read(unity_told["golden"]).joints


def test_the_source_skeleton_stands_as_the_person_does(scene: dict[str, Any]) -> None:
    truth = json.loads(make_osc.JOINTS.read_text())
    joints = {name: np.array(at_m) for name, at_m in scene["joints"].items()}
    for name, one in truth.items():
        at_m = joints[name[0].upper() + name[1:]]
        assert np.linalg.norm(at_m - UNITY_FROM_WORLD * one["p_m"]) < MILLIMETRE_M
    assert joints["LeftHand"][1] > joints["Head"][1]
    assert joints["LeftFoot"][0] < joints["RightFoot"][0]  # Unity's left is -X
    assert joints["LeftToes"][2] > joints["LeftFoot"][2]


def test_rotations_turn_the_same_way_in_unitys_axes(golden: dict[str, Any]) -> None:
    truth = json.loads(make_osc.JOINTS.read_text())
    for name, one in truth.items():
        for key, mine in (("global_xyzw", "rotation"), ("local_xyzw", "local")):
            x, y, z, w = one[key]
            assert golden[name][mine] == pytest.approx((x, -y, -z, w), abs=1e-5)
        assert golden[name]["confidence"] == 1.0


def test_the_rest_pose_is_found_in_a_frame(golden: dict[str, Any]) -> None:
    rest = stepping_left.rest()
    for name, offset_m in zip(rest.names, rest.offsets_m, strict=True):
        assert golden[name]["rest"] == pytest.approx(UNITY_FROM_WORLD * offset_m, abs=MILLIMETRE_M)


def test_the_avatar_follows_while_somebody_is_tracked_and_holds_the_pose_then(
    scene: dict[str, Any],
) -> None:
    assert scene["tracked"] == [False, True, False]
    assert scene["sets"] == [0, 1, 2]
    assert scene["human"] == len(make_osc.whole().joints)


def test_what_is_made_is_cleared_away_and_the_port_is_free_again(scene: dict[str, Any]) -> None:
    assert scene["open"] == 0
    assert scene["left"] == 2  # the scene's own object and its avatar
    assert scene["anew"].startswith("nothing heard")


def test_trouble_is_said_once(scene: dict[str, Any]) -> None:
    warning, _, error = scene["said"]
    assert warning.startswith("warning: mocapd: lost")
    assert "no OSC" in warning
    assert error == "error: mocapd: no receiver is given"


def test_a_port_that_is_none_is_named(scene: dict[str, Any]) -> None:
    assert scene["impossible"] == "mocapd: port 70000 is not from 1 to 65535"
    assert f"error: {scene['impossible']}" in scene["said"]


def test_a_port_that_somebody_has_is_refused(unity_told: dict[str, Any]) -> None:
    assert unity_told["over UDP"]["refused"] is True
    assert unity_told["over UDP"]["trouble_kinds"] == 0


def test_the_sample_shows_the_stream(unity_told: dict[str, Any]) -> None:
    assert unity_told["sample"].startswith("live: golden")


def test_every_asset_has_an_identity_of_its_own() -> None:
    guids = []
    for asset in assets():
        meta = meta_of(asset).read_text()
        assert ("folderAsset: yes" in meta) == asset.is_dir()
        guids += re.findall(r"^guid: ([0-9a-f]{32})$", meta, re.MULTILINE)
    assert len(set(guids)) == len(guids) == len(list(assets()))
    of_nothing = [m for m in PACKAGE.rglob("*.meta") if not m.with_suffix("").exists()]
    assert not of_nothing


def test_the_package_names_what_is_there_and_brings_nothing_else() -> None:
    package = json.loads((PACKAGE / "package.json").read_text())
    assert "dependencies" not in package
    for sample in package["samples"]:
        assert (PACKAGE / sample["path"]).is_dir()
    kinds = {path.suffix for path in PACKAGE.rglob("*") if path.is_file()}
    assert kinds == {".cs", ".asmdef", ".json", ".md", ".meta"}  # no native code
    core = json.loads((PACKAGE / "Runtime" / "Core" / "Mocapd.Core.asmdef").read_text())
    assert core["noEngineReferences"] is True
    known = {json.loads(path.read_text())["name"] for path in PACKAGE.rglob("*.asmdef")}
    for path in PACKAGE.rglob("*.asmdef"):
        assert set(json.loads(path.read_text())["references"]) <= known
