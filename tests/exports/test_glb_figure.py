"""The figure in a GLB: by the rules of glTF 2.0 for skinned meshes, and where the bones are."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mocapd.exports.sampled_motion import SampledMotion
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.exports.exported import exported
from tests.exports.gltf_reading import load, rows_of


@pytest.fixture(scope="module")
def motion_and_file(tmp_path_factory: pytest.TempPathFactory) -> tuple[SampledMotion, Any]:
    """The moving asymmetric person."""
    motion, path = exported(tmp_path_factory.mktemp("figure"), "glb")
    return motion, load(path)


def _attributes(file: Any) -> dict[str, NDArray[Any]]:
    (mesh,) = file.meshes
    (primitive,) = mesh.primitives
    named = ("POSITION", "NORMAL", "COLOR_0", "JOINTS_0", "WEIGHTS_0")
    found = {name: rows_of(file, getattr(primitive.attributes, name)) for name in named}
    return found | {"corners": rows_of(file, primitive.indices).reshape(-1, 3)}


def test_the_mesh_keeps_the_rules_of_the_format(motion_and_file: tuple[SampledMotion, Any]) -> None:
    """The Khronos validator finds no error and no warning in it; its rules that matter here, again."""
    motion, file = motion_and_file
    found, joints = _attributes(file), len(motion.skeleton.names)
    count = len(found["POSITION"])
    assert all(len(rows) == count for name, rows in found.items() if name != "corners")
    (primitive,) = file.meshes[0].primitives
    places = file.accessors[primitive.attributes.POSITION]
    assert (places.min, places.max) == (
        found["POSITION"].min(axis=0).tolist(),
        found["POSITION"].max(axis=0).tolist(),
    )
    assert found["corners"].max() == count - 1
    assert (np.diff(np.sort(found["corners"], axis=1), axis=1) > 0).all()  # none degenerate
    assert np.linalg.norm(found["NORMAL"], axis=1) == pytest.approx(np.ones(count), abs=1e-5)
    assert found["JOINTS_0"].max() < joints
    assert (found["WEIGHTS_0"].sum(axis=1) == 1.0).all()
    assert (found["JOINTS_0"][found["WEIGHTS_0"] == 0.0] == 0).all()
    assert all(view.byteOffset % 4 == 0 for view in file.bufferViews)
    assert file.scenes[file.scene].nodes == [0, joints]
    assert (file.nodes[joints].mesh, file.nodes[joints].skin) == (0, 0)


def test_triangles_face_outwards(motion_and_file: tuple[SampledMotion, Any]) -> None:
    found = _attributes(motion_and_file[1])
    a, b, c = (found["POSITION"][found["corners"][:, i]] for i in range(3))
    across = np.cross(b - a, c - a)
    assert (np.vecdot(across, found["NORMAL"][found["corners"][:, 0]]) > 0).all()


def test_every_capsule_moves_with_its_bone(motion_and_file: tuple[SampledMotion, Any]) -> None:
    """In some frame, left hand up: the tips of both hands, the soles and the head are where the bones put them."""
    motion, file = motion_and_file
    names, found = motion.skeleton.names, _attributes(file)
    joint_of = found["JOINTS_0"][:, 0]
    placed = _skinned(motion, found["POSITION"].astype(float), joint_of, 60)
    for joint, name in enumerate(names):
        own = placed[joint_of == joint]
        assert len(own)
        apart_m = np.linalg.norm(own - motion.joints_m[60, joint], axis=1)
        length_m = np.linalg.norm(
            motion.skeleton.rest_m[motion.skeleton.parents == joint]
            - motion.skeleton.rest_m[joint],
            axis=1,
        ).max(initial=0.12)
        assert apart_m.max() < length_m + 0.14, name
    left, right = (placed[joint_of == names.index(name)] for name in ("leftHand", "rightHand"))
    assert left[:, 1].min() > right[:, 1].max()
    warm, cold = (
        found["COLOR_0"][joint_of == names.index(name), 0].mean()
        for name in ("leftHand", "rightHand")
    )
    assert warm > cold + 50


def _skinned(motion: SampledMotion, rest_m: Floats, joint_of: NDArray[Any], frame: int) -> Floats:
    """Vertices in a frame: each as rigid as its bone."""
    bound = rest_m - motion.skeleton.rest_m[joint_of]
    turned = rotations.rotate(motion.global_xyzw[frame][joint_of], bound)
    placed: Floats = motion.joints_m[frame][joint_of] + turned
    return placed


def test_each_joint_has_its_confidence(motion_and_file: tuple[SampledMotion, Any]) -> None:
    motion, file = motion_and_file
    for joint, name in enumerate(motion.skeleton.names):
        extras = file.nodes[joint].extras
        assert file.nodes[joint].name == name
        assert extras["confidence"] == pytest.approx(motion.confidence[:, joint].mean(), abs=1e-3)
        assert extras["seen"] == float(motion.confidence[0, joint] >= 0.1)
        accessor = file.accessors[extras["confidence_accessor"]]
        assert (accessor.normalized, accessor.count) == (True, len(motion.joints_m))
        steps = rows_of(file, extras["confidence_accessor"])[:, 0] / 255.0
        assert steps == pytest.approx(motion.confidence[:, joint], abs=0.5 / 255 + 1e-6)
