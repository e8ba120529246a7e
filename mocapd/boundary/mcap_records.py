"""Reads MCAP files sequentially, also truncated or damaged ones.

The reader of the `mcap` library wants the index at the file's end, and takes what a length says for granted: a
file of 60 bytes may ask it for 4 GB. Here every length is compared with the file first, and what a chunk says
it holds with a limit, before anything is unpacked. Records: https://mcap.dev/spec
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, TypeVar

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Schema
from mcap.writer import MCAP0_MAGIC

from mocapd.boundary.files import is_absent, is_file
from mocapd.errors import InputError, MalformedError

MOST_RECORD_BYTES = 32 << 20  # ours are some MB at most
MOST_CHANNELS = 4096
_MOST_CHANNEL_BYTES = 1 << 16
_LONGEST_NAME = 1000  # characters

# What the chunks may hold together, by the bytes of the file so far: pictures that repeat shrink to a 250th, frames without
# a person to 11 bytes each.
_MOST_SWELLING, _ALWAYS_BYTES = 500, MOST_RECORD_BYTES
_BYTES_A_MESSAGE, _ALWAYS_MESSAGES = 8, 20_000

_HEAD = struct.Struct("<BQ")  # opcode, length of what follows
# channel, sequence, time of log and of publication; then the data
_MESSAGE = struct.Struct("<HIQQ")
_LATEST_NS = 2**63 - 1
# Exceptions of the library's record parsers on malformed input.
_BAD_RECORD = (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError, MemoryError)

R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class McapMessage:
    """One message: its channel's topic and encoding, its schema's name, its time [ns, Unix time in files of ours]."""

    topic: str
    schema: str
    encoding: str
    log_ns: int
    sequence: int
    data: bytes


@dataclass(frozen=True, slots=True)
class McapAttachment:
    """An attached file."""

    name: str
    media_type: str
    data: bytes


Item = McapMessage | McapAttachment
Wanted = Callable[[str, str], bool]  # topic and schema of a channel


class McapFile:
    """Reads a file sequentially. `ending` and `damaged` are valid after the end of `items`.

    ending: empty for a complete file, else the reason of an early end; damaged: number of skipped damaged chunks.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.ending = ""
        self.damaged = 0
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, tuple[str, str, int]] = {}  # topic, encoding, schema
        self._unpacked_bytes = self._unpacked_records = 0

    def items(self, wanted: Wanted) -> Iterator[Item]:
        """Attachments, and messages of `wanted` channels, in file order.

        Raises InputError if it is no MCAP file.
        """
        self.ending, self.damaged = "", 0
        self._unpacked_bytes = self._unpacked_records = 0
        with _open_file(self.path) as file:
            size = self.path.stat().st_size
            if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                raise InputError(
                    "is no MCAP file", str(self.path), "give a file of `mocapd record`"
                )
            for opcode, body in self._records(file, size):
                try:
                    yield from self._read(opcode, body, wanted, file.tell())
                except MalformedError:
                    self.damaged += 1

    def _records(self, file: BinaryIO, size: int) -> Iterator[tuple[int, bytes]]:
        """Opcode and content of each record of the data section; sets `ending`."""
        while True:
            head = file.read(_HEAD.size)
            if len(head) < _HEAD.size:
                self.ending = "it was not closed: what was written last is missing"
                return
            opcode, length = _HEAD.unpack(head)
            if length > size - file.tell():
                self.ending = "it is cut short within a record, which is left out"
                return
            if length > MOST_RECORD_BYTES:
                self.ending = f"a record of {length / 1e6:.0f} MB is left out, and what follows it"
                return
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return
            if opcode in _READ:
                yield opcode, file.read(length)
            else:
                file.seek(length, 1)

    def _read(self, opcode: int, body: bytes, wanted: Wanted, so_far: int) -> Iterator[Item]:
        """Parses a record. so_far: bytes read of the file. Raises MalformedError."""
        if opcode == Opcode.ATTACHMENT:
            file = _parse_record(Attachment.read, body)
            yield McapAttachment(file.name, file.media_type, file.data)
        elif opcode == Opcode.CHUNK:
            chunk = _parse_record(Chunk.read, body)
            together = self._unpacked_bytes + chunk.uncompressed_size
            if together > _ALWAYS_BYTES + _MOST_SWELLING * so_far:
                raise MalformedError("a chunk says that it holds far more than its size allows")
            self._unpacked_bytes = together
            for inner, content in _split(memoryview(_decompress(chunk))):
                self._unpacked_records += 1
                if self._unpacked_records > _ALWAYS_MESSAGES + so_far // _BYTES_A_MESSAGE:
                    raise MalformedError("a chunk has far more messages than its size allows")
                yield from self._read_inner(inner, content, wanted)
        else:
            yield from self._read_inner(opcode, memoryview(body), wanted)

    def _read_inner(self, opcode: int, body: memoryview, wanted: Wanted) -> Iterator[McapMessage]:
        if opcode == Opcode.SCHEMA:
            schema = _parse_record(Schema.read, body)
            _with_room(self._schemas)[schema.id] = _name(schema.name)
        elif opcode == Opcode.CHANNEL:
            if len(body) > _MOST_CHANNEL_BYTES:  # its metadata map is parsed entry by entry
                raise MalformedError("says too much of a channel")
            channel = _parse_record(Channel.read, body)
            entry = _name(channel.topic), _name(channel.message_encoding), channel.schema_id
            _with_room(self._channels)[channel.id] = entry
        elif opcode == Opcode.MESSAGE:
            if len(body) < _MESSAGE.size:
                raise MalformedError("a record is damaged")
            number, sequence, log_ns, _ = _MESSAGE.unpack_from(body)
            channel = self._channels.get(number)
            if channel is None:
                raise MalformedError("holds a message of no channel")
            if log_ns > _LATEST_NS:
                raise MalformedError("holds a message of no possible time")
            topic, encoding, schema_id = channel
            name = self._schemas.get(schema_id, "")
            if wanted(topic, name):
                data = bytes(body[_MESSAGE.size :])
                if not data:
                    raise MalformedError("holds a message of nothing")
                yield McapMessage(topic, name, encoding, log_ns, sequence, data)


