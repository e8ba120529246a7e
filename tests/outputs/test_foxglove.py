"""What Foxglove reads in a recording, against its published schemas (foxglove/foxglove-sdk, schemas/jsonschema)."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from mocapd.capture.recording.recorded_picture import Time
from mocapd.geometry import rotations
from mocapd.outputs.mcap import foxglove_messages, foxglove_scene
from mocapd.outputs.mcap.foxglove_messages import foxglove_schema
from mocapd.types import Floats
from tests.geometry.rigs import ring
from tests.outputs.recorded import cameras, frame_at, frames, record, rest

# Of each schema the fields that it requires (all of CameraCalibration's, which requires none), with their types;
# `time` and `duration` are objects of the integers sec and nsec.
POINT = {"x": "number", "y": "number", "z": "number"}
TURN = POINT | {"w": "number"}
COLOR = {"r": "number", "g": "number", "b": "number", "a": "number"}
TIME = {"sec": "integer", "nsec": "integer"}
LINE = {
    "type": "integer",
    "pose": {"position": POINT, "orientation": TURN},
    "thickness": "number",
    "scale_invariant": "boolean",
    "points": [POINT],
    "color": COLOR,
    "colors": [COLOR],
    "indices": ["integer"],
}
PUBLISHED: dict[str, Any] = {
    "foxglove.FrameTransforms": {
        "transforms": [
            {
                "timestamp": TIME,
                "parent_frame_id": "string",
                "child_frame_id": "string",
                "translation": POINT,
                "rotation": TURN,
            }
        ]
    },
    "foxglove.CompressedImage": {
        "timestamp": TIME,
        "frame_id": "string",
        "data": "string",
        "format": "string",
    },
    "foxglove.CameraCalibration": {
        "timestamp": TIME,
        "frame_id": "string",
        "width": "integer",
        "height": "integer",
        "distortion_model": "string",
        "D": ["number"],
        "K": ["number"],
        "R": ["number"],
        "P": ["number"],
    },
    "foxglove.SceneUpdate": {
        "deletions": [{}],
        "entities": [
            {
                "timestamp": TIME,
                "frame_id": "string",
                "id": "string",
                "lifetime": TIME,
                "frame_locked": "boolean",
                "metadata": [{}],
                "arrows": [{}],
                "cubes": [{}],
                "spheres": [{}],
                "cylinders": [{}],
                "lines": [LINE],
                "triangles": [{}],
                "texts": [{}],
                "models": [{}],
            }
        ],
    },
}
_TYPES: dict[str, Any] = {"string": str, "number": (int, float), "integer": int, "boolean": bool}


def check(value: object, published: Any, where: str) -> None:
    """That a message is as it was published."""
    if isinstance(published, dict):
        assert isinstance(value, dict), where
        assert set(published) <= set(value), where
        for key, one in published.items():
            check(value[key], one, f"{where}.{key}")
    elif isinstance(published, list):
        assert isinstance(value, list), where
        for one in value:
            check(one, published[0], f"{where}[]")
    else:
        assert isinstance(value, _TYPES[published]), where


def check_schema(schema: Any, published: Any, where: str) -> None:
    """That a schema says so."""
    assert "$ref" not in schema, where
    if isinstance(published, dict):
        assert schema["type"] == "object", where
        for key, one in published.items():
            check_schema(schema["properties"][key], one, f"{where}.{key}")
    elif isinstance(published, list):
        assert schema["type"] == "array", where
        check_schema(schema["items"], published[0], f"{where}[]")
    else:
        assert schema["type"] == published, where


@pytest.mark.parametrize("name", PUBLISHED)
def test_schemas_in_the_file_are_those_published(name: str) -> None:
    schema = json.loads(foxglove_schema(name))
    check_schema(schema, PUBLISHED[name], name)
    if name == "foxglove.CompressedImage":
        assert schema["properties"]["data"]["contentEncoding"] == "base64"


def test_messages_in_the_file_are_as_published(tmp_path: Path) -> None:
    seen = set()
    with record(tmp_path / "a.mcap", frames(1.0)).open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            if schema.name.startswith("foxglove."):
                assert (channel.message_encoding, schema.encoding) == ("json", "jsonschema")
                check(json.loads(message.data), PUBLISHED[schema.name], schema.name)
                seen.add(schema.name)
    assert seen == set(PUBLISHED) - {"foxglove.CompressedImage"}


def placed(transforms: foxglove_messages.FrameTransforms) -> dict[str, tuple[Floats, Floats]]:
    """By frame, place and rotation in the world, as a viewer composes them."""
    found = {"world": (np.zeros(3), rotations.IDENTITY_XYZW)}
    for one in transforms.transforms:
        place_m, turn = found[one.parent_frame_id]
        offset_m = np.array([one.translation.x, one.translation.y, one.translation.z])
        own = np.array([one.rotation.x, one.rotation.y, one.rotation.z, one.rotation.w])
        found[one.child_frame_id] = (
            place_m + rotations.rotate(turn, offset_m),
            rotations.canonical(rotations.multiply(turn, own)),
        )
    return found


def test_bones_stand_where_the_frame_says() -> None:
    frame = frame_at(0.7, 0)
    transforms = foxglove_scene.bone_transforms(frame, rest())
    assert transforms is not None
    found = placed(transforms)
    for name, joint in frame.joints.items():
        assert np.linalg.norm(found[f"person0/{name}"][0] - joint.p) < 0.004  # rounded for eyes


def test_cameras_stand_where_the_rig_says_and_the_world_is_upright() -> None:
    fixed = foxglove_scene.fixed_transforms(cameras(), 0)
    root = fixed.transforms[0]
    up = rotations.rotate(
        np.array([root.rotation.x, root.rotation.y, root.rotation.z, root.rotation.w]),
        np.array([0.0, 1.0, 0.0]),
    )
    assert up == pytest.approx([0.0, 0.0, 1.0])
    found = placed(foxglove_messages.FrameTransforms(fixed.transforms[1:]))
    for camera in ring(2):
        place_m, turn = found[f"camera/{camera.name}"]
        assert place_m == pytest.approx(-camera.R.T @ camera.t_m)
        ahead = rotations.rotate(turn, np.array([0.0, 0.0, 1.0]))
        assert ahead == pytest.approx(camera.R[2])


def test_lines_reach_from_joint_to_joint() -> None:
    frame, told = frame_at(0.7, 0), rest()
    transforms = foxglove_scene.bone_transforms(frame, told)
    assert transforms is not None
    found = placed(transforms)
    arm = next(
        entity
        for entity in foxglove_scene.bone_scene(told, 0).entities
        if entity.id == "person0/leftLowerArm"
    )
    place_m, turn = found[arm.frame_id]
    end = arm.lines[0].points[1]
    assert arm.frame_locked
    reached = place_m + rotations.rotate(turn, np.array([end.x, end.y, end.z]))
    assert np.linalg.norm(reached - frame.joints["leftHand"].p) < 0.004


def test_times_are_whole_nanoseconds() -> None:
    assert Time.of(1_700_000_000_123_456_789).unix_ns == 1_700_000_000_123_456_789
