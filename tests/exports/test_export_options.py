"""Legs that nobody saw, feet on the floor, the axis that points up."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.skeleton import rest_pose
from mocapd.errors import UsageError
from mocapd.exports.export_options import ExportOptions, feet_on_floor, prepared_motion
from mocapd.exports.formats import FORMATS, write_export
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.types import Floats
from tests.cli.mocapd_process import mocapd_here
from tests.exports.exported import by_ezc3d, check_places, recorded_motion
from tests.outputs.recorded import SKELETON, frames, record

LEGS = {
    f"{side}{bone}"
    for side in ("left", "right")
    for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")
}


def _seen_as(motion: SampledMotion, names: set[str], confidence: float) -> SampledMotion:
    changed = np.full_like(motion.confidence, 0.9)
    changed[:, [motion.skeleton.names.index(name) for name in names]] = confidence
    return replace(motion, confidence=changed)


def test_legs_that_nobody_saw_are_left_out_and_that_is_said(tmp_path: Path) -> None:
    motion = _seen_as(recorded_motion(), LEGS, 0.0)
    for name in FORMATS:
        made, said = prepared_motion(motion, name, ExportOptions())
        assert "the left leg in 0 %" in said
        assert "--legs all" in said
        if name == "vrma":
            assert made.unmoved == LEGS
            assert made.skeleton.names == motion.skeleton.names
        else:
            assert {*motion.skeleton.names} - {*made.skeleton.names} == LEGS
            arms = [motion.skeleton.names.index(one) for one in made.skeleton.names]
            assert np.array_equal(made.joints_m, motion.joints_m[:, arms])
            assert made.offsets_m == pytest.approx(motion.offsets_m[arms])
        write_export(made, name, tmp_path / f"legless.{name}")
        kept, said = prepared_motion(motion, name, ExportOptions(has_all_legs=True))
        assert kept.skeleton.names == motion.skeleton.names
        assert not kept.unmoved
        assert "the right leg in 0 %" in said


def test_a_limb_that_is_seen_at_times_is_said_and_stays() -> None:
    motion = _seen_as(recorded_motion(), set(), 0.9)
    assert prepared_motion(motion, "bvh", ExportOptions())[1] == ""
    confidence = motion.confidence.copy()
    confidence[::2, motion.skeleton.names.index("rightFoot")] = 0.02
    confidence[:, motion.skeleton.names.index("leftHand")] = 0.02
    made, said = prepared_motion(replace(motion, confidence=confidence), "bvh", ExportOptions())
    assert made.skeleton.names == motion.skeleton.names
    assert "the right leg in 50 %" in said
    assert "the left arm in 0 %" in said
    assert "left leg" not in said


def _standing(height_m: Floats, confidence: float = 0.9) -> SampledMotion:
    """The T-pose, so high above the floor in each frame [m]; 60 Hz."""
    pose, count = rest_pose(SKELETON), len(height_m)
    joints_m = np.tile(SKELETON.rest_m, (count, 1, 1))
    joints_m[..., 1] += height_m[:, None]
    shape = joints_m.shape[:2]
    return SampledMotion(
        60.0,
        SKELETON,
        joints_m,
        np.tile(pose.quats_xyzw, (count, 1, 1)),
        np.full(shape, confidence),
        np.zeros(count, dtype=np.uint8),
        np.full(shape, 0.01),
    )


@pytest.mark.parametrize("offset_m", [0.06, -0.05])
def test_a_standing_person_is_put_on_the_floor_and_a_jump_keeps_its_height(offset_m: float) -> None:
    t_s = np.arange(240) / 60.0
    jump_m: Floats = np.maximum(0.0, 0.3 - 4.905 * (t_s - 2.0) ** 2)
    noise_m = np.random.default_rng(5).normal(0.0, 0.001, 240)
    sway_m = 0.01 * np.sin(t_s)
    height_m: Floats = offset_m + jump_m + noise_m + sway_m
    found = feet_on_floor(_standing(height_m))
    above_m = found.joints_m[:, 0, 1] - SKELETON.rest_m[0, 1]
    stands = jump_m == 0.0
    assert np.abs(above_m[stands]).max() < 0.01
    assert np.abs(above_m - jump_m).max() < 0.015
    assert above_m[119] == pytest.approx(0.3, abs=0.015)


def test_without_a_foot_that_stands_nothing_shows_the_floor() -> None:
    with pytest.raises(UsageError, match="--feet floor: no foot is seen standing"):
        feet_on_floor(_standing(np.zeros(60), confidence=0.0))
    with pytest.raises(UsageError, match="no foot is seen standing"):
        feet_on_floor(_standing(np.linspace(0.0, 3.0, 60)))


def test_of_two_heights_as_usual_the_lower_one_is_the_floor() -> None:
    """On a step for as long as before it."""
    height_m = np.repeat([0.1, 0.5], 30)
    found = feet_on_floor(_standing(height_m))
    above_m = found.joints_m[:, 0, 1] - SKELETON.rest_m[0, 1]
    assert above_m == pytest.approx(height_m - 0.1)


def test_z_up_is_the_same_motion_turned(tmp_path: Path) -> None:
    bvhio = pytest.importorskip("bvhio")  # has no wheel for Python 3.14
    motion = recorded_motion()
    made, _ = prepared_motion(motion, "bvh", ExportOptions(is_z_up=True))
    for name in ("bvh", "c3d", "trc", "csv"):
        write_export(made, name, tmp_path / f"z.{name}")
    root = bvhio.readAsHierarchy(str(tmp_path / "z.bvh"))
    places = []
    for number in range(len(motion.joints_m)):
        root.loadPose(number)
        by_name = {joint.Name: joint.PositionWorld for joint, _, _ in root.layout()}
        places.append([list(by_name[name]) for name in motion.skeleton.names])
    x, y, z = np.moveaxis(np.array(places) / 100.0, -1, 0)
    check_places(np.stack([x, z, -y], axis=-1), motion)
    file = by_ezc3d(tmp_path / "z.c3d")
    assert file["parameters"]["POINT"]["Y_SCREEN"]["value"] == ["+Z"]
    x, y, z = file["data"]["points"][:3] / 1000.0
    check_places(np.moveaxis(np.stack([x, z, -y]), (0, 1, 2), (2, 1, 0)), motion)


def test_the_command_has_the_options(clean_env: dict[str, str], tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.5))
    refused = mocapd_here(clean_env, "export", path, "--to", "glb", "--up", "z")
    assert refused.code == 2
    assert "--up z: a file of glb is +Y up by its format" in refused.err
    assert not (tmp_path / "a.glb").exists()
    words = ("--to", "csv", "--up", "z", "--fps", "24", "--feet", "floor", "--legs", "all")
    done = mocapd_here(clean_env, "export", path, *words)
    assert done.code == 0, done.err
    assert "12 frames at 24 Hz" in done.err
    rows = (tmp_path / "a.csv").read_text().split("\n")
    at = rows[0].split(",").index("head_z")
    assert float(rows[1].split(",")[at]) == pytest.approx(1.6, abs=0.2)


def test_the_command_knows_every_format(clean_env: dict[str, str], tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.2))
    for name in FORMATS:
        assert mocapd_here(clean_env, "export", path, "--to", name).code == 0
        assert (tmp_path / f"a.{name}").exists()
    unknown = mocapd_here(clean_env, "export", path, "--to", "fbx")
    assert unknown.code == 2
    assert all(f"'{name}'" in unknown.err for name in FORMATS)
