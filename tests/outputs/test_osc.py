"""OSC on the wire: golden bytes, an independent decoder, splitting."""

import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pythonosc.osc_bundle import OscBundle
from pythonosc.osc_message import OscMessage

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.osc.osc_frame import (
    FRAME,
    FRAME_TYPES,
    JOINT,
    JOINT_TYPES,
    MAX_INSTANCE_BYTES,
    FrameBundles,
)
from mocapd.outputs.wire import Joint
from tests.outputs.frames import small_frame, whole_frame
from tests.outputs.osc_packets import bundle, message

ONE, HALF, QUARTER = b"\x3f\x80\0\0", b"\x3f\x00\0\0", b"\x3e\x80\0\0"
ZERO = b"\0\0\0\0"
UNKNOWN = b"\xbf\x80\0\0"  # -1, of an uncertainty

ANY_TEXT = st.text(st.characters())  # also NUL and lone surrogates

GOLDEN_FRAME = b"".join(
    [
        b"/mocapd/v1/frame\0\0\0\0,iiiiiiifssss\0\0\0",
        ZERO,  # person
        b"\0\0\0\x07",  # seq
        ZERO + b"\0\0\0\x01",  # part 0 of 1
        b"\0\0\0\x02",  # joints
        b"\x65\x53\xf1\x05" + b"\0\0\0\x7b",  # 1_700_000_005 s and 123 ns
        b"\x3c\x80\0\0",  # 1/64 s
        b"live\0\0\0\0colour\0\0left,right\0\0pc\0\0",
    ]
)
GOLDEN_HIPS = b"".join(
    [
        b"/mocapd/v1/joint/hips\0\0\0,fffffffffffff\0\0",
        QUARTER + ONE + b"\xbf\x00\0\0",
        ZERO * 3 + ONE,
        ZERO * 3 + ONE,
        ONE,
        UNKNOWN,
    ]
)
GOLDEN_ARM = b"".join(
    [
        b"/mocapd/v1/joint/leftUpperArm\0\0\0,fffffffffffff\0\0",
        HALF + b"\x3f\xc0\0\0" + b"\xbf\x00\0\0",
        ZERO * 2 + b"\x3f\x40\0\0" + b"\x3f\x20\0\0",
        HALF * 4,
        b"\x3e\x00\0\0",
        UNKNOWN,
    ]
)
GOLDEN_BUNDLE = b"#bundle\0\0\0\0\0\0\0\0\x01" + b"".join(
    struct.pack(">i", len(element)) + element for element in (GOLDEN_FRAME, GOLDEN_HIPS, GOLDEN_ARM)
)


def decoded(datagram: bytes | bytearray) -> list[OscMessage]:
    """The messages of a bundle, by python-osc."""
    return list(OscBundle(bytes(datagram)))


def test_a_frame_is_these_bytes() -> None:
    frame = small_frame()
    assert [bytes(d) for d in FrameBundles(frame).fill(frame)] == [GOLDEN_BUNDLE]


def test_a_layout_made_from_another_frame_of_the_shape_gives_the_same_bytes() -> None:
    joints = {name: Joint((9.0,) * 3, (9.0,) * 4, (9.0,) * 4, 9.0) for name in small_frame().joints}
    layout = FrameBundles(small_frame(seq=99, person=5, joints=joints))
    layout.fill(small_frame(seq=99, joints=joints))
    assert [bytes(d) for d in layout.fill(small_frame())] == [GOLDEN_BUNDLE]


def test_an_independent_decoder_reads_the_whole_body() -> None:
    frame = whole_frame(seq=2**31 + 5)
    datagrams = FrameBundles(frame).fill(frame)
    seen: dict[str, list[float]] = {}
    for part, datagram in enumerate(datagrams):
        assert len(datagram) <= osc.MAX_DATAGRAM_BYTES
        head, *joints = decoded(datagram)
        assert head.address == "/mocapd/v1/frame"
        person, seq, which, parts, count, second, nanosecond, latency_s, *strings = head.params
        assert (person, seq, which, parts, count) == (0, 5, part, len(datagrams), 22)
        assert second * 1_000_000_000 + nanosecond == frame.capture_unix_ns
        assert latency_s == 1 / 64
        assert strings == ["live", "colour", "left,right", "pc"]
        seen |= {m.address.removeprefix("/mocapd/v1/joint/"): m.params for m in joints}
    assert list(seen) == list(frame.joints)
    for name, joint in frame.joints.items():
        u = -1.0 if joint.u is None else joint.u
        assert seen[name] == pytest.approx([*joint.p, *joint.r, *joint.l, joint.c, u], abs=1e-6)


