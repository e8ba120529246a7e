"""The Foxglove messages that a recording holds in addition to ours, so that Foxglove opens the file.

Names, fields and types are those of foxglove/foxglove-sdk, schemas/jsonschema; the descriptions are ours. Foxglove
identifies a message by its schema's name and parses it by the schema in the file, which must have no references.
"""

from typing import Annotated, Any

import msgspec
from msgspec import Meta

from mocapd.capture.recording.recorded_picture import IMAGE, CompressedImage, Time

TRANSFORMS = "foxglove.FrameTransforms"
CAMERA_CALIBRATION = "foxglove.CameraCalibration"
SCENE = "foxglove.SceneUpdate"


class Vector3(msgspec.Struct, frozen=True, gc=False):
    """In the axes of its frame [m]."""

    x: float
    y: float
    z: float


class Quaternion(msgspec.Struct, frozen=True, gc=False):
    """A rotation."""

    x: float
    y: float
    z: float
    w: float


class FrameTransform(msgspec.Struct, frozen=True, gc=False):
    """parent_from_child: the pose of a frame in another."""

    timestamp: Time
    parent_frame_id: str
    child_frame_id: str
    translation: Vector3
    rotation: Quaternion


class FrameTransforms(msgspec.Struct, frozen=True):
    """Several at once."""

    transforms: list[FrameTransform]


class CameraCalibration(msgspec.Struct, frozen=True):
    """Intrinsics; the extrinsics are a transform. R: identity; P: K, for the undistorted picture."""

    timestamp: Time
    frame_id: str
    width: Annotated[int, Meta(ge=0)]
    height: Annotated[int, Meta(ge=0)]
    distortion_model: str
    D: list[float]
    K: Annotated[list[float], Meta(min_length=9, max_length=9)]
    R: Annotated[list[float], Meta(min_length=9, max_length=9)]
    P: Annotated[list[float], Meta(min_length=12, max_length=12)]


class Color(msgspec.Struct, frozen=True, gc=False):
    """0..1 each."""

    r: float
    g: float
    b: float
    a: float


class PrimitivePose(msgspec.Struct, frozen=True, gc=False):
    """Of a primitive in its entity's frame."""

    position: Vector3
    orientation: Quaternion


class LinePrimitive(msgspec.Struct, frozen=True):
    """type 2: a list of separate lines, two points each."""

    type: int
    pose: PrimitivePose
    thickness: float
    scale_invariant: bool
    points: list[Vector3]
    color: Color
    colors: list[Color]
    indices: list[int]


class SceneEntity(msgspec.Struct, frozen=True):
    """Primitives drawn in one frame of reference; they move with it where it is locked."""

    timestamp: Time
    frame_id: str
    id: str
    lifetime: Time
    frame_locked: bool
    metadata: list[dict[str, str]]
    arrows: list[dict[str, str]]
    cubes: list[dict[str, str]]
    spheres: list[dict[str, str]]
    cylinders: list[dict[str, str]]
    lines: list[LinePrimitive]
    triangles: list[dict[str, str]]
    texts: list[dict[str, str]]
    models: list[dict[str, str]]


class SceneUpdate(msgspec.Struct, frozen=True):
    """Entities that replace those of the same id."""

    deletions: list[dict[str, str]]
    entities: list[SceneEntity]


FOXGLOVE: dict[str, type[msgspec.Struct]] = {
    TRANSFORMS: FrameTransforms,
    CAMERA_CALIBRATION: CameraCalibration,
    SCENE: SceneUpdate,
    IMAGE: CompressedImage,
}


def foxglove_schema(name: str) -> bytes:
    """The JSON schema of one of them, self-contained."""
    schema = msgspec.json.schema(FOXGLOVE[name])
    inlined = _inline_references(schema, schema.get("$defs", {}))
    inlined["title"] = name
    return msgspec.json.encode(inlined)


def _inline_references(schema: Any, definitions: dict[str, Any]) -> Any:
    """The schema with each reference replaced by its definition."""
    if isinstance(schema, list):
        return [_inline_references(item, definitions) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        return _inline_references(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    return {
        key: _inline_references(item, definitions) for key, item in schema.items() if key != "$defs"
    }
