"""Motion as an animated skeleton in a GLB file, glTF 2.0 in one piece.

Metres; glTF's axes are ours (right-handed, +Y up, a model faces +Z). Each bone is a node whose rotation and place
are animated, in the T-pose where nothing plays; a skin names them as joints. The few records of the format are
written here: pygltflib would bring four packages of older make along for them.
"""

import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import mocapd
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.types import Floats

_MAGIC, _VERSION = b"glTF", 2
_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942
_FLOAT32 = 5126
_MOST_BYTES = 2**32 - 1  # of the whole file, whose header counts them in 32 bits
_DOCUMENT_BYTES = 4096  # at most: what is not of a frame, of the file as a whole and of each joint
_DISTINCT_TIMES = 2**23  # times must rise, which 32-bit floats of equal steps do up to here
_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


@dataclass(slots=True)
class _Buffer:
    """What the accessors lead to."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, int]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, values: Floats) -> int:
        """Rows (N,n) as an accessor; its number."""
        rows = np.ascontiguousarray(values, dtype="<f4").reshape(len(values), -1)
        width = rows.shape[1]
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": rows.nbytes})
        self.data += rows.tobytes()
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": _FLOAT32,
            "count": len(rows),
            "type": _TYPES[width],
        }
        if width == 1:  # of times, which must say their range
            accessor |= {"min": [float(rows.min())], "max": [float(rows.max())]}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def most_glb_frames(joints: int) -> int:
    """How many frames a file can hold."""
    of_frame = 4 * (1 + joints * (4 + 3))
    return min(_DISTINCT_TIMES, (_MOST_BYTES - _DOCUMENT_BYTES * (1 + joints)) // of_frame)


def write_glb(motion: SampledMotion, path: Path) -> None:
    """Write the file. Raises OSError."""
    path.write_bytes(glb_bytes(motion))


def frames_in_glb(path: Path) -> int:
    """How many frames a file of ours holds; 0 where it is cut short."""
    with path.open("rb") as file:
        _, _, length, size, _ = struct.unpack("<4sIIII", file.read(20))
        document = json.loads(file.read(size))
        if file.seek(0, 2) < length:
            return 0
    times: int = document["animations"][0]["samplers"][0]["input"]
    count: int = document["accessors"][times]["count"]
    return count


def glb_bytes(motion: SampledMotion) -> bytes:
    """The whole file."""
    skeleton, offsets_m, buffer = motion.skeleton, motion.offsets_m, _Buffer()
    children = [np.flatnonzero(skeleton.parents == j).tolist() for j in range(len(skeleton.names))]
    nodes = [
        {"name": name, "translation": offsets_m[j].tolist(), "rotation": [0.0, 0.0, 0.0, 1.0]}
        | ({"children": children[j]} if children[j] else {})
        for j, name in enumerate(skeleton.names)
    ]
    (root,) = np.flatnonzero(skeleton.parents < 0).tolist()
    inverse_bind = np.tile(np.eye(4), (len(nodes), 1, 1))
    inverse_bind[:, 3, :3] = -skeleton.rest_m  # by columns, as glTF has matrices
    document = {
        "asset": {"version": "2.0", "generator": f"mocapd {mocapd.__version__}"},
        "scene": 0,
        "scenes": [{"nodes": [root]}],
        "nodes": nodes,
        "skins": [
            {
                "joints": list(range(len(nodes))),
                "skeleton": root,
                "inverseBindMatrices": buffer.add(inverse_bind.reshape(len(nodes), 16)),
            }
        ],
        "animations": [_animation(motion, buffer)],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    return _packed(json.dumps(document, separators=(",", ":")).encode(), bytes(buffer.data))


def _animation(motion: SampledMotion, buffer: _Buffer) -> dict[str, Any]:
    times = buffer.add(motion.times_s[:, None])
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for path, values in (
        ("rotation", _continuous(motion.local_xyzw)),
        ("translation", motion.local_positions_m),
    ):
        for joint in range(len(motion.skeleton.names)):
            channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
            samplers.append(
                {"input": times, "output": buffer.add(values[:, joint]), "interpolation": "LINEAR"}
            )
    return {"name": "mocapd", "samplers": samplers, "channels": channels}


def _continuous(quats_xyzw: Floats) -> Floats:
    """The same rotations (F,J,4), each of the sign that is nearer to the one before: players mix neighbours."""
    turns = np.sign(np.vecdot(quats_xyzw[1:], quats_xyzw[:-1]))
    signs = np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=0)
    out = quats_xyzw.copy()
    out[1:] *= signs[..., None]
    return out


def _packed(document: bytes, data: bytes) -> bytes:
    document += b" " * (-len(document) % 4)
    data += b"\0" * (-len(data) % 4)
    length = 12 + 8 + len(document) + 8 + len(data)
    return b"".join(
        [
            struct.pack("<4sII", _MAGIC, _VERSION, length),
            struct.pack("<II", len(document), _JSON_CHUNK) + document,
            struct.pack("<II", len(data), _BIN_CHUNK) + data,
        ]
    )
