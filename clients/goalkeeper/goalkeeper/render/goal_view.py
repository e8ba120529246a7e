"""The goal: posts that are lit, and a net that shivers when a ball is in it."""

import numpy as np
from panda3d.core import NodePath

from goalkeeper.core.pitch import (
    GOAL_DEPTH_M,
    GOAL_HEIGHT_M,
    GOAL_LINE_Z_M,
    GOAL_WIDTH_M,
    POST_RADIUS_M,
)
from goalkeeper.render.body_view import piece_matrices
from goalkeeper.render.meshes import Mesh, Ring, loft, node_of, node_of_lines
from mocapd.types import Floats

_MESH_M = 0.14  # a hole of the net
_CORD = (0.62, 0.68, 0.66)
_SHIVER_S = 0.7


class GoalView:
    """Built once."""

    def __init__(self, parent: NodePath) -> None:
        self.root = parent.attachNewNode("goal")
        half, y = GOAL_WIDTH_M / 2 + POST_RADIUS_M, GOAL_LINE_Z_M - POST_RADIUS_M
        top = GOAL_HEIGHT_M + POST_RADIUS_M
        for a, b in (
            ((-half, y, 0.0), (-half, y, top)),
            ((half, y, 0.0), (half, y, top)),
            ((-half - POST_RADIUS_M, y, top), (half + POST_RADIUS_M, y, top)),
        ):
            node_of("post", _post(np.array(a), np.array(b))).reparentTo(self.root)
        self._net = node_of_lines("net", _net(half, y, top), _CORD)
        self._net.reparentTo(self.root)
        self._hit_s = -10.0

    def hit(self, now_s: float) -> None:
        """A ball flew into the net."""
        self._hit_s = now_s

    def update(self, now_s: float) -> None:
        """Once a picture."""
        since_s = now_s - self._hit_s
        if since_s < _SHIVER_S:
            swing = 0.05 * np.exp(-5.0 * since_s) * np.sin(35.0 * since_s)
            self._net.setY(float(swing))


def _post(a: Floats, b: Floats) -> Mesh:
    white = (0.97, 0.97, 0.97)
    unit = loft(
        [
            Ring(0.0, POST_RADIUS_M, POST_RADIUS_M, white),
            Ring(1.0, POST_RADIUS_M, POST_RADIUS_M, white),
        ]
    )
    m = piece_matrices(a[None], b[None], np.array([0.0, 1.0, 0.0]))[0]
    normals = unit.normals @ m[:3, :3]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(
        unit.vertices @ m[:3, :3] + m[3, :3], normals, unit.colours, unit.uv, unit.triangles
    )


def _net(half: float, y: float, top: float) -> Floats:
    """Cords (N,2,3) of back, roof and sides; the back leans out at its foot."""
    back, up = y - GOAL_DEPTH_M, y - 0.35 * GOAL_DEPTH_M
    left_low, right_low = np.array([-half, back, 0.0]), np.array([half, back, 0.0])
    left_up, right_up = np.array([-half, up, top]), np.array([half, up, top])
    left, right = np.array([-half, y, top]), np.array([half, y, top])
    foot_left, foot_right = np.array([-half, y, 0.0]), np.array([half, y, 0.0])
    faces = [
        (left_low, right_low, right_up, left_up),
        (left_up, right_up, right, left),
        (foot_left, left_low, left_up, left),
        (right_low, foot_right, right, right_up),
    ]
    return np.concatenate([_netting(*face) for face in faces])


def _netting(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Cords along both ways of a face with corners a, b, c, d in turn."""
    cords = []
    for from_a, from_b, to_a, to_b in ((a, b, d, c), (a, d, b, c)):
        count = max(2, round(float(np.linalg.norm(from_b - from_a)) / _MESH_M))
        share = np.linspace(0.0, 1.0, count + 1)[:, None]
        cords.append(
            np.stack([from_a + share * (from_b - from_a), to_a + share * (to_b - to_a)], axis=1)
        )
    return np.concatenate(cords)
