"""Streams that every game client is played: good ones, and each thing that can be wrong with one.

A stream is a list of steps: a time of the client's clock [s], and the datagram that came then, or None where
the client only looks what there is.
"""

import random
import struct
from collections.abc import Iterable

import msgspec
from pythonosc.osc_message import OscMessage

from mocapd.app.terminal.waving_person import waving_person
from mocapd.body.shape import mean_shape
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.osc.osc_frame import FRAME, FRAME_TYPES, JOINT, JOINT_TYPES
from mocapd.outputs.wire import Joint, SkeletonFrame
from tests.golden.make_osc import datagrams, kept, lost, whole
from tests.golden.make_vmc import kept as kept_vmc
from tests.outputs.osc_packets import bundle, message

Step = tuple[float, bytes | None]
Stream = list[Step]

AFTER_2038_NS = (2**31 + 5) * 1_000_000_000 + 7  # seconds that an int32 cannot hold
FRAME_NS = 33_000_000
RATE_HZ = 60
STATURE_M = 1.75
SEED = 10


def at(time_s: float, packets: Iterable[bytes]) -> Stream:
    return [(time_s, packet) for packet in packets]


def later(frame: SkeletonFrame, count: int, **changes: object) -> SkeletonFrame:
    """The frame that comes so many after it."""
    moved = {"seq": frame.seq + count, "capture_unix_ns": frame.capture_unix_ns + count * FRAME_NS}
    return msgspec.structs.replace(frame, **(moved | changes))


def moved(frame: SkeletonFrame, by_m: float) -> SkeletonFrame:
    """Everything to the left by so much."""
    joints = {
        name: msgspec.structs.replace(one, p=(one.p[0] + by_m, *one.p[1:]))
        for name, one in frame.joints.items()
    }
    return msgspec.structs.replace(frame, joints=joints)


def with_joint(name: str, **changes: object) -> SkeletonFrame:
    """The pose with something else about one joint."""
    frame = whole()
    joint: Joint = msgspec.structs.replace(frame.joints[name], **changes)
    return msgspec.structs.replace(frame, joints={**frame.joints, name: joint})


def head(types: str = FRAME_TYPES, /, **changes: str | float) -> OscMessage:
    """The message before the joints, of a frame of one datagram."""
    arguments: dict[str, str | float] = {
        "person": 0, "seq": 1, "part": 0, "parts": 1, "joints": 1, "capture_s": 1, "capture_ns": 0, "latency_s": 0.0,
        "tracking": "live", "tracker": "canned", "cameras": "", "instance": "golden",
    }  # fmt: skip
    values = [*(arguments | changes).values()]
    return message(FRAME, types, *values)


def joint(
    name: str = "hips", *, types: str = JOINT_TYPES, more: tuple[str | float, ...] = ()
) -> OscMessage:
    """A joint in the T-pose, a metre above the floor."""
    numbers = (0.0, 1.0, 0.0, *(0.0, 0.0, 0.0, 1.0) * 2, 1.0, 0.01)
    return message(JOINT + name, types, *numbers, *more)


def bundled(*messages: OscMessage) -> bytes:
    return bundle(messages)


def _garbage() -> list[bytes]:
    drawn = random.Random(SEED)
    packets = [drawn.randbytes(drawn.randrange(0, 200)) for _ in range(100)]
    packets += [
        b"",
        b"/",
        b"/a\0\0",
        b"#bundle\0",
        b"#bundle\0" + bytes(8),
        b"\0" * 64,
        b"/\xff\xff\0,\0\0\0",
    ]
    packets += [
        b"#bundle\0" + bytes(8) + struct.pack(">i", size) + b"/a\0\0"
        for size in (-4, 0, 3, 8, 2**31 - 1)
    ]
    return packets


def _changed() -> list[bytes]:
    """Golden datagrams in which a few bytes are others."""
    drawn = random.Random(SEED)
    packets = []
    for number in range(150):
        packet = bytearray(kept("whole")[number % 2])
        for _ in range(drawn.randrange(1, 8)):
            packet[drawn.randrange(len(packet))] = drawn.randrange(256)
        packets.append(bytes(packet))
    return packets


def _cut_off() -> list[bytes]:
    return [packet[:size] for packet in kept("whole") for size in range(0, len(packet), 9)]


def _wrong_types() -> list[bytes]:
    short = message(JOINT + "hips", "f" * 11, *(0.0,) * 11)
    return [
        bundled(head("i" * 8 + "ssss", latency_s=0), joint()),
        bundled(head(), message(JOINT + "hips", "i" + "f" * 11, 0, *(0.0,) * 11)),
        bundled(head(), short),
        bundled(message(FRAME, ""), joint()),
    ]


def _impossible_heads() -> list[bytes]:
    changes: tuple[dict[str, str | float], ...] = (
        {"person": -1}, {"person": 2**31 - 1}, {"seq": -5}, {"part": 1}, {"part": -1}, {"parts": 0},
        {"parts": 2**31 - 1}, {"joints": -1}, {"joints": 2**31 - 1}, {"capture_ns": -1},
        {"latency_s": float("nan")}, {"tracking": "dancing"},
    )  # fmt: skip
    return [bundled(head(**change), joint()) for change in changes]


def _added_fields() -> bytes:
    return bundled(
        head(FRAME_TYPES + "if", seventh=7, eighth=0.5),
        message("/mocapd/v1/floor", "f", 0.0),
        joint(types=JOINT_TYPES + "sf", more=("new", 1.0)),
        message("/mocapd/v1/ball", "s", "x"),
    )


def as_v2(packet: bytes) -> bytes:
    """As a daemon of another time would send it."""
    return packet.replace(b"/mocapd/v1/", b"/mocapd/v2/")


