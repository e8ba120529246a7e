"""The bytes of a frame, and what a decoder makes of other bytes."""

import json

import msgspec
import pytest

from mocapd.errors import InputError
from mocapd.outputs import schemas, wire
from tests.outputs.frames import small_frame, whole_frame

# written out from the msgpack specification: fixmap of 13, then key and value by turns
GOLDEN_MSGPACK = b"".join(
    [
        b"\x8d",
        b"\xa6schema\xb2mocapd.Skeleton.v1",
        b"\xa8instance\xa2pc",
        b"\xa6person\x00",
        b"\xa3seq\x07",
        b"\xb4capture_monotonic_ns\xcf\x00\x00\x00\x01\x2a\x05\xf2\x7b",
        b"\xafcapture_unix_ns\xcf\x17\x97\x9c\xff\x60\x2f\xf2\x7b",
        b"\xb4publish_monotonic_ns\xcf\x00\x00\x00\x01\x2a\xf4\x5d\xa3",
        b"\xa7tracker\xa6colour",
        b"\xa8tracking\xa4live",
        b"\xa7cameras\x92\xa4left\xa5right",
        b"\xa6joints\x82",
        b"\xa4hips\x84",
        b"\xa1p\x93\xcb\x3f\xd0\0\0\0\0\0\0\xcb\x3f\xf0\0\0\0\0\0\0\xcb\xbf\xe0\0\0\0\0\0\0",
        b"\xa1r\x94" + b"\xcb\0\0\0\0\0\0\0\0" * 3 + b"\xcb\x3f\xf0\0\0\0\0\0\0",
        b"\xa1l\x94" + b"\xcb\0\0\0\0\0\0\0\0" * 3 + b"\xcb\x3f\xf0\0\0\0\0\0\0",
        b"\xa1c\xcb\x3f\xf0\0\0\0\0\0\0",
        b"\xacleftUpperArm\x84",
        b"\xa1p\x93\xcb\x3f\xe0\0\0\0\0\0\0\xcb\x3f\xf8\0\0\0\0\0\0\xcb\xbf\xe0\0\0\0\0\0\0",
        b"\xa1r\x94" + b"\xcb\0\0\0\0\0\0\0\0" * 2,
        b"\xcb\x3f\xe8\0\0\0\0\0\0\xcb\x3f\xe4\0\0\0\0\0\0",
        b"\xa1l\x94" + b"\xcb\x3f\xe0\0\0\0\0\0\0" * 4,
        b"\xa1c\xcb\x3f\xc0\0\0\0\0\0\0",
        b"\xb0smoothing_lag_ns\x00",
        b"\xacpredicted_ns\x00",
    ]
)


def test_msgpack_bytes_are_those_of_the_schema() -> None:
    assert wire.encode_msgpack(small_frame()) == GOLDEN_MSGPACK


def test_json_is_the_same_map() -> None:
    frame = json.loads(wire.encode_json(small_frame()))
    assert frame == msgspec.msgpack.decode(GOLDEN_MSGPACK)
    assert frame["joints"]["leftUpperArm"]["r"] == [0.0, 0.0, 0.75, 0.625]


@pytest.mark.parametrize(
    ("encode", "encoding"),
    [(wire.encode_msgpack, wire.MSGPACK), (wire.encode_json, wire.JSON)],
)
def test_every_frame_survives_the_round_trip(encode, encoding) -> None:  # type: ignore[no-untyped-def]
    lost = small_frame(tracking="lost", joints={}, cameras=())
    for frame in (small_frame(), whole_frame(), lost):
        assert wire.decode(encode(frame), encoding) == frame


def test_fields_of_later_additions_are_skipped() -> None:
    later = msgspec.msgpack.decode(GOLDEN_MSGPACK)
    later["velocity"] = [1, 2, 3]
    later["joints"]["hips"]["tension"] = 0.5
    assert wire.decode(msgspec.msgpack.encode(later)) == small_frame()
    assert wire.decode(msgspec.json.encode(later), wire.JSON) == small_frame()


def test_a_joint_says_how_uncertain_it_is_or_nothing_at_all() -> None:
    sent = msgspec.msgpack.decode(wire.encode_msgpack(whole_frame()))["joints"]
    assert sent["leftHand"]["u"] == 0.1001
    assert "u" not in sent["leftFoot"]
    older = msgspec.msgpack.decode(GOLDEN_MSGPACK)
    assert wire.decode(msgspec.msgpack.encode(older)).joints["hips"].u is None
    older["joints"]["hips"]["u"] = None
    assert wire.decode(msgspec.json.encode(older), wire.JSON).joints["hips"].u is None


class _OlderJoint(msgspec.Struct):
    """As clients of before know it."""

    p: tuple[float, float, float]
    c: float


def test_a_client_of_before_there_were_uncertainties_reads_frames_that_have_them() -> None:
    class OlderFrame(msgspec.Struct):
        joints: dict[str, _OlderJoint]

    frame = whole_frame()
    for read in (
        msgspec.msgpack.decode(wire.encode_msgpack(frame), type=OlderFrame),
        msgspec.json.decode(wire.encode_json(frame), type=OlderFrame),
    ):
        assert read.joints["leftHand"].p == frame.joints["leftHand"].p
        assert read.joints["leftHand"].c == frame.joints["leftHand"].c


def test_any_cut_is_a_named_error() -> None:
    for length in range(len(GOLDEN_MSGPACK)):
        with pytest.raises(InputError, match=r"no mocapd\.Skeleton\.v1"):
            wire.decode(GOLDEN_MSGPACK[:length])


@pytest.mark.parametrize(
    ("payload", "encoding"),
    [
        # Python 3.14 bears more than a hundred thousand levels
        (b"\x81\xa1x" + b"\x91" * 1_000_000 + b"\xc0", wire.MSGPACK),
        (b'{"x":' + b"[" * 1_000_000, wire.JSON),
    ],
)
def test_a_payload_nested_too_deeply_is_a_named_error(payload: bytes, encoding: str) -> None:
    with pytest.raises(InputError, match="nested too deeply"):
        wire.decode(payload, encoding)


@pytest.mark.parametrize(
    "payload", [b"\xc1", b"\x00", b'{"schema": "\xff\xfe"}', b'{"schema": 1}', b"[]", b"\x80"]
)
@pytest.mark.parametrize("encoding", [wire.MSGPACK, wire.JSON])
def test_garbage_is_a_named_error(payload: bytes, encoding: str) -> None:
    with pytest.raises(InputError, match="another program"):
        wire.decode(payload, encoding)


def test_another_version_says_which_and_what_to_do() -> None:
    with pytest.raises(InputError, match=r"'mocapd\.Skeleton\.v2'.*same version"):
        wire.decode(b"", "application/msgpack;mocapd.Skeleton.v2")
    with pytest.raises(InputError, match=r"'mocapd\.Skeleton\.v2'"):
        wire.decode(wire.encode_msgpack(small_frame(schema="mocapd.Skeleton.v2")))


def test_an_encoding_that_is_neither_is_a_named_error() -> None:
    with pytest.raises(InputError, match="application/cdr"):
        wire.decode(GOLDEN_MSGPACK, "application/cdr;mocapd.Skeleton.v1")


def test_the_served_schema_describes_every_field() -> None:
    for name, struct in schemas.STRUCTS.items():
        schema = json.loads(schemas.schema_json(name))
        definition = schema["$defs"][struct.__name__]
        assert list(definition["properties"]) == [
            f.encode_name for f in msgspec.structs.fields(struct)
        ]
        for described in schema["$defs"].values():
            assert all("description" in field for field in described["properties"].values())
