"""A frame in an eighth of its bytes, for recordings: `mocapd.PackedSkeleton.v1`. Pure.

Published frames take up to 460 MB an hour at 60 Hz and compress badly, because their last digits are noise. Packed
positions are on a grid of 15 micrometres and rotations of 0.003 degrees, far below any tracker's error, and
uncertainties in tenths of a millimetre. Rotations relative to the parents follow from the global ones. Bytes of equal
weight are grouped, because the upper ones repeat and compress well.
"""

from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from mocapd.body.skeleton import local_from_global
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import (
    SCHEMA,
    FrameNumber,
    Joint,
    Nanoseconds,
    Person,
    SkeletonFrame,
    decode_message,
)
from mocapd.types import Bytes, Floats, Ints, Skeleton

PACKED = "mocapd.PackedSkeleton.v1"
GRID_M = 2.0**-16
FARTHEST_M = 2.0**23 * GRID_M  # 128 m from the origin: 24 bits
_SD_STEPS_PER_M = 10_000.0
_SD_UNKNOWN = 65535
_TURN_STEPS = 32767.0 * np.sqrt(2.0)  # the three smaller components are below sqrt(1/2)
# of each component, the three others
_OTHERS = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


class PackedFrame(msgspec.Struct, frozen=True):
    """A SkeletonFrame whose joints are arrays, in the order of the person's rest skeleton. Lost: empty arrays."""

    instance: Annotated[str, Meta(description="as in mocapd.Skeleton.v1, and so down to `cameras`")]
    person: Person
    seq: FrameNumber
    capture_monotonic_ns: Nanoseconds
    capture_unix_ns: Nanoseconds
    publish_monotonic_ns: Nanoseconds
    tracker: str
    tracking: str
    cameras: tuple[str, ...]
    p: Annotated[
        bytes,
        Meta(
            description="positions / 2^-16 m, whole: the lower bytes of x of all joints, of y, of z, then the middle"
            " bytes, then the upper"
        ),
    ]
    k: Annotated[
        bytes,
        Meta(description="of each joint's global quaternion which of x y z w is largest, 0..3"),
    ]
    r: Annotated[
        bytes,
        Meta(
            description="the three others / that one's sign * 32767 sqrt(2), whole: lower bytes, then upper, as `p`"
        ),
    ]
    c: Annotated[bytes, Meta(description="confidence * 255 of each joint")]
    smoothing_lag_ns: Annotated[
        Nanoseconds, Meta(description="as in mocapd.Skeleton.v1, and so the next")
    ] = 0
    predicted_ns: Nanoseconds = 0
    u: Annotated[
        bytes,
        Meta(
            description="uncertainty of each joint's position / 0.1 mm, whole, 65535: unknown: the lower bytes of all joints,"
            " then the upper; empty: all are unknown"
        ),
    ] = b""
    schema: Annotated[str, Meta(description=f"always `{PACKED}`")] = PACKED


def pack(frame: SkeletonFrame, names: tuple[str, ...]) -> PackedFrame | None:
    """The frame with its joints in the order of `names`; None where it has other joints, or one is out of range."""
    joints = frame.joints
    if joints and tuple(joints) != names:
        return None
    positions_m = np.array([joint.p for joint in joints.values()]).reshape(-1, 3)
    quats_xyzw = np.array([joint.r for joint in joints.values()]).reshape(-1, 4)
    confidence = np.array([joint.c for joint in joints.values()])
    sane = np.abs(positions_m) < FARTHEST_M - 1.0  # False for NaN
    if not (sane.all() and np.isfinite(quats_xyzw).all() and np.isfinite(confidence).all()):
        return None
    largest = np.argmax(np.abs(quats_xyzw), axis=1)
    sign = np.sign(np.take_along_axis(quats_xyzw, largest[:, None], axis=1))
    others = np.take_along_axis(quats_xyzw, _OTHERS[largest], axis=1) * sign
    return PackedFrame(
        frame.instance,
        frame.person,
        frame.seq,
        frame.capture_monotonic_ns,
        frame.capture_unix_ns,
        frame.publish_monotonic_ns,
        frame.tracker,
        frame.tracking,
        frame.cameras,
        _planes(np.rint(positions_m / GRID_M), 3),
        largest.astype(np.uint8).tobytes(),
        _planes(np.rint(np.clip(others * _TURN_STEPS, -32767, 32767)), 2),
        np.rint(np.clip(confidence, 0.0, 1.0) * 255).astype(np.uint8).tobytes(),
        frame.smoothing_lag_ns,
        frame.predicted_ns,
        _packed_uncertainties([joint.u for joint in joints.values()]),
    )


