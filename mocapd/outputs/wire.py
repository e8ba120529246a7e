"""The wire schema `mocapd.Skeleton.v1`: what a subscriber decodes.

A msgpack map (or the same as JSON), self-describing, so that any language reads it. Within v1 fields
are only added: a decoder skips fields it does not know. Frame of reference: the world of
`mocapd.types` (right-handed, +Y up, metres, a person at rest faces +Z), quaternions xyzw.
"""

from typing import Annotated, Protocol, TypeVar

import msgspec
from msgspec import Meta

from mocapd.boundary.parsing import decode_json, decode_msgpack
from mocapd.errors import InputError, MalformedError

SCHEMA = "mocapd.Skeleton.v1"
MSGPACK_MIME = "application/msgpack"
JSON_MIME = "application/json"
MSGPACK = f"{MSGPACK_MIME};{SCHEMA}"
JSON = f"{JSON_MIME};{SCHEMA}"


class Message(Protocol):
    """Any of our messages: it names its schema."""

    @property
    def schema(self) -> str: ...


M = TypeVar("M", bound=Message)

# Limits for every reader: numbers stay finite in a float32, sums of two times within 64 bits. NaN is in no range.
# A frame with a number beyond them is refused as damaged.
Number = Annotated[float, Meta(ge=-1e6, le=1e6)]
Person = Annotated[int, Meta(ge=0, le=2**31 - 1)]
Nanoseconds = Annotated[int, Meta(ge=-(2**62), le=2**62)]
FrameNumber = Annotated[int, Meta(ge=0, le=2**63 - 1)]
BoneName = Annotated[str, Meta(max_length=100)]
MOST_JOINTS = 256
Vector = tuple[Number, Number, Number]
Quaternion = tuple[Number, Number, Number, Number]


class Joint(msgspec.Struct, frozen=True, gc=False, omit_defaults=True):
    """One bone. Keys are single letters because they are sent once per bone and frame; `u` is absent where it is None."""

    p: Annotated[Vector, Meta(description="position of the joint in the world [m], x y z")]
    r: Annotated[
        Quaternion, Meta(description="global rotation relative to the T-pose, x y z w, w >= 0")
    ]
    l: Annotated[  # noqa: E741 (the wire's short key)
        Quaternion, Meta(description="rotation relative to the parent bone, x y z w, w >= 0")
    ]
    c: Annotated[Number, Meta(description="confidence 0..1, near 0 where there is no evidence")]
    u: Annotated[
        Number | None,
        Meta(
            description="one standard deviation of the position, root mean square over x, y and z [m]; absent or null where"
            " it is unknown"
        ),
    ] = None


class SkeletonFrame(msgspec.Struct, frozen=True):
    """One person at one instant, as sent. Lost: `joints` is empty."""

    schema: Annotated[str, Meta(description=f"always `{SCHEMA}`")]
    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    person: Annotated[Person, Meta(description="number of the person, as in the key")]
    seq: Annotated[
        FrameNumber, Meta(description="counts the frames made; a gap is a frame not received")
    ]
    capture_monotonic_ns: Annotated[
        Nanoseconds, Meta(description="middle of the exposure, CLOCK_MONOTONIC of the sender [ns]")
    ]
    capture_unix_ns: Annotated[Nanoseconds, Meta(description="the same instant, Unix time [ns]")]
    publish_monotonic_ns: Annotated[
        Nanoseconds,
        Meta(description="when the frame was handed to the outputs, CLOCK_MONOTONIC [ns]"),
    ]
    tracker: Annotated[
        str,
        Meta(
            description="cues that determined the pose: `shirt`, `clothes` or `shirt+clothes`; the tracker's name if the "
            "tracker has no cues (`canned`) or tracks nobody"
        ),
    ]
    tracking: Annotated[str, Meta(description="`live`, `coasting` (predicted) or `lost`")]
    cameras: Annotated[tuple[str, ...], Meta(description="cameras whose evidence was used")]
    joints: Annotated[
        dict[BoneName, Joint],
        Meta(
            max_length=MOST_JOINTS,
            description="by VRM 1.0 bone name; empty when tracking is `lost`",
        ),
    ]
    smoothing_lag_ns: Annotated[
        Nanoseconds,
        Meta(
            description="approximate delay of a moving person's pose by the tracker's filter and the smoothing, in addition "
            "to the frame's age [ns]"
        ),
    ] = 0
    predicted_ns: Annotated[
        Nanoseconds,
        Meta(
            description="time between the last measured pose and a predicted one, whose capture times are the predicted "
            "times; 0 for a measured pose [ns]"
        ),
    ] = 0


def encode_msgpack(frame: SkeletonFrame) -> bytes:
    """The frame as a msgpack map; its encoding string is `MSGPACK`."""
    return msgspec.msgpack.encode(frame)


def encode_json(frame: SkeletonFrame) -> bytes:
    """The frame as JSON, for eyes and debugging; its encoding string is `JSON`."""
    return msgspec.json.encode(frame)


def decode(payload: bytes, encoding: str = MSGPACK) -> SkeletonFrame:
    """Decode a frame; unknown fields (later additions to v1) are skipped.

    `encoding`: the sender's `<mime>;<schema>`. Raises InputError for a damaged payload, an
    encoding that is neither msgpack nor JSON, or another schema version.
    """
    return decode_message(payload, encoding, SkeletonFrame, SCHEMA)


def decode_message(payload: bytes, encoding: str, kind: type[M], schema: str) -> M:
    """As `decode`, for any message: `kind`, whose `schema` must be this one."""
    mime, _, said = encoding.partition(";")
    if said and said != schema:
        raise _other_schema(said, schema)
    try:
        if mime == MSGPACK_MIME:
            message = decode_msgpack(payload, kind)
        elif mime == JSON_MIME:
            message = decode_json(payload, kind)
        else:
            raise InputError(
                f"encoding {encoding[:80]!r} is not known",
                "wire",
                f"send '{MSGPACK_MIME};{schema}' or '{JSON_MIME};{schema}'",
            )
    except MalformedError as error:
        raise InputError(
            f"a payload of {len(payload)} bytes is no {schema}: {error.what}",
            "wire",
            "look for another program that publishes on this key",
        ) from None
    if message.schema != schema:
        raise _other_schema(message.schema, schema)
    return message


def _other_schema(theirs: str, ours: str) -> InputError:
    return InputError(
        f"the sender speaks {theirs!r}, this program reads {ours!r}",
        "wire",
        "bring daemon and client to the same version of mocapd",
    )
