"""Makes an avatar of a glTF model's nodes and the indices of its bones. Pure; checks everything."""

from collections.abc import Mapping, Sequence
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from mocapd.errors import MalformedError
from mocapd.geometry import rotations
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.outputs.wire import Quaternion, Vector
from mocapd.types import Floats

# Required bones of a humanoid, in both versions
REQUIRED = (
    "hips", "spine", "head",
    *(
        side + bone
        for side in ("left", "right")
        for bone in ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "LowerArm", "Hand")
    ),
)  # fmt: skip

_MOST = 1e4  # of any number of a node; in metres, and scaled by 100 at the most
_MOST_ABOVE = 500  # nodes above one bone; real avatars have some dozens
_LEAST_HEIGHT_M = 0.05  # of hips above the floor; translations are scaled by it
_STRAIGHT = 1.0 - 1e-12  # cosine of half an angle of a millionth [rad]
_ABOUT_XYZ = np.array([-1.0, 1.0, -1.0])  # half a turn about +Y
_ABOUT_XYZW = np.array([-1.0, 1.0, -1.0, 1.0])
_ABOUT = np.diag([-1.0, 1.0, -1.0, 1.0])

_Matrix = Annotated[tuple[float, ...], Meta(min_length=16, max_length=16)]


class VrmNode(msgspec.Struct, frozen=True):
    """A node of glTF: translation, rotation (xyzw) and scale, or all three as a matrix by columns."""

    children: tuple[int, ...] = ()
    # no limits here: `_pose` checks them
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    matrix: _Matrix | None = None

    def faced_about(self) -> "VrmNode":
        """The node in a world rotated by half a turn about +Y."""
        matrix = None
        if self.matrix is not None:
            own = np.array(self.matrix).reshape(4, 4)
            matrix = tuple((_ABOUT @ own @ _ABOUT).ravel().tolist())
        x, y, z = (np.array(self.translation) * _ABOUT_XYZ).tolist()
        rotation = (np.array(self.rotation) * _ABOUT_XYZW).tolist()
        return VrmNode(self.children, (x, y, z), tuple(rotation), self.scale, matrix)


def avatar_of_nodes(
    nodes: Sequence[VrmNode], bones: Mapping[str, int], faces_back: bool = False
) -> Avatar:
    """The avatar whose bones, by VRM 1.0 name, are these nodes; faces_back: it faces -Z. Raises MalformedError."""
    missing = [name for name in REQUIRED if name not in bones]
    if missing:
        raise MalformedError(f"its humanoid has no {', '.join(missing)}")
    for name, node in bones.items():
        if not 0 <= node < len(nodes):
            raise MalformedError(f"its bone {name[:40]!r} is node {node}, of {len(nodes)}")
    if len(set(bones.values())) < len(bones):
        raise MalformedError("two bones of its humanoid are the same node")
    above = _parents(nodes)
    bone_of = {node: name for name, node in bones.items()}
    lines = {name: _line(above, node) for name, node in bones.items()}
    # sorted by depth: parents before their children
    names = tuple(sorted(bones, key=lambda name: (name != "hips", len(lines[name]))))
    place = {name: k for k, name in enumerate(names)}
    parents = []
    for name in names:
        parent = next((bone_of[node] for node in lines[name][1:] if node in bone_of), None)
        if (parent is None) != (name == "hips"):
            raise MalformedError(f"its bone {name[:40]!r} is not below its hips")
        parents.append(-1 if parent is None else place[parent])
    used = {node for line in lines.values() for node in line}
    poses = {node: _pose(nodes[node].faced_about() if faces_back else nodes[node]) for node in used}
    hips_above = _compose_matrices([poses[node] for node in lines["hips"][1:]])
    hips_m = (hips_above @ poses[bones["hips"]][0])[:3, 3]
    if hips_m[1] < _LEAST_HEIGHT_M:
        raise MalformedError(f"its hips are {hips_m[1]:.2f} m above the floor")
    if abs(np.linalg.det(hips_above)) < 1e-12:
        raise MalformedError("a node above its hips is scaled to nothing")
    rest_xyzw = np.array(
        [_compose_rotations([poses[node] for node in lines[name]]) for name in names]
    )
    above_xyzw = np.array(
        [_compose_rotations([poses[node] for node in lines[name][1:]]) for name in names]
    )
    world_above = np.linalg.inv(hips_above)
    return Avatar(
        names,
        tuple(parents),
        tuple(map(_vector, (poses[bones[name]][0][:3, 3] for name in names))),
        tuple(map(_four, rest_xyzw)),
        tuple(map(_four, rotations.inverse(above_xyzw))),
        (_four(world_above[0]), _four(world_above[1]), _four(world_above[2])),
        float(hips_m[1]),
        is_straight=bool(min(rest_xyzw[:, 3].min(), above_xyzw[:, 3].min()) > _STRAIGHT),
    )


def _parents(nodes: Sequence[VrmNode]) -> dict[int, int]:
    above: dict[int, int] = {}
    for number, node in enumerate(nodes):
        for child in node.children:
            if not 0 <= child < len(nodes):
                raise MalformedError(f"its node {number} has the child {child}, of {len(nodes)}")
            if above.setdefault(child, number) != number:
                raise MalformedError(f"its node {child} has two parents")
    return above


def _line(above: Mapping[int, int], node: int) -> list[int]:
    """The path from the node to the root."""
    line = [node]
    visited = {node}
    while line[-1] in above:
        line.append(above[line[-1]])
        if line[-1] in visited:
            raise MalformedError(f"its node {node} is below itself")
        if len(line) > _MOST_ABOVE:
            raise MalformedError(f"its node {node} has more than {_MOST_ABOVE} nodes above it")
        visited.add(line[-1])
    return line


def _pose(node: VrmNode) -> tuple[Floats, Floats]:
    """Transform (4,4) relative to the parent node, and its rotation (4,)."""
    numbers = np.array([*node.translation, *node.rotation, *node.scale, *(node.matrix or ())])
    if not (np.abs(numbers) <= _MOST).all():  # also for NaN
        raise MalformedError("a number of its nodes is too large or none")
    matrix = np.eye(4)
    if node.matrix is None:
        if np.linalg.norm(node.rotation) < 0.5:
            raise MalformedError("a rotation of its nodes is none")
        turned = rotations.canonical(np.array(node.rotation))
        matrix[:3, :3] = rotations.to_matrix(turned) * np.array(node.scale)
        matrix[:3, 3] = node.translation
        return matrix, turned
    matrix[:3] = np.array(node.matrix).reshape(4, 4).T[:3]
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if scale.min() < 1e-9 or np.linalg.det(matrix[:3, :3]) <= 0.0:
        raise MalformedError("a matrix of its nodes is no rotation")
    return matrix, rotations.from_matrix(matrix[:3, :3] / scale)


def _compose_matrices(line: Sequence[tuple[Floats, Floats]]) -> Floats:
    """The transform (4,4) into the world along a path to the root."""
    out = np.eye(4)
    for matrix, _ in line:
        out = matrix @ out
    return out


def _compose_rotations(line: Sequence[tuple[Floats, Floats]]) -> Floats:
    """The rotation (4,) into the world along a path to the root."""
    out = rotations.IDENTITY_XYZW
    for _, turned in line:
        out = rotations.multiply(turned, out)
    return rotations.canonical(out)


def _vector(numbers: Floats) -> Vector:
    x, y, z = numbers.tolist()
    return x, y, z


def _four(numbers: Floats) -> Quaternion:
    x, y, z, w = numbers.tolist()
    return x, y, z, w
