"""The bones of a `.vrm` avatar, VRM 0.x or 1.0: a binary glTF whose JSON names the nodes that are bones.

Only the JSON is read, not the meshes and pictures behind it. Sources: glTF 2.0 specification
(GLB, nodes); vrm-c/vrm-specification `specification/0.0` and
`specification/VRMC_vrm-1.0/humanoid.md`.
"""

import struct
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from mocapd.boundary.files import read_beginning
from mocapd.boundary.parsing import decode_json
from mocapd.errors import InputError, MalformedError
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.outputs.vmc.bone_names import vrm1_name
from mocapd.outputs.vmc.vrm_bones import VrmNode, avatar_of_nodes

MOST_JSON_BYTES = 16_000_000  # a large avatar has 5 MB
_MOST_NODES = 30_000
# Counted before parsing; a large avatar has a tenth of that.
_MOST_OBJECTS, _MOST_COMMAS = 400_000, 4_000_000
FIX = "export the avatar as VRM 0.x or 1.0, for example with UniVRM or the VRM add-on of Blender"

# magic, version, total length; length and kind of the first chunk
_HEADER = struct.Struct("<4sIIII")
_MAGIC, _JSON = b"glTF", 0x4E4F534A
_VERSION = 2


class _Bone0(msgspec.Struct):
    bone: str
    node: int


class _Humanoid0(msgspec.Struct):
    humanBones: Annotated[tuple[_Bone0, ...], Meta(max_length=1000)] = ()  # noqa: N815 (the file's key)


class _Vrm0(msgspec.Struct):
    humanoid: _Humanoid0 | None = None


class _Bone1(msgspec.Struct):
    node: int


class _Humanoid1(msgspec.Struct):
    humanBones: Annotated[dict[str, _Bone1], Meta(max_length=1000)] = {}  # noqa: N815 (the file's key; msgspec copies it)


class _Vrm1(msgspec.Struct):
    humanoid: _Humanoid1 | None = None


class _Extensions(msgspec.Struct):
    VRM: _Vrm0 | None = None
    VRMC_vrm: _Vrm1 | None = None


class _Document(msgspec.Struct):
    nodes: Annotated[tuple[VrmNode, ...], Meta(max_length=_MOST_NODES)] = ()
    extensions: _Extensions = msgspec.field(default_factory=_Extensions)


def read_vrm(path: Path) -> Avatar:
    """The avatar's bones in the T-pose, facing +Z. Raises InputError naming the file, what is wrong and the mend."""
    try:
        document = decode_json(_json_chunk(path), _Document)
    except MalformedError as error:
        raise InputError(f"is no VRM avatar ({error.what})", str(path), FIX) from None
    extensions = document.extensions
    try:
        if extensions.VRMC_vrm is not None and extensions.VRMC_vrm.humanoid is not None:
            bones1 = extensions.VRMC_vrm.humanoid.humanBones
            bones = {name: bone.node for name, bone in bones1.items()}
            return avatar_of_nodes(document.nodes, bones)
        if extensions.VRM is not None and extensions.VRM.humanoid is not None:
            bones = {vrm1_name(b.bone): b.node for b in extensions.VRM.humanoid.humanBones}
            # VRM 0.x avatars face -Z
            return avatar_of_nodes(document.nodes, bones, faces_back=True)
    except MalformedError as error:
        raise InputError(error.what, str(path), FIX) from None
    raise InputError("is a glTF model without a humanoid", str(path), FIX)


def _json_chunk(path: Path) -> bytes:
    header = read_beginning(path, _HEADER.size)
    if len(header) < _HEADER.size or not header.startswith(_MAGIC):
        raise InputError("is no .vrm: not a binary glTF", str(path), FIX)
    _, version, _, length, kind = _HEADER.unpack(header)
    if version != _VERSION or kind != _JSON:
        raise InputError(f"is a glTF of version {version}, not {_VERSION}", str(path), FIX)
    if length > MOST_JSON_BYTES:
        raise InputError(
            f"its JSON is larger than {MOST_JSON_BYTES / 1e6:g} MB", str(path), "is it an avatar?"
        )
    data = read_beginning(path, _HEADER.size + length)[_HEADER.size :]
    if len(data) < length:
        raise InputError("ends within its JSON", str(path), "copy it again, it was cut off")
    if data.count(b"{") > _MOST_OBJECTS or data.count(b",") > _MOST_COMMAS:
        raise InputError("its JSON has more parts than any avatar", str(path), FIX)
    return data
