"""State messages as on the wire: health, cameras, calibration, rest skeleton, facing. The newest one is valid."""

from functools import cache
from typing import Annotated, Any, get_type_hints

import msgspec
from msgspec import Meta

from mocapd.errors import InputError
from mocapd.outputs.wire import MOST_JOINTS, BoneName, Number, Person, Vector, decode_message

HEALTH = "mocapd.Health.v1"
CAMERA_STATUS = "mocapd.CameraStatus.v1"
CALIBRATION = "mocapd.Calibration.v1"
REST_SKELETON = "mocapd.Skeleton.Rest.v1"
FACING = "mocapd.Facing.v1"


MOST_COUNT = 2**53  # the largest integer that every receiver holds exactly

# msgpack and JSON hold integers up to 64 bits, JavaScript and Godot up to 2^53; Python's have no limit
_COUNT = Meta(ge=0, le=MOST_COUNT)
Count = Annotated[int, _COUNT]


class CountingMessage(msgspec.Struct, frozen=True):
    """Base of messages with counters: each field of type `Count` is limited to 0 … MOST_COUNT when the message is
    made. A received message that exceeds it is malformed."""

    def __post_init__(self) -> None:
        for name in _counters(type(self)):
            count = getattr(self, name)
            if not 0 <= count <= MOST_COUNT:
                msgspec.structs.force_setattr(self, name, min(max(0, count), MOST_COUNT))


@cache
def _counters(kind: type[msgspec.Struct]) -> tuple[str, ...]:
    """Names of the fields of type `Count`."""
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    return tuple(
        name for name, hint in hints.items() if _COUNT in getattr(hint, "__metadata__", ())
    )


class OutputHealth(CountingMessage, frozen=True):
    """One output as its sink sees it."""

    name: Annotated[str, Meta(description="name of the output: `zenoh`, `osc`, ...")]
    sent: Annotated[Count, Meta(description="frames sent since the start")]
    refused: Annotated[
        Count, Meta(description="frames without a receiver, or refused by the system")
    ]
    listeners: Annotated[
        int, Meta(description="number of receivers; -1: unknown for this protocol")
    ]
    detail: Annotated[str, Meta(description="one line for people")]


class Health(CountingMessage, frozen=True):
    """Health of the daemon, about once a second."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    version: Annotated[str, Meta(description="version of mocapd")]
    pid: Annotated[int, Meta(description="process id of the daemon")]
    started_unix_ns: Annotated[int, Meta(description="start of the daemon, Unix time [ns]")]
    now_unix_ns: Annotated[int, Meta(description="time of this message, Unix time [ns]")]
    tracker: Annotated[str, Meta(description="the tracker in use")]
    tracking: Annotated[str, Meta(description="`live`, `coasting` or `lost`")]
    rate_hz: Annotated[float, Meta(description="skeleton frames per second, lately [Hz]")]
    latency_median_ms: Annotated[float, Meta(description="capture to publish, median [ms]")]
    latency_p95_ms: Annotated[float, Meta(description="capture to publish, 95th percentile [ms]")]
    frame_sets: Annotated[Count, Meta(description="frame sets tracked since the start")]
    dropped: Annotated[
        Count, Meta(description="frame sets displaced by newer ones since the start")
    ]
    outputs: Annotated[tuple[OutputHealth, ...], Meta(description="every open output")] = ()
    detail: Annotated[
        str, Meta(description="one line for people: a problem of the whole daemon; usually empty")
    ] = ""
    schema: Annotated[str, Meta(description=f"always `{HEALTH}`")] = HEALTH
    effort: Annotated[
        str,
        Meta(
            description="optional work of the tracker: `full`; less on a machine that is too slow: `saving` or `least`"
        ),
    ] = "full"
    slowness: Annotated[
        str,
        Meta(
            description="warning for people that the daemon skips many frame sets, with the cause and the remedy, in one "
            "line; empty while tracking keeps up. While it is not empty, games show `tracking is slow`"
        ),
    ] = ""


class CameraStatus(CountingMessage, frozen=True):
    """One camera; sent when its state changes and about once a second."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    camera: Annotated[str, Meta(description="name of the camera in the rig")]
    state: Annotated[
        str, Meta(description="`live`, `starting`, `lost` (being reopened) or `ended`")
    ]
    detail: Annotated[
        str,
        Meta(
            description="one line for people: why it is not live, or a problem of its pictures or its port"
        ),
    ]
    source: Annotated[str, Meta(description="device node, path or URL it is read from")]
    identity: Annotated[
        str, Meta(description="USB port path, vid:pid and serial; empty: no webcam")
    ]
    size_px: Annotated[tuple[int, int], Meta(description="width, height of its pictures [px]")]
    rate_hz: Annotated[float, Meta(description="pictures per second, lately [Hz]")]
    frames: Annotated[Count, Meta(description="pictures taken since the start")]
    lost_frames: Annotated[Count, Meta(description="pictures that were lost or arrived damaged")]
    reopened: Annotated[Count, Meta(description="how often the daemon had to reopen the camera")]
    mounting: Annotated[
        str,
        Meta(
            description="`steady`; `bumped`: the camera was turned since the start, calibrate the room again; `swapped`: the "
            "camera shows the view of another camera; or `unknown`"
        ),
    ] = "unknown"
    schema: Annotated[str, Meta(description=f"always `{CAMERA_STATUS}`")] = CAMERA_STATUS


