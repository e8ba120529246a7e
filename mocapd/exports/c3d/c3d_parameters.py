"""The parameter section of a C3D file: groups of named values, little-endian, in blocks of 512 bytes.

No library writes what is needed here: ezc3d clips the count of frames to 16 bits, and has no wheel for
ARM. Layout and names by the manual at c3d.org.
"""

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats, Ints

BLOCK = 512
_PROCESSOR = 84  # Intel: little-endian integers, IEEE floats
_CHARACTERS, _INTEGERS, _FLOATS = -1, 2, 4
_MOST_ROWS = 255  # a dimension is one byte
_MOST_BYTES = 32_000  # of one value: the way to the next record is a signed 16-bit number

Value = Floats | Ints | Sequence[str]
Groups = Mapping[str, Mapping[str, Value]]


@dataclass(frozen=True, slots=True, eq=False)
class ParameterRecord:
    """One value of the file: its `kind` is -1 characters, 2 integers of 16 bits, 4 floats."""

    group: int
    name: str
    kind: int
    data: bytes

    @property
    def numbers(self) -> Floats:
        """Integers (unsigned here) or floats."""
        dtype = "<f4" if self.kind == _FLOATS else "<u2"
        return np.frombuffer(self.data, dtype).astype(float)


def pack_parameters(groups: Groups) -> bytes:
    """The whole section. Arrays of integers become unsigned 16-bit words, of floats 32-bit floats."""
    records = []
    for number, (group, values) in enumerate(groups.items(), start=1):
        records.append((_head(group, -number), b"\0"))
        records += [(_head(name, number), _body(value)) for name, value in values.items()]
    packed = [
        head + struct.pack("<h", 0 if place == len(records) else 2 + len(body)) + body
        for place, (head, body) in enumerate(records, start=1)
    ]
    section = bytes([1, 0x50, 0, _PROCESSOR]) + b"".join(packed)
    blocks = -(-len(section) // BLOCK)
    section = section[:2] + bytes([blocks]) + section[3:]
    return section.ljust(blocks * BLOCK, b"\0")


def split_rows(name: str, rows: Sequence[str]) -> dict[str, Sequence[str]]:
    """Split into NAME, NAME2 and so on, as the format does with values that are too long."""
    width = max(len(row.encode()) for row in rows)
    most = min(_MOST_ROWS, _MOST_BYTES // max(1, width))
    parts = [rows[i : i + most] for i in range(0, len(rows), most)]
    return {name + (f"{n}" if n > 1 else ""): part for n, part in enumerate(parts, start=1)}


def read_parameters(section: bytes) -> Iterator[ParameterRecord]:
    """The values of a section that `pack_parameters` made."""
    at = 4
    while at + 2 <= len(section) and section[at]:
        length, group = struct.unpack_from("<Bb", section, at)
        start = at + 2 + length
        (step,) = struct.unpack_from("<h", section, start)
        if group > 0:
            kind, dimensions = struct.unpack_from("<bB", section, start + 2)
            shape = section[start + 4 : start + 4 + dimensions]
            size = int(np.prod([*shape], dtype=int)) * abs(kind)
            data = section[start + 4 + dimensions :][:size]
            yield ParameterRecord(group, section[at + 2 : start].decode(), kind, data)
        if step == 0:
            return
        at = start + step


def _head(name: str, group: int) -> bytes:
    return struct.pack("<bb", len(name), group) + name.encode("ascii")


def _body(value: Value) -> bytes:
    """Kind, shape, data and an empty description."""
    if isinstance(value, np.ndarray):
        is_float = value.dtype.kind == "f"
        data = value.astype("<f4" if is_float else "<u2").tobytes()
        shape = () if value.ndim == 0 else value.shape
        kind = _FLOATS if is_float else _INTEGERS
    else:
        rows = [row.encode() for row in value]
        width = max((len(row) for row in rows), default=0)
        data, shape, kind = b"".join(row.ljust(width) for row in rows), (width, len(rows)), -1
    return struct.pack("<bB", kind, len(shape)) + bytes(shape) + data + b"\0"
