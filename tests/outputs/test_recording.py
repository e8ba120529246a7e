"""A recording gives back what was recorded, whatever happened to the file."""

import errno
import logging
import math
import os
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from mocapd.errors import CannotCreateError, InputError
from mocapd.geometry import rotations
from mocapd.outputs import wire
from mocapd.outputs.mcap.packed_frame import PACKED, decode_packed, encode_packed, pack, unpack
from mocapd.outputs.mcap.recording_reader import Recorded, RecordingReader
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from tests.conftest import ROOT
from tests.outputs.frames import whole_frame
from tests.outputs.recorded import HZ, cameras, farthest_m, frames, record, rest

TENTH_OF_A_MM = 1e-4


def frames_of(items: list[Recorded]) -> list[SkeletonFrame]:
    return [item for item in items if isinstance(item, SkeletonFrame)]


def test_frames_come_back_within_a_tenth_of_a_millimetre(tmp_path: Path) -> None:
    recorded = frames(1.0)
    read = frames_of(list(RecordingReader(record(tmp_path / "a.mcap", recorded)).everything()))
    assert len(read) == len(recorded)
    for before, after in zip(recorded, read, strict=True):
        assert farthest_m(before, after) < TENTH_OF_A_MM
        turned = rotations.angle_rad(
            np.array([joint.r for joint in before.joints.values()]),
            np.array([joint.r for joint in after.joints.values()]),
        )
        local = rotations.angle_rad(
            np.array([joint.l for joint in before.joints.values()]),
            np.array([joint.l for joint in after.joints.values()]),
        )
        assert max(turned.max(), local.max()) < 2e-4
        assert [joint.u for joint in after.joints.values()] == [
            joint.u for joint in before.joints.values()
        ]
        same = msgspec.structs.replace(after, joints=before.joints)
        assert same == before


def test_a_recording_of_before_there_were_uncertainties_has_none() -> None:
    packed = pack(whole_frame(), rest().names)
    assert packed is not None
    older = msgspec.msgpack.decode(encode_packed(packed))
    del older["u"]
    read = unpack(
        decode_packed(msgspec.msgpack.encode(older), f"application/msgpack;{PACKED}"), rest()
    )
    assert [joint.u for joint in read.joints.values()] == [None] * len(rest().names)


def test_strange_uncertainties_do_not_spoil_a_packed_frame() -> None:
    frame = whole_frame()
    for said, kept in (
        (None, None),
        (math.nan, None),
        (math.inf, None),
        (-1.0, 0.0),
        (1e9, 6.5534),
    ):
        joints = {
            name: msgspec.structs.replace(joint, u=said if name == "head" else joint.u)
            for name, joint in frame.joints.items()
        }
        packed = pack(msgspec.structs.replace(frame, joints=joints), rest().names)
        assert packed is not None
        read = unpack(packed, rest()).joints
        assert read["head"].u == kept
        assert read["hips"].u == frame.joints["hips"].u


def test_uncertainties_that_are_cut_short_are_damage() -> None:
    packed = pack(whole_frame(), rest().names)
    assert packed is not None
    with pytest.raises(InputError, match="as many joints"):
        unpack(msgspec.structs.replace(packed, u=packed.u[:-1]), rest())


def test_exactly_the_published_bytes_on_demand(tmp_path: Path) -> None:
    recorded = frames(0.2)
    read = frames_of(
        list(RecordingReader(record(tmp_path / "a.mcap", recorded, exact=True)).everything())
    )
    assert read == recorded


def test_a_daemon_that_comes_back_with_another_format_is_recorded_on(tmp_path: Path) -> None:
    """Its zenoh.format was changed."""
    recorded = frames(0.4)
    with RecordingWriter(tmp_path / "a.mcap", RecordingParams(exact=True), 0) as writer:
        for frame in recorded[:10]:
            writer.frame(frame, wire.encode_msgpack(frame), wire.MSGPACK_MIME)
        for frame in recorded[10:]:
            writer.frame(frame, wire.encode_json(frame), wire.JSON_MIME)
    assert list(RecordingReader(tmp_path / "a.mcap").everything()) == recorded


def test_joints_that_are_not_of_the_rest_skeleton_are_kept_as_published(tmp_path: Path) -> None:
    small = msgspec.structs.replace(whole_frame(), joints={"hips": whole_frame().joints["hips"]})
    far = msgspec.structs.replace(
        whole_frame(),
        joints={
            name: msgspec.structs.replace(joint, p=(500.0, 0.0, 0.0))
            for name, joint in whole_frame().joints.items()
        },
    )
    read = frames_of(list(RecordingReader(record(tmp_path / "a.mcap", [small, far])).everything()))
    assert read == [small, far]


