"""A camera's picture in a recording: its JPEG in a Foxglove `CompressedImage`.

Fields and types are those of foxglove/foxglove-sdk, schemas/jsonschema/CompressedImage.json; bytes are base64.
"""

from typing import Annotated

import msgspec
from msgspec import Meta

from mocapd.boundary.parsing import decode_json
from mocapd.clock import NS_PER_S

IMAGE = "foxglove.CompressedImage"
_PREFIX, _SUFFIX = "/camera/", "/image"
MOST_S = 2**33  # of a time, Unix time [s]: in some centuries


class Time(msgspec.Struct, frozen=True, gc=False):
    """An instant, Unix time."""

    sec: Annotated[int, Meta(ge=0, le=MOST_S)]
    nsec: Annotated[int, Meta(ge=0, le=NS_PER_S - 1)]

    @classmethod
    def of(cls, unix_ns: int) -> "Time":
        """From whole nanoseconds."""
        return cls(*divmod(max(0, unix_ns), NS_PER_S))

    @property
    def unix_ns(self) -> int:
        """As whole nanoseconds."""
        return self.sec * NS_PER_S + self.nsec


class CompressedImage(msgspec.Struct, frozen=True):
    """One picture; `timestamp`: the middle of its exposure."""

    timestamp: Time
    frame_id: Annotated[str, Meta(description="the camera's frame: x right, y down, z forward")]
    data: Annotated[
        bytes,
        Meta(description="the file", extra_json_schema={"contentEncoding": "base64"}),
    ]
    format: Annotated[str, Meta(description="always `jpeg`")] = "jpeg"


def image_topic(camera: str) -> str:
    """The topic of a camera's pictures."""
    return f"{_PREFIX}{camera}{_SUFFIX}"


def camera_of(topic: str) -> str:
    """The camera of a picture topic; empty for any other topic."""
    if not (topic.startswith(_PREFIX) and topic.endswith(_SUFFIX)):
        return ""
    return topic[len(_PREFIX) : -len(_SUFFIX)]


def camera_frame(camera: str) -> str:
    """The name of its frame of reference."""
    return f"camera/{camera}"


def decode_picture_message(data: bytes) -> CompressedImage:
    """Decodes a message of a picture topic. Raises MalformedError."""
    return decode_json(data, CompressedImage)
