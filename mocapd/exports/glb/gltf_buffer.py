"""The binary part of a glTF file, and the GLB container.

The few records of the format are written here: pygltflib would add four older packages.
"""

import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mocapd

MAGIC, _VERSION = b"glTF", 2
_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942
_COMPONENTS = {"<f4": 5126, "|u1": 5121, "<u2": 5123}
_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
VERTICES, INDICES = 34962, 34963  # what a buffer view is for: ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER


@dataclass(slots=True)
class GltfBuffer:
    """The data of the accessors; each has a view of its own, aligned to four bytes."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, int]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(
        self,
        values: NDArray[Any],
        target: int | None = None,
        has_range: bool = False,
        normalized: bool = False,
    ) -> int:
        """Add rows (N,n) of float32, uint8 or uint16 as an accessor; returns its index.

        has_range: adds the minimum and maximum, as times and positions need; normalized: integers stand for 0..1.
        """
        rows = np.ascontiguousarray(values).reshape(len(values), -1)
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": rows.nbytes}
        self.views.append(view | ({} if target is None else {"target": target}))
        self.data += rows.tobytes()
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": _COMPONENTS[rows.dtype.str],
            "count": len(rows),
            "type": _TYPES[rows.shape[1]],
        }
        if has_range:
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        if normalized:
            accessor["normalized"] = True
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def glb_file(document: dict[str, Any], buffer: GltfBuffer) -> bytes:
    """A GLB file of this document with asset, accessors and buffers added."""
    document = {
        "asset": {"version": "2.0", "generator": f"mocapd {mocapd.__version__}"},
        **document,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(buffer.data) + b"\0" * (-len(buffer.data) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    return b"".join(
        [
            struct.pack("<4sII", MAGIC, _VERSION, length),
            struct.pack("<II", len(text), _JSON_CHUNK) + text,
            struct.pack("<II", len(data), _BIN_CHUNK) + data,
        ]
    )