def test_lost_frames_and_states_are_recorded(tmp_path: Path) -> None:
    lost = msgspec.structs.replace(whole_frame(), tracking="lost", joints={})
    items = list(RecordingReader(record(tmp_path / "a.mcap", [lost, whole_frame(1)])).everything())
    assert [item for item in items if isinstance(item, RestSkeleton)] == [rest()]
    assert [item for item in items if isinstance(item, CalibrationInfo)] == [cameras()]
    assert frames_of(items)[0] == lost


def test_a_recording_is_never_written_over(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.1))
    before = path.read_bytes()
    with pytest.raises(CannotCreateError, match="there already"):
        RecordingWriter(path, RecordingParams(), 0)
    assert path.read_bytes() == before


def test_pictures_of_people_are_private(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.1), private=True)
    assert path.stat().st_mode & 0o077 == 0


def test_the_files_index_is_as_the_format_wants_it(tmp_path: Path) -> None:
    """Read by the library's own reader, which goes by the index."""
    path = record(tmp_path / "a.mcap", frames(2.0))
    with path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        topics = {channel.topic for channel in summary.channels.values()}
        times = [message.log_time for _, _, message in reader.iter_messages("/mocapd/skeleton/0")]
    assert {"/mocapd/skeleton/0", "/tf/person0", "/tf/fixed", "/bones/person0"} <= topics
    assert len(times) == 120
    assert times == sorted(times)
    assert summary.statistics.chunk_count >= 4  # one each half second


@pytest.mark.parametrize("kept", [0.3, 0.6, 0.85])
def test_a_truncated_file_gives_what_came_before(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, kept: float
) -> None:
    path = record(tmp_path / "a.mcap", frames(10.0))
    data = path.read_bytes()
    path.write_bytes(data[: int(kept * len(data))])
    with caplog.at_level(logging.WARNING):
        read = frames_of(list(RecordingReader(path).everything()))
    assert len(read) >= 600 * kept - 60  # chunks of half a second, and the index at the end
    assert [frame.seq for frame in read] == list(range(len(read)))
    assert "cut short" in caplog.text or "not closed" in caplog.text