_READ = frozenset({Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK, Opcode.ATTACHMENT})


def _open_file(path: Path) -> BinaryIO:
    if not is_file(path):
        what = "no such recording" if is_absent(path) else "is no regular file"
        raise InputError(what, str(path), "check the path")
    try:
        return path.open("rb")
    except OSError as error:
        raise InputError(
            f"cannot be read ({error.strerror})", str(path), "check the path and its rights"
        ) from None


def _parse_record(read: Callable[[ReadDataStream], R], body: bytes | memoryview) -> R:
    try:
        return read(ReadDataStream(BytesIO(body)))
    except _BAD_RECORD as error:
        raise MalformedError(f"a record is damaged ({type(error).__name__})") from None


def _name(text: str) -> str:
    if len(text) > _LONGEST_NAME:
        raise MalformedError("has a name that is too long")
    return text


def _with_room(table: dict[int, R]) -> dict[int, R]:
    if len(table) >= MOST_CHANNELS:
        raise MalformedError("has too many channels")
    return table


def _decompress(chunk: Chunk) -> bytes:
    """The records of a chunk, bounded in size and verified by checksum."""
    size = chunk.uncompressed_size
    if size > MOST_RECORD_BYTES:
        raise MalformedError("a chunk says that it is too large")
    try:
        if chunk.compression == "zstd":
            # the library ignores its size limit when the frame declares a size
            if zstandard.get_frame_parameters(chunk.data).content_size != size:
                raise MalformedError("a chunk is of another size than it says")
            data = zstandard.ZstdDecompressor().decompress(chunk.data)
        elif chunk.compression == "lz4":
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size)
        elif not chunk.compression:
            data = chunk.data
        else:
            raise MalformedError(f"a chunk is packed by {chunk.compression[:20]!r}")
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise MalformedError(f"a chunk cannot be unpacked ({error})") from None
    if len(data) != size or (chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc):
        raise MalformedError("a chunk is damaged")
    return bytes(data)


def _split(data: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Opcode and content of the records in a chunk."""
    at = 0
    while at < len(data):
        if at + _HEAD.size > len(data):
            raise MalformedError("a chunk ends within a record")
        opcode, length = _HEAD.unpack_from(data, at)
        at += _HEAD.size
        if length > len(data) - at:
            raise MalformedError("a chunk ends within a record")
        yield opcode, data[at : at + length]
        at += length