def waving() -> list[SkeletonFrame]:
    """A second of `mocapd send-test`: a person who waves and steps to the left."""
    shape = mean_shape(STATURE_M)
    frames = []
    for seq in range(RATE_HZ):
        gone_ns = seq * 1_000_000_000 // RATE_HZ
        sample = waving_person(shape, gone_ns, gone_ns)
        frame = skeleton_frame(
            sample.track.body,
            sample.skeleton,
            instance="golden",
            seq=seq,
            publish_monotonic_ns=gone_ns,
            unix_from_monotonic_ns=whole().capture_unix_ns,
        )
        frames.append(frame)
    return frames


def told_well() -> dict[str, Stream]:
    """Streams with nothing wrong in them, whatever the network did to their order."""
    golden, first = kept("whole"), whole()
    without = {name: one for name, one in first.joints.items() if name != "leftLowerArm"}
    return {
        "golden": at(0.0, golden),
        "parts the other way round": at(0.0, reversed(golden)),
        "duplicates": at(0.0, [*golden, *golden, golden[1]]),
        "lost": at(0.0, golden) + at(0.03, kept("lost")) + [(1.0, None), (2.0, None), (9.0, None)],
        "lost first": at(0.0, datagrams(lost())),
        "silence": at(0.0, golden) + [(0.4, None), (0.6, None), (60.0, None)] + at(61.0, golden),
        "nothing": [(5.0, None)],
        "coasting": at(0.0, datagrams(later(first, 1, tracking="coasting"))),
        "no evidence": at(0.0, datagrams(with_joint("rightToes", c=0.5))),
        "a joint is missing": at(0.0, datagrams(msgspec.structs.replace(first, joints=without))),
        "added fields": at(0.0, [_added_fields()]),
        "after 2038": at(0.0, datagrams(msgspec.structs.replace(first, capture_unix_ns=AFTER_2038_NS))),
        "waving": [step for f in waving() for step in at(f.seq / RATE_HZ, datagrams(f))],
        "on one leg": at(0.0, datagrams(waving()[0])),
        "two persons": at(0.0, [golden[0], *datagrams(moved(later(first, 0, person=1), 2.0)), golden[1]]),
    }  # fmt: skip


def told_in_another_order() -> dict[str, Stream]:
    """Frames of which parts are missing, late ones, daemons that start anew, two daemons at once."""
    golden, first = kept("whole"), whole()
    same_ns = {"capture_unix_ns": first.capture_unix_ns}
    one, two = datagrams(later(first, 1)), datagrams(moved(later(first, 2), 1.0))
    anew = msgspec.structs.replace(later(first, 5), seq=0)
    other = datagrams(later(first, 1, instance="other"))
    end = 2**31 - 1
    return {
        "parts of different frames": at(0.0, [one[0], two[1]]) + at(0.1, two[:1]),
        "a part is missing": at(0.0, [one[0], *two]),
        "too few joints": at(0.0, [bundled(head(joints=2), joint())]),
        "late": at(0.0, two) + at(0.1, one),
        "started anew": at(0.0, datagrams(later(first, 1000, **same_ns))) + at(0.1, datagrams(anew)),
        "recording in a loop": at(0.0, datagrams(later(first, 9))) + at(0.1, datagrams(later(first, 10, **same_ns))),
        "clock set back": at(0.0, datagrams(later(first, 9))) + at(2.0, golden),
        "clock set back amid a frame": at(0.0, datagrams(later(first, 9))[:1]) + at(2.0, golden),
        "counted over the end": at(0.0, datagrams(later(first, end)))
        + at(0.1, datagrams(later(first, end + 1, **same_ns))),
        "second sender": at(0.0, golden) + at(0.1, other) + at(0.2, one),
        "second sender takes over": at(0.0, golden) + at(0.8, other),
        "two senders at once": at(0.0, [golden[0], other[0], golden[1], other[1]]),
    }  # fmt: skip


def told_badly() -> dict[str, Stream]:
    """What is no stream of ours, or a damaged one; a good frame ends those that are named in `RECOVERS`."""
    golden = kept("whole")
    good = at(9.0, datagrams(later(whole(), 100)))
    unlike: dict[str, dict[str, object]] = {
        "position NaN": {"p": (0.0, float("nan"), 0.0)},
        "position far": {"p": (1e9, 0.0, 0.0)},
        "rotation inf": {"r": (0.0, 0.0, float("inf"), 1.0)},
        "rotation zero": {"l": (0.0, 0.0, 0.0, 0.0)},
        "confidence inf": {"c": float("-inf")},
    }
    numbers = {
        name: at(0.0, datagrams(with_joint("leftUpperArm", **one))) for name, one in unlike.items()
    }
    return numbers | {
        "garbage": at(0.0, _garbage()) + good,
        "changed bytes": at(0.0, _changed()) + good,
        "cut off": at(0.0, _cut_off()) + good,
        "wrong types": at(0.0, _wrong_types()) + good,
        "impossible heads": at(0.0, _impossible_heads()) + good,
        "newer schema": at(0.0, map(as_v2, golden)),
        "newer schema beside v1": at(0.0, [golden[0], as_v2(golden[0]), golden[1]]),
        "another program": at(0.0, kept_vmc("two")),
        "no frame before the joints": at(0.0, [bundled(joint())]) + good,
    }  # fmt: skip


RECOVERS = (
    "garbage", "changed bytes", "cut off", "wrong types", "impossible heads", "no frame before the joints",
)  # fmt: skip


def streams() -> dict[str, Stream]:
    """All of them."""
    return told_well() | told_in_another_order() | told_badly()
