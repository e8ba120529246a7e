"""Small recordings that would take much work are read to where they are honest."""

import struct
from pathlib import Path

import pytest
import zstandard
from mcap.writer import MCAP0_MAGIC

from mocapd.boundary import mcap_records
from mocapd.boundary.mcap_records import McapFile, McapMessage


def record(opcode: int, body: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(body)) + body


def text(words: bytes) -> bytes:
    return struct.pack("<I", len(words)) + words


def message(data: bytes) -> bytes:
    return record(5, struct.pack("<HIQQ", 1, 0, 1, 1) + data)


def chunk(inner: bytes, size: int | None = None) -> bytes:
    packed = zstandard.ZstdCompressor().compress(inner)
    head = struct.pack("<QQQI", 0, 1, len(inner) if size is None else size, 0)
    return record(6, head + text(b"zstd") + struct.pack("<Q", len(packed)) + packed)


HEAD = (
    MCAP0_MAGIC
    + record(3, struct.pack("<H", 1) + text(b"schema") + text(b"jsonschema") + text(b""))
    + record(4, struct.pack("<HH", 1, 1) + text(b"/topic") + text(b"json") + text(b""))
)
GOOD = message(b"{}")


def read(path: Path, data: bytes) -> tuple[list[bytes], McapFile]:
    path.write_bytes(data)
    file = McapFile(path)
    found = [one.data for one in file.items(lambda *_: True) if isinstance(one, McapMessage)]
    return found, file


def test_a_chunk_that_swells_to_more_than_a_record_is_left_out(tmp_path: Path) -> None:
    bomb = chunk(message(bytes(mcap_records.MOST_RECORD_BYTES)))
    assert len(bomb) < 10_000
    found, file = read(tmp_path / "a.mcap", HEAD + bomb + chunk(GOOD))
    assert (found, file.damaged) == ([b"{}"], 1)


def test_small_chunks_do_not_swell_without_end_together(tmp_path: Path) -> None:
    zeros = bytes(16 << 20)
    found, file = read(tmp_path / "a.mcap", HEAD + chunk(message(zeros)) * 100 + chunk(GOOD))
    assert len(found) < 5
    assert file.damaged > 95


@pytest.mark.parametrize("data", [b"", b"1"])
def test_a_small_file_holds_no_million_messages(tmp_path: Path, data: bytes) -> None:
    parts = HEAD + GOOD + chunk(message(data) * 9_000) * 120
    assert len(parts) < 20_000
    found, file = read(tmp_path / "a.mcap", parts)
    assert found[0] == b"{}"
    assert 0 < len(found) < 25_000
    assert file.damaged > 100


def test_a_chunk_that_lies_about_its_size_costs_the_others_nothing(tmp_path: Path) -> None:
    found, file = read(tmp_path / "a.mcap", HEAD + chunk(GOOD, size=2**63) + chunk(GOOD))
    assert (found, file.damaged) == ([b"{}"], 1)


def test_many_messages_that_shrink_well_are_all_read(tmp_path: Path) -> None:
    """Frames without a person, in large chunks and without an index."""
    lost = b'{"schema":"mocapd.Skeleton.v1","tracking":"lost","joints":{},"seq":%06d,"t":%019d}'
    messages = [message(lost % (n, n * 33_333_333 + n * 7919 % 99_991)) for n in range(40_000)]
    parts = [chunk(b"".join(messages[k : k + 10_000])) for k in range(0, 40_000, 10_000)]
    found, file = read(tmp_path / "a.mcap", HEAD + b"".join(parts))
    assert (len(found), file.damaged) == (40_000, 0)


def test_long_names_and_remarks_are_left_out(tmp_path: Path) -> None:
    ids = range(2, 60)
    schemas = [record(3, struct.pack("<H", n) + text(bytes(1 << 20)) + text(b"") * 2) for n in ids]
    remarks = struct.pack("<I", 800_000) + text(b"") * 200_000
    channel = record(4, struct.pack("<HH", 2, 1) + text(b"/b") + text(b"json") + remarks)
    data = HEAD + b"".join(map(chunk, [*schemas, channel])) + chunk(GOOD)
    found, file = read(tmp_path / "a.mcap", data)
    assert found == [b"{}"]
    assert file.damaged == len(ids) + 1
