"""One person in viser's scene: the only place that knows how it is drawn."""

import numpy as np
import viser

from mocapd.types import Floats
from mocapd_analysis.joint_angles import SIDES
from mocapd_analysis.session import Session
from mocapd_analysis.viewer.figure import (
    HEAD_M,
    TRAIL_POINTS,
    cylinders,
    pose_at,
    thickness_m,
    trail_at,
    unit_cylinder,
    unit_sphere,
)

TRAILS = {"left": (224, 108, 40), "right": (36, 140, 160)}


class Person:
    """Cylinders, joints, a head and a trail of each wrist, under one node of the scene."""

    def __init__(
        self, server: viser.ViserServer, node: str, session: Session, colour: tuple[int, int, int]
    ) -> None:
        scene = server.scene
        self._server = server
        self._radii_m = np.array([thickness_m(name) for name in session.joint_names])
        self._root = scene.add_frame(node, show_axes=False)
        placed = cylinders(session.joints_m[0], session.parents, self._radii_m)
        vertices, faces = unit_cylinder()
        self._bones = scene.add_batched_meshes_simple(
            f"{node}/bones", vertices.astype(np.float32), faces.astype(np.uint32),
            placed[1], placed[0], batched_scales=placed[2], batched_colors=colour, lod="off",
        )  # fmt: skip
        vertices, faces = unit_sphere()
        joints = len(session.joint_names)
        self._joints = scene.add_batched_meshes_simple(
            f"{node}/joints",
            vertices.astype(np.float32),
            faces.astype(np.uint32),
            np.tile([1.0, 0.0, 0.0, 0.0], (joints, 1)),
            session.joints_m[0],
            batched_scales=self._radii_m,
            batched_colors=colour,
            lod="off",
        )
        self._head = scene.add_icosphere(
            f"{node}/head", radius=HEAD_M, color=colour, subdivisions=2
        )
        self._trails = {}
        for side in SIDES:
            if session.has(f"{side}Hand"):
                faded = np.linspace(0.4, 1.0, TRAIL_POINTS)[:, None]
                colours = (faded * TRAILS[side] + (1.0 - faded) * 255.0).astype(np.uint8)
                self._trails[side] = scene.add_line_segments(
                    f"{node}/trail_{side}", np.zeros((TRAIL_POINTS - 1, 2, 3), np.float32),
                    np.stack([colours[:-1], colours[1:]], axis=1), thickness=0.028,
                )  # fmt: skip

    def show(self, session: Session, at_s: float, trail_s: float, apart_m: float) -> None:
        """As it is at a time, moved aside; nobody in a gap."""
        joints_m = pose_at(session, at_s)
        with self._server.atomic():
            self._root.visible = joints_m is not None
            if joints_m is None:
                return
            self._root.position = (apart_m, 0.0, 0.0)
            self._place(session, joints_m)
            for side, trail in self._trails.items():
                points = trail_at(session, f"{side}Hand", at_s, trail_s).astype(np.float32)
                trail.points = np.stack([points[:-1], points[1:]], axis=1)

    def remove(self) -> None:
        """Out of the scene."""
        self._root.remove()

    def _place(self, session: Session, joints_m: Floats) -> None:
        middles, wxyz, scales = cylinders(joints_m, session.parents, self._radii_m)
        self._bones.batched_positions = middles.astype(np.float32)
        self._bones.batched_wxyzs = wxyz.astype(np.float32)
        self._bones.batched_scales = scales.astype(np.float32)
        self._joints.batched_positions = joints_m.astype(np.float32)
        if session.has("head", "neck"):
            head, neck = joints_m[session.joint("head")], joints_m[session.joint("neck")]
            up = head - neck
            self._head.position = head + HEAD_M * up / max(float(np.linalg.norm(up)), 1e-9)