class CalibratedCamera(msgspec.Struct, frozen=True):
    """Intrinsics and extrinsics: x_camera = R x_world + t, OpenCV axes."""

    name: Annotated[str, Meta(description="name of the camera in the rig")]
    size_px: Annotated[tuple[int, int], Meta(description="width, height of the calibration [px]")]
    K: Annotated[
        tuple[Number, ...],
        Meta(min_length=9, max_length=9, description="camera matrix, 9 numbers by rows [px]"),
    ]
    dist: Annotated[
        tuple[Number, ...], Meta(min_length=5, max_length=5, description="k1 k2 p1 p2 k3")
    ]
    R: Annotated[
        tuple[Number, ...],
        Meta(min_length=9, max_length=9, description="camera from world, 9 numbers by rows"),
    ]
    t_m: Annotated[
        tuple[Number, ...],
        Meta(min_length=3, max_length=3, description="camera from world, 3 numbers [m]"),
    ]


class CalibrationInfo(msgspec.Struct, frozen=True):
    """The rig that the daemon tracks with."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    source: Annotated[str, Meta(description="the file it was read from")]
    cameras: Annotated[tuple[CalibratedCamera, ...], Meta(description="in the order of the rig")]
    schema: Annotated[str, Meta(description=f"always `{CALIBRATION}`")] = CALIBRATION


class RestSkeleton(msgspec.Struct, frozen=True):
    """One person's skeleton in the T-pose, so that a receiver can build it before the first frame.

    Parallel lists, parents by index and before their children, -1 at the root: the form that engines take (Godot's and
    Unreal's bone arrays, the nodes of glTF). One pass in order poses the whole skeleton.
    """

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    person: Annotated[Person, Meta(description="number of the person, as in the key")]
    stature_m: Annotated[Number, Meta(description="the person's height without shoes [m]")]
    names: Annotated[
        tuple[BoneName, ...],
        Meta(
            max_length=MOST_JOINTS,
            description="VRM 1.0 bone names, every parent before its children",
        ),
    ]
    parents: Annotated[
        tuple[int, ...], Meta(description="of each bone: place of its parent in `names`; root: -1")
    ]
    offsets_m: Annotated[
        tuple[Vector, ...],
        Meta(
            description="vector from the parent's joint to each bone's joint in the T-pose, in world axes; for the root, "
            "from the floor below it [m]"
        ),
    ]
    schema: Annotated[str, Meta(description=f"always `{REST_SKELETON}`")] = REST_SKELETON


class Facing(msgspec.Struct, frozen=True):
    """One person's facing direction at the last `mocapd recenter`, to be shown as forward.

    Frames stay in the world's axes: a receiver that wants the person to face forward rotates them itself.
    """

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    person: Annotated[Person, Meta(description="number of the person, as in the key")]
    yaw_deg: Annotated[
        float,
        Meta(
            description="rotation about +Y from +Z to the person's forward direction, positive to the person's left, "
            "-180..180 [deg]"
        ),
    ]
    at_unix_ns: Annotated[int, Meta(description="time of the recentre, Unix time [ns]")]
    schema: Annotated[str, Meta(description=f"always `{FACING}`")] = FACING


StateMessage = Health | CameraStatus | CalibrationInfo | RestSkeleton | Facing


def subject(message: StateMessage) -> tuple[str, str]:
    """What a message describes: a newer message replaces an older one with the same subject."""
    match message:
        case CameraStatus(camera=camera):
            return message.schema, camera
        case RestSkeleton(person=person) | Facing(person=person):
            return message.schema, str(person)
        case _:
            return message.schema, ""


def decode_health(payload: bytes, encoding: str) -> Health:
    """Decode a Health; unknown fields (later additions to v1) are skipped. Raises InputError."""
    return decode_message(payload, encoding, Health, HEALTH)


def decode_rest_skeleton(payload: bytes, encoding: str) -> RestSkeleton:
    """Decode a rest skeleton; unknown fields (later additions to v1) are skipped. Raises InputError."""
    rest = decode_message(payload, encoding, RestSkeleton, REST_SKELETON)
    if not (
        len(rest.names) == len(rest.parents) == len(rest.offsets_m)
        and all(-1 <= parent < place for place, parent in enumerate(rest.parents))
    ):
        raise InputError(
            f"the lists of a {REST_SKELETON} do not belong together",
            "wire",
            "look for another program that publishes on this key",
        )
    return rest