def test_a_damaged_chunk_is_left_out_and_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = record(tmp_path / "a.mcap", frames(5.0))
    data = bytearray(path.read_bytes())
    at = data.index(b"zstd", len(data) // 2) + 200
    data[at : at + 40] = bytes(40)
    path.write_bytes(data)
    with caplog.at_level(logging.WARNING):
        read = frames_of(list(RecordingReader(path).everything()))
    assert 240 <= len(read) < 300
    assert "1 chunks" in caplog.text


@pytest.mark.parametrize(
    "data", [b"", b"garbage" * 100, b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" + b"\x06" * 80]
)
def test_garbage_is_named(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"a\.mcap"):
        list(RecordingReader(path).everything())


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such recording"):
        list(RecordingReader(tmp_path / "none.mcap").everything())
    with pytest.raises(InputError, match="no regular file"):
        list(RecordingReader(tmp_path).everything())


def write_foreign(path: Path, schema: str, data: bytes) -> None:
    """By the library alone."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel(
            "/mocapd/skeleton/0", "msgpack", writer.register_schema(schema, "jsonschema", b"{}")
        )
        for number in range(3):
            writer.add_message(channel, number, data, number)
        writer.finish()


def test_a_foreign_file_is_named(tmp_path: Path) -> None:
    write_foreign(tmp_path / "a.mcap", "sensor_msgs/Imu", b"abc")
    with pytest.raises(InputError, match="no frame of mocapd"):
        list(RecordingReader(tmp_path / "a.mcap").everything())


def test_a_newer_schema_is_named(tmp_path: Path) -> None:
    write_foreign(tmp_path / "a.mcap", "mocapd.PackedSkeleton.v2", b"abc")
    with pytest.raises(InputError, match=r"another version.*PackedSkeleton\.v2"):
        list(RecordingReader(tmp_path / "a.mcap").everything())


def test_damaged_messages_are_left_out(tmp_path: Path) -> None:
    write_foreign(tmp_path / "a.mcap", wire.SCHEMA, b"\xc1\xc1")
    with pytest.raises(InputError, match="no frame of mocapd"):
        list(RecordingReader(tmp_path / "a.mcap").everything())


def test_a_recording_replaces_a_file_only_by_force(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_text("my notes")
    with pytest.raises(CannotCreateError, match="is there already") as caught:
        RecordingWriter(path, RecordingParams(), 0)
    assert "--force" in caught.value.fix
    assert path.read_text() == "my notes"
    recorded = frames(0.1)
    record(path, recorded, force=True)
    assert len(frames_of(list(RecordingReader(path).everything()))) == len(recorded)


BAD_NUMBERS = (math.nan, math.inf, -math.inf, 1e300, 3.5e38, -1.1e6)
BAD_PERSONS = (-1, 2**31, 2**63)


def bad_frames() -> list[SkeletonFrame]:
    """One with each number in each place of a joint, and in each whole number of the frame."""
    good = frames(0.1)[1]
    out = []
    for bad in BAD_NUMBERS:
        for changes in (
            {"p": (0.0, bad, 0.0)},
            {"r": (bad, 0.0, 0.0, 1.0)},
            {"l": (0.0, 0.0, 0.0, bad)},
            {"c": bad},
            {"u": bad},
        ):
            head = msgspec.structs.replace(good.joints["head"], **changes)
            out.append(msgspec.structs.replace(good, joints=good.joints | {"head": head}))
    out += [msgspec.structs.replace(good, person=person) for person in BAD_PERSONS]
    for name in ("capture_monotonic_ns", "capture_unix_ns", "publish_monotonic_ns"):
        out.append(msgspec.structs.replace(good, **{name: 2**63 - 1}))
    crowd = {f"bone{number}": good.joints["head"] for number in range(1000)}
    return [*out, msgspec.structs.replace(good, joints=crowd)]


def test_frames_that_no_receiver_could_take_are_left_out_and_counted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path, good, bad = tmp_path / "foreign.mcap", frames(0.1), bad_frames()
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(wire.SCHEMA, "jsonschema", b"")
        channel = writer.register_channel("/skeleton", "msgpack", schema)
        for number, frame in enumerate((good[0], *bad, good[1])):
            writer.add_message(channel, number, wire.encode_msgpack(frame), number)
        writer.finish()
    with caplog.at_level(logging.WARNING):
        read = frames_of(list(RecordingReader(path).everything()))
    assert read == [good[0], good[1]]
    assert f"0 chunks and {len(bad)} messages are damaged, and left out" in caplog.text


def test_a_disk_that_is_full_is_named(tmp_path: Path) -> None:
    full = Path("/dev/full")
    writer = RecordingWriter(tmp_path / "a.mcap", RecordingParams(), 0)
    with full.open("wb") as device:
        os.dup2(device.fileno(), writer._descriptor)
    writer.add_state(rest(), 0)
    for frame in frames(0.1):
        writer.frame(frame)
    with pytest.raises(CannotCreateError, match=r"any further.*make room.*can be read"):
        writer.flush_if_due(10**12)


def test_a_disk_that_fails_is_not_called_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_descriptor: int) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    writer = RecordingWriter(tmp_path / "a.mcap", RecordingParams(), 0)
    monkeypatch.setattr(os, "fdatasync", fail)
    with pytest.raises(CannotCreateError, match=r"any further.*check that disk.*can be read"):
        writer.flush_if_due(10**12)


@pytest.mark.parametrize("frames_before", [100, 107, 131])
def test_a_kill_costs_less_than_a_second(tmp_path: Path, frames_before: int) -> None:
    path = tmp_path / "killed.mcap"
    with subprocess.Popen(
        [sys.executable, "-m", "tests.outputs.killed_recorder", str(path)],
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    ) as recorder:
        assert recorder.stdout is not None
        for line in recorder.stdout:
            if int(line) >= frames_before:
                break
        recorder.kill()
        handed_over = int((recorder.stdout.read().split() or [line])[-1])
    read = frames_of(list(RecordingReader(path).everything()))
    assert [frame.seq for frame in read] == list(range(len(read)))
    assert (handed_over + 1 - len(read)) / HZ < 1.0


def test_a_recording_that_was_killed_at_once_is_one_without_frames(tmp_path: Path) -> None:
    path = tmp_path / "killed.mcap"
    writer = RecordingWriter(path, RecordingParams(), 0)
    left = tmp_path / "left.mcap"
    left.write_bytes(path.read_bytes())  # as it is on the disk before anything more is written
    writer.close()
    with pytest.raises(InputError, match="holds no frame of mocapd: it was not closed"):
        list(RecordingReader(left).everything())
