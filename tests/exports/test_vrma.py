"""VRMA as its specification (VRMC_vrm_animation 1.0) has it, posed on another avatar."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.errors import InputError
from mocapd.exports.formats import write_export
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.exports.exported import exported, recorded_motion
from tests.exports.gltf_reading import load, rows_of

REQUIRED = {"hips", "spine", "head"} | {
    f"{side}{bone}"
    for side in ("left", "right")
    for bone in ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "LowerArm", "Hand")
}


def _tracks(path: Path) -> dict[tuple[str, str], Floats]:
    """What is animated, by the bone's name and `rotation` or `translation`."""
    file = load(path)
    bones = file.extensions["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    name_of = {bone["node"]: name for name, bone in bones.items()}
    (animation,) = file.animations
    return {
        (name_of[one.target.node], one.target.path): rows_of(
            file, animation.samplers[one.sampler].output
        ).astype(float)
        for one in animation.channels
    }


def test_the_extension_is_as_specified(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "vrma")
    file = load(path)
    assert file.extensionsUsed == ["VRMC_vrm_animation"]
    extension = file.extensions["VRMC_vrm_animation"]
    assert extension["specVersion"] == "1.0"
    bones = extension["humanoid"]["humanBones"]
    assert bones.keys() >= REQUIRED
    assert all(file.nodes[bone["node"]].name == name for name, bone in bones.items())
    tracks = _tracks(path)
    assert [name for name, what in tracks if what == "translation"] == ["hips"]
    assert {name for name, what in tracks if what == "rotation"} == {*motion.skeleton.names}
    assert file.meshes == []
    places = dict(zip(motion.skeleton.names, motion.offsets_m, strict=True))
    for name, bone in bones.items():  # the rest pose is the T-pose, without rotations
        assert file.nodes[bone["node"]].rotation == [0.0, 0.0, 0.0, 1.0]
        assert file.nodes[bone["node"]].translation == pytest.approx(list(places[name]))


def test_an_avatar_is_posed_as_the_person_was(tmp_path: Path) -> None:
    """Each bone of it points where the person's did, wherever its joints are."""
    motion, path = exported(tmp_path, "vrma")
    tracks, parents = _tracks(path), motion.skeleton.parents
    turned = np.zeros_like(motion.global_xyzw)
    for joint, name in enumerate(motion.skeleton.names):
        local = tracks[name, "rotation"]
        above = int(parents[joint])
        turned[:, joint] = local if above < 0 else rotations.multiply(turned[:, above], local)
    assert rotations.angle_rad(turned, motion.global_xyzw).max() < 1e-3
    assert tracks["hips", "translation"] == pytest.approx(motion.joints_m[:, 0], abs=1e-5)


def test_a_leg_that_is_not_to_move_keeps_its_bones(tmp_path: Path) -> None:
    motion: SampledMotion = replace(
        recorded_motion(), unmoved=frozenset({"leftUpperLeg", "leftLowerLeg", "leftFoot"})
    )
    write_export(motion, "vrma", tmp_path / "a.vrma")
    tracks = {name for name, _ in _tracks(tmp_path / "a.vrma")}
    assert "rightFoot" in tracks
    assert not tracks & motion.unmoved
    bones = load(tmp_path / "a.vrma").extensions["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    assert bones.keys() >= REQUIRED


def test_a_skeleton_without_a_bone_of_avatars_is_refused(tmp_path: Path) -> None:
    motion = recorded_motion()
    other = replace(
        motion, skeleton=replace(motion.skeleton, names=("pelvis", *motion.skeleton.names[1:]))
    )
    with pytest.raises(InputError, match="it lacks hips"):
        write_export(other, "vrma", tmp_path / "a.vrma")
