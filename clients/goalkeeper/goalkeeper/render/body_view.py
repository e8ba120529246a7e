"""A player's body that moves as its points do."""

import numpy as np
from panda3d.core import LMatrix4f, NodePath

from goalkeeper.core.limbs import INDEX, LimbPose
from goalkeeper.render.body_meshes import Kit, body_pieces
from goalkeeper.render.meshes import node_of
from goalkeeper.render.panda_space import to_panda
from mocapd.types import Floats, Ints

_OUT_OF_FIRST_PERSON = ("trunk", "head", "hair", "eyes", "throat")
_UP = np.array([0.0, 0.0, 1.0])


class BodyView:
    """One body in a scene."""

    def __init__(self, parent: NodePath, kit: Kit) -> None:
        self.root = parent.attachNewNode("body")
        pieces = body_pieces(kit)
        self._starts: Ints = np.array([INDEX[piece.start] for piece in pieces])
        self._ends: Ints = np.array([INDEX[piece.end] for piece in pieces])
        self._nodes = [node_of(piece.name, piece.mesh) for piece in pieces]
        for node in self._nodes:
            node.reparentTo(self.root)
        self._own = [piece.name in _OUT_OF_FIRST_PERSON for piece in pieces]

    def show(self, pose: LimbPose, first_person: bool = False) -> None:
        """Pose it, in the goal's frame. first_person: without what the eyes are in."""
        points = to_panda(pose.points_m)
        known = pose.known[self._starts] & pose.known[self._ends]
        matrices = piece_matrices(
            points[self._starts], points[self._ends], front_of(points)
        ).tolist()
        for node, rows, there, own in zip(self._nodes, matrices, known, self._own, strict=True):
            if there and not (first_person and own):
                node.setMat(LMatrix4f(*rows[0], *rows[1], *rows[2], *rows[3]))
                node.show()
            else:
                node.hide()


def front_of(points: Floats) -> Floats:
    """Where a body of points (P,3) looks (3,), all in Panda3D's axes."""
    left = points[INDEX["leftUpperArm"]] - points[INDEX["rightUpperArm"]]
    up = points[INDEX["neck"]] - points[INDEX["hips"]]
    front: Floats = np.cross(left, up)
    size = float(np.linalg.norm(front))
    return front / size if size > 1e-6 else np.array([0.0, 1.0, 0.0])


def piece_matrices(starts: Floats, ends: Floats, front: Floats) -> Floats:
    """(N,4,4), for row vectors as Panda3D has them: +Z and length 1 go from start to end, +Y looks to the front."""
    along = ends - starts
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    z = along / length
    depth = front - (z @ front)[:, None] * z
    size = np.linalg.norm(depth, axis=1, keepdims=True)
    # a limb that points to the front has its depth upwards
    other = _UP - (z @ _UP)[:, None] * z
    depth = np.where(size > 0.3, depth, other)
    y = depth / np.maximum(np.linalg.norm(depth, axis=1, keepdims=True), 1e-6)
    out = np.zeros((len(z), 4, 4))
    out[:, 0, :3], out[:, 1, :3], out[:, 2, :3] = np.cross(y, z), y, along
    out[:, 3, :3], out[:, 3, 3] = starts, 1.0
    return out
