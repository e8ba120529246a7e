"""The JSON schema of each message, made from the structs themselves."""

import msgspec

from mocapd.outputs import messages, wire

STRUCTS: dict[str, type[msgspec.Struct]] = {
    wire.SCHEMA: wire.SkeletonFrame,
    messages.HEALTH: messages.Health,
    messages.CAMERA_STATUS: messages.CameraStatus,
    messages.CALIBRATION: messages.CalibrationInfo,
    messages.REST_SKELETON: messages.RestSkeleton,
    messages.FACING: messages.Facing,
}
ENCODING = "application/schema+json"


def schema_json(name: str) -> bytes:
    """JSON schema of the message `name`, such as `mocapd.Skeleton.v1`; holds for msgpack and JSON."""
    return msgspec.json.encode(msgspec.json.schema(STRUCTS[name]))
