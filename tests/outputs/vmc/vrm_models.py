"""Avatars as `.vrm` files, and a Unity that has loaded them: written without mocapd's own reader.

UniVRM turns z round in a VRM 0.x, whose avatar faces -Z, and x in a VRM 1.0, whose avatar faces +Z; in Unity both face +Z.
"""

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.body.skeleton import standard_skeleton
from mocapd.outputs.vmc.bone_names import unity_name
from mocapd.types import Floats
from tests.outputs.receivers.humanoid import Quaternion, Transform, Vector, multiply, rotated

STATURE_M = 1.4  # of the avatar
UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)
_THUMBS = {"leftThumbMetacarpal": "leftThumbProximal", "leftThumbProximal": "leftThumbIntermediate"}


@dataclass(frozen=True)
class Node:
    """above: the name of the node above it; at and turn: relative to it; scale: uniform."""

    above: str | None
    at: Vector
    turn: Quaternion = UPRIGHT
    scale: float = 1.0


@dataclass(frozen=True)
class Model:
    """Nodes by name, those above first, in the axes of the file; the bones are the nodes that are called like them."""

    nodes: Mapping[str, Node]
    version: int

    @property
    def bones(self) -> list[str]:
        return [name for name in self.nodes if name in NAMES or "Thumb" in name]

    def document(self) -> dict[str, object]:
        """The glTF JSON."""
        order = list(self.nodes)
        nodes = [
            {
                "name": name,
                "translation": list(node.at),
                "rotation": list(node.turn),
                "scale": [node.scale] * 3,
                "children": [k for k, one in enumerate(order) if self.nodes[one].above == name],
            }
            for name, node in self.nodes.items()
        ]
        places = {bone: order.index(bone) for bone in self.bones}
        extensions: dict[str, object] = {
            "VRMC_vrm": {
                "specVersion": "1.0",
                "humanoid": {"humanBones": {bone: {"node": k} for bone, k in places.items()}},
            }
        }
        if self.version == 0:
            bones = [
                {"bone": _THUMBS.get(bone, bone), "node": k, "useDefaultValues": True}
                for bone, k in places.items()
            ]
            extensions = {"VRM": {"exporterVersion": "x", "humanoid": {"humanBones": bones}}}
        return {
            "asset": {"version": "2.0"},
            "nodes": nodes,
            "extensionsUsed": list(extensions),
            "extensions": extensions,
        }

    def in_unity(self) -> dict[str, Node]:
        """As UniVRM loads it."""
        return {
            name: replace(
                node, at=_flipped(node.at, self.version), turn=_turned(node.turn, self.version)
            )
            for name, node in self.nodes.items()
        }


def glb(document: object) -> bytes:
    """A binary glTF with this JSON and a chunk of meshes behind it."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    meshes = struct.pack("<II", 16, 0x004E4942) + bytes(16)
    length = 12 + 8 + len(text) + len(meshes)
    return struct.pack("<4sIIII", b"glTF", 2, length, len(text), 0x4E4F534A) + text + meshes


def write_vrm(path: Path, model: Model) -> Path:
    path.write_bytes(glb(model.document()))
    return path


def model(
    version: int = 1,
    *,
    without: tuple[str, ...] = (),
    top: Node | None = None,
    turns: Mapping[str, Quaternion] | None = None,
    between: tuple[str, ...] = (),
) -> Model:
    """An avatar of mean proportions in the T-pose; with a node above the hips, its bones' own axes turned, and above some
    bones a node that is none."""
    rest_m = dict(zip(NAMES, standard_skeleton(STATURE_M).rest_m, strict=True))
    if version == 0:
        rest_m = {name: at_m * (-1.0, 1.0, -1.0) for name, at_m in rest_m.items()}
    nodes: dict[str, Node] = {"Armature": top or Node(None, (0.0, 0.0, 0.0))}
    for name in NAMES:
        if name in without:
            continue
        above = PARENT_OF.get(name, "Armature")
        while above in without:
            above = PARENT_OF[above]
        if name in between:
            nodes[f"{name}Holder"] = Node(above, (0.02, 0.03, -0.01), (0.0, 0.6, 0.0, 0.8))
            above = f"{name}Holder"
        nodes[name] = Node(
            above, _within(nodes, above, rest_m[name]), (turns or {}).get(name, UPRIGHT)
        )
    return Model(nodes, version)


def world(nodes: Mapping[str, Node]) -> dict[str, tuple[Transform, float]]:
    """Of each node where it is, how it is turned, and its scale."""
    out: dict[str, tuple[Transform, float]] = {}
    for name, node in nodes.items():
        (at, turn), scale = out[node.above] if node.above else (((0.0, 0.0, 0.0), UPRIGHT), 1.0)
        x, y, z = rotated(turn, (node.at[0] * scale, node.at[1] * scale, node.at[2] * scale))
        placed = (at[0] + x, at[1] + y, at[2] + z)
        out[name] = (placed, multiply(turn, node.turn)), scale * node.scale
    return out


def posed_in_unity(loaded: Model, told: Mapping[str, Transform]) -> dict[str, Floats]:
    """Where each bone is in mocapd's world and, beside it, a point on it (`<bone>+`), when Unity sets the local positions and
    rotations that were told by Unity's names."""
    nodes = loaded.in_unity()
    for bone in loaded.bones:
        if unity_name(bone) in told:
            at, turn = told[unity_name(bone)]
            nodes[bone] = replace(nodes[bone], at=at, turn=turn)
    found = {}
    for name, ((at, turn), _) in world(nodes).items():
        point = rotated(turn, _flipped(POINT, loaded.version))
        found[name] = np.array(at) * (-1.0, 1.0, 1.0)
        found[f"{name}+"] = (np.array(at) + point) * (-1.0, 1.0, 1.0)
    return found


POINT: Vector = (0.05, 0.1, -0.02)  # on a bone, in its own axes in the file [m]


def _within(nodes: Mapping[str, Node], above: str, at_m: Floats) -> Vector:
    """A place in the world, relative to a node."""
    ((origin, (x, y, z, w)), scale) = world(nodes)[above]
    dx, dy, dz = rotated((-x, -y, -z, w), tuple((at_m - origin).tolist()))
    return dx / scale, dy / scale, dz / scale


def _flipped(at: Vector, version: int) -> Vector:
    x, y, z = at
    return (x, y, -z) if version == 0 else (-x, y, z)


def _turned(turn: Quaternion, version: int) -> Quaternion:
    x, y, z, w = turn
    return (-x, -y, z, w) if version == 0 else (x, -y, -z, w)