def unpack(packed: PackedFrame, rest: RestSkeleton) -> SkeletonFrame:
    """The frame, within the grid's error. Raises InputError where it has another skeleton."""
    joints: dict[str, Joint] = {}
    if packed.k:
        n = len(rest.names)
        if (len(packed.p), len(packed.k), len(packed.r), len(packed.c)) != (9 * n, n, 6 * n, n):
            raise _other_skeleton()
        positions_m = _whole(packed.p, 3) * GRID_M
        quats_xyzw = _quats(np.frombuffer(packed.k, dtype=np.uint8), _whole(packed.r, 2))
        confidence = np.frombuffer(packed.c, dtype=np.uint8) / 255.0
        uncertainties_m = _uncertainties_m(packed.u, n)
        local_xyzw = local_from_global(
            Skeleton(rest.names, np.array(rest.parents, dtype=np.int64), np.zeros((n, 3))),
            quats_xyzw,
        )
        joints = {
            name: Joint(tuple(p), tuple(r), tuple(turn), c, u)
            for name, p, r, turn, c, u in zip(
                rest.names,
                positions_m.tolist(),
                quats_xyzw.tolist(),
                local_xyzw.tolist(),
                confidence.tolist(),
                uncertainties_m,
                strict=True,
            )
        }
    return SkeletonFrame(
        SCHEMA,
        packed.instance,
        packed.person,
        packed.seq,
        packed.capture_monotonic_ns,
        packed.capture_unix_ns,
        packed.publish_monotonic_ns,
        packed.tracker,
        packed.tracking,
        packed.cameras,
        joints,
        packed.smoothing_lag_ns,
        packed.predicted_ns,
    )


def encode_packed(packed: PackedFrame) -> bytes:
    """As msgpack."""
    return msgspec.msgpack.encode(packed)


def decode_packed(payload: bytes, encoding: str) -> PackedFrame:
    """The inverse of `encode_packed`. Raises InputError."""
    return decode_message(payload, encoding, PackedFrame, PACKED)


def _other_skeleton() -> InputError:
    return InputError(
        f"a {PACKED} has not as many joints as its rest skeleton",
        "recording",
        "record again; the file is damaged",
    )


def _planes(values: Floats, n_bytes: int) -> bytes:
    """Whole numbers (J,3) as their lowest bytes, x of all joints, then y, then z; then the next bytes."""
    columns = np.ascontiguousarray(values.T, dtype="<i4")[..., None].view(np.uint8)
    return np.moveaxis(columns, -1, 0)[:n_bytes].tobytes()


def _whole(planes: bytes, n_bytes: int) -> Ints:
    """The inverse of `_planes`: the numbers (J,3)."""
    data: Bytes = np.frombuffer(planes, dtype=np.uint8).reshape(n_bytes, 3, -1)
    shifts = 8 * np.arange(n_bytes)[:, None, None]
    unsigned = (data.astype(np.int64) << shifts).sum(axis=0)
    half = 1 << (8 * n_bytes - 1)
    numbers: Ints = ((unsigned + half) % (2 * half) - half).T
    return numbers


def _packed_uncertainties(uncertainties_m: list[float | None]) -> bytes:
    if all(sd_m is None for sd_m in uncertainties_m):
        return b""
    steps = np.array([np.nan if sd_m is None else sd_m for sd_m in uncertainties_m])
    steps *= _SD_STEPS_PER_M
    whole = np.where(
        np.isfinite(steps), np.clip(np.rint(steps), 0, _SD_UNKNOWN - 1), _SD_UNKNOWN
    ).astype("<u2")
    return whole.view(np.uint8).reshape(-1, 2).T.tobytes()


def _uncertainties_m(planes: bytes, n: int) -> list[float | None]:
    """Of n joints; all None in a recording of a version without uncertainties."""
    if not planes:
        return [None] * n
    if len(planes) != 2 * n:
        raise _other_skeleton()
    whole = np.ascontiguousarray(np.frombuffer(planes, dtype=np.uint8).reshape(2, n).T).view("<u2")
    steps = whole[:, 0].tolist()
    return [None if step == _SD_UNKNOWN else step / _SD_STEPS_PER_M for step in steps]


def _quats(largest: Bytes, others: Ints) -> Floats:
    if largest.max() > 3:
        raise _other_skeleton()
    small = others / _TURN_STEPS
    quats = np.empty((len(largest), 4))
    np.put_along_axis(quats, _OTHERS[largest], small, axis=1)
    rest = np.sqrt(np.maximum(1.0 - np.vecdot(small, small), 0.25))  # never the smaller one
    np.put_along_axis(quats, largest[:, None].astype(np.int64), rest[:, None], axis=1)
    return rotations.canonical(quats)