def test_the_body_takes_two_datagrams_of_about_the_same_size() -> None:
    frame = whole_frame()
    sizes = [len(d) for d in FrameBundles(frame).fill(frame)]
    assert len(sizes) == 2
    assert max(sizes) - min(sizes) < 120


@given(st.integers(260, 2600))
def test_any_limit_is_kept_and_no_joint_lost(limit_bytes: int) -> None:
    frame = whole_frame()
    datagrams = FrameBundles(frame, limit_bytes).fill(frame)
    assert all(len(datagram) <= limit_bytes for datagram in datagrams)
    names = [m.address.rpartition("/")[2] for d in datagrams for m in decoded(d)[1:]]
    assert names == list(frame.joints)


def test_lost_is_one_short_datagram() -> None:
    frame = small_frame(tracking="lost", joints={}, cameras=())
    (datagram,) = FrameBundles(frame).fill(frame)
    (head,) = decoded(datagram)
    assert head.params[3:5] == [1, 0]
    assert head.params[8] == "lost"


def test_many_long_camera_names_still_fit() -> None:
    frame = whole_frame()
    cameras = tuple(f"camera-over-the-garage-door-{i}" for i in range(100))
    many = small_frame(joints=frame.joints, cameras=cameras)
    assert all(len(d) <= osc.MAX_DATAGRAM_BYTES for d in FrameBundles(many).fill(many))


@given(ANY_TEXT, ANY_TEXT, ANY_TEXT, st.lists(ANY_TEXT), st.lists(ANY_TEXT, unique=True))
@example("live", "colour", "x" * 1300, ["left"], ["hips"])
@example("live", "colour", "\U0001f600" * 2000, ["\udcff\0"], ["hips"])
@example("live" * 999, "colour" * 999, "", ["c" * 9999], ["j" * 9999])
def test_whatever_a_frame_says_it_fits_its_datagrams(
    tracking: str, tracker: str, instance: str, cameras: list[str], joints: list[str]
) -> None:
    joint = next(iter(small_frame().joints.values()))
    frame = small_frame(
        tracking=tracking,
        tracker=tracker,
        instance=instance,
        cameras=tuple(cameras),
        joints=dict.fromkeys(joints, joint),
    )
    datagrams = FrameBundles(frame).fill(frame)
    assert all(len(datagram) <= osc.MAX_DATAGRAM_BYTES for datagram in datagrams)
    messages = [decoded(datagram) for datagram in datagrams]
    assert sum(len(each) - 1 for each in messages) == len(joints)
    assert all(each[0].params[4] == len(joints) for each in messages)
    assert all(each[-1].params[11] == joint.c for each in messages if len(each) > 1)


@pytest.mark.parametrize(
    ("text", "max_bytes", "expected"),
    [
        ("left", 9, "left"),
        ("left", 2, "le"),
        ("äöü", 3, "ä"),
        ("a\U0001f600", 4, "a"),
        ("a\0\udcff", 9, "a??"),
    ],
)
def test_texts_are_shortened_between_characters(text: str, max_bytes: int, expected: str) -> None:
    assert osc.truncate_utf8(text, max_bytes) == expected


@given(st.lists(st.floats(width=32, allow_nan=False), min_size=13, max_size=13), ANY_TEXT)
def test_overwritten_numbers_are_byte_for_byte_what_python_osc_builds(
    numbers: list[float], instance: str
) -> None:
    px, py, pz, rx, ry, rz, rw, lx, ly, lz, lw, c, u = numbers
    joint = Joint((px, py, pz), (rx, ry, rz, rw), (lx, ly, lz, lw), c, u)
    frame = small_frame(instance=instance, joints=dict.fromkeys(("hips", "leftUpperArm"), joint))
    head = (0, 7, 0, 1, 2, 1_700_000_005, 123, 1 / 64, "live", "colour", "left,right")
    expected = bundle(
        [
            message(FRAME, FRAME_TYPES, *head, osc.truncate_utf8(instance, MAX_INSTANCE_BYTES)),
            *(message(JOINT + name, JOINT_TYPES, *numbers) for name in frame.joints),
        ]
    )
    assert [bytes(d) for d in FrameBundles(small_frame(instance=instance)).fill(frame)] == [
        expected
    ]


@pytest.mark.parametrize("types", ["f", "sf", "ssi", "iifss", "sssssff"])
def test_the_first_number_is_found_behind_the_strings_before_it(types: str) -> None:
    values: dict[str, osc.Argument] = {"s": "äbc", "i": 7, "f": 7.0}
    element = osc.message("/some/address", types, *(values[kind] for kind in types))
    kind = types.lstrip("s")[0]
    assert struct.unpack_from(f">{kind}", element.dgram, osc.numbers_offset(element)) == (7,)
