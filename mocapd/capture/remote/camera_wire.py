"""The protocol between camera nodes and daemons: keys `mocapd-camera/v1/<node>/...` and messages.

A picture is a JPEG file (`image/jpeg`), so any program can show it; its stamp is Zenoh's attachment. The other messages
are msgpack maps. Within v1 fields are only added. The keys do not begin with `mocapd/`, so access to skeletons does not
grant access to pictures. This module bounds all input.
"""

from typing import Annotated, Literal, TypeVar

import msgspec
from msgspec import Meta

from mocapd.boundary.parsing import decode_msgpack
from mocapd.capture.webcam.camera_controls import Control
from mocapd.errors import MalformedError

ROOT = "mocapd-camera/v1"
ANY = "*"
SCHEMA = "mocapd.Camera.v1"
ENCODING = f"application/msgpack;{SCHEMA}"

MOST_PICTURE_BYTES = 8 << 20  # a JPEG of 4K at the best quality
MOST_MESSAGE_BYTES = 16_384
MOST_NAME = 64  # characters
MOST_TOGETHER_BYTES = MOST_PICTURE_BYTES + MOST_MESSAGE_BYTES

Text = Annotated[str, Meta(max_length=400)]
# what needs no replacement in a key, nor in an address
Name = Annotated[str, Meta(max_length=MOST_NAME, pattern=r"\A[A-Za-z0-9_.\-]+\Z")]
Count = Annotated[int, Meta(ge=0, le=2**53)]
# 36 years either way: differences of differences still fit 64 bits
Time = Annotated[int, Meta(ge=-(2**60), le=2**60, description="CLOCK_MONOTONIC of the node [ns]")]
Value = Annotated[int, Meta(ge=-(2**31), le=2**31 - 1)]
Side = Annotated[int, Meta(ge=0, le=65_535)]
Schema = Annotated[str, Meta(max_length=40, description=f"always `{SCHEMA}`")]

M = TypeVar("M", bound=msgspec.Struct)


def picture(node: str, camera: str) -> str:
    """The pictures of one camera."""
    return f"{ROOT}/{node}/{camera}/picture"


def state(node: str, camera: str) -> str:
    """Answers with `CameraState`."""
    return f"{ROOT}/{node}/{camera}/state"


def control(node: str, camera: str) -> str:
    """Takes `Order`, answers with `Done`; for the paired daemon only."""
    return f"{ROOT}/{node}/{camera}/control"


def alive(node: str, camera: str) -> str:
    """The liveliness token, present while the camera delivers."""
    return f"{ROOT}/{node}/{camera}/alive"


def clock(node: str) -> str:
    """Answers with `ClockAnswer`."""
    return f"{ROOT}/{node}/clock"


class PictureStamp(msgspec.Struct, frozen=True):
    """Which picture it is."""

    run: Annotated[Count, Meta(description="another number after each start of the node")]
    seq: Annotated[Count, Meta(description="counts what the camera delivered; gaps are lost")]
    exposure_ns: Annotated[Time, Meta(description="middle of the exposure")]
    schema: Schema = SCHEMA


class CameraState(msgspec.Struct, frozen=True):
    """The status of a camera at its node."""

    node: Name
    camera: Name
    state: Annotated[
        Literal["starting", "live", "lost", "ended"], Meta(description="as a capture thread has it")
    ]
    reason: Annotated[Text, Meta(description="why it is not live")]
    size_px: Annotated[tuple[Side, Side], Meta(description="width, height; 0, 0: not known yet")]
    rate_hz: Annotated[float, Meta(ge=0, le=10_000, description="lately [Hz]")]
    can_set: Annotated[bool, Meta(description="a webcam, whose controls the paired daemon sets")]
    run: Count
    schema: Schema = SCHEMA


class ClockAnswer(msgspec.Struct, frozen=True):
    """When the question came and when the answer left."""

    run: Count
    taken_ns: Time
    answered_ns: Time
    schema: Schema = SCHEMA


class LockedControls(msgspec.Struct, frozen=True, omit_defaults=True):
    """The controls to set at each opening: the fields of `capture.webcam.controls.Controls`."""

    auto_exposure: bool | None = None
    exposure: Value | None = None
    gain: Value | None = None
    auto_wb: bool | None = None
    wb_temperature: Value | None = None
    autofocus: bool | None = None
    focus: Value | None = None
    dynamic_framerate: bool | None = None
    power_line_hz: Literal[0, 50, 60] | None = None


class Order(msgspec.Struct, frozen=True):
    """`range`, `read`, `write` one control; `keep`: hold these from now on, also after a replug."""

    verb: Literal["range", "read", "write", "keep"]
    control: Control | None = None
    value: Value = 0
    kept: LockedControls = LockedControls()
    schema: Schema = SCHEMA


class Done(msgspec.Struct, frozen=True):
    """The control's value now, or its range; `trouble`: why nothing was done."""

    value: Value | None = None
    limits: tuple[Value, Value, Value] | None = None
    trouble: Text = ""
    schema: Schema = SCHEMA


def encode(message: msgspec.Struct) -> bytes:
    return msgspec.msgpack.encode(message)


def decode(data: bytes, kind: type[M]) -> M:
    """Decodes a message of this type. Raises MalformedError, also for another version."""
    if len(data) > MOST_MESSAGE_BYTES:
        raise MalformedError(f"a message of {len(data)} bytes")
    message = decode_msgpack(data, kind)
    schema = getattr(message, "schema", None)
    if schema != SCHEMA:
        raise MalformedError(f"of the schema {schema!r}, this program reads {SCHEMA!r}")
    return message
