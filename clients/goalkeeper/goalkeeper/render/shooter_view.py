"""Who shoots: a player that runs up and kicks. Poses are worked out once."""

from collections.abc import Mapping

import numpy as np
from panda3d.core import NodePath

from goalkeeper.core.limbs import LimbPose, pose_of_joints
from goalkeeper.render.body_meshes import STRIKER
from goalkeeper.render.body_view import BodyView
from mocapd.body.bones import NAMES
from mocapd.body.skeleton import (
    INDEX,
    global_from_local,
    joint_positions,
    rest_pose,
    standard_skeleton,
)
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose

_STEPS = 24
_RUN_UP_M = 1.6
_BEHIND_BALL_M = 0.35
# Of the run-up's end, 0..1: degrees about +X (forwards is negative for legs) and arms lowered to the sides.
_KEYS: Mapping[float, Mapping[str, tuple[float, float, float]]] = {
    0.0: {"rightUpperLeg": (0, 0, 0), "leftUpperLeg": (0, 0, 0), "rightLowerLeg": (8, 0, 0), "leftLowerLeg": (8, 0, 0)},
    0.35: {"rightUpperLeg": (-35, 0, 0), "leftUpperLeg": (25, 0, 0), "rightLowerLeg": (40, 0, 0), "leftLowerLeg": (30, 0, 0)},
    0.7: {"rightUpperLeg": (38, 0, 0), "leftUpperLeg": (-28, 0, 0), "rightLowerLeg": (75, 0, 0), "leftLowerLeg": (20, 0, 0)},
    1.0: {"rightUpperLeg": (-48, 0, 0), "leftUpperLeg": (8, 0, 0), "rightLowerLeg": (12, 0, 0), "leftLowerLeg": (14, 0, 0)},
}  # fmt: skip


class ShooterView:
    """One figure."""

    def __init__(self, parent: NodePath) -> None:
        self._body = BodyView(parent, STRIKER)
        poses = [_pose(step / (_STEPS - 1)) for step in range(_STEPS)]
        self._poses = [pose for pose in poses if pose is not None]

    def show(self, from_m: Floats, run_up: float) -> Floats:
        """At the ball's place (3,) in the goal's frame, so far into the run-up 0..1; where it stands (3,)."""
        pose = self._poses[round(min(max(run_up, 0.0), 1.0) * (_STEPS - 1))]
        # it faces the goal: turned by half a turn
        behind_m = _BEHIND_BALL_M + _RUN_UP_M * (1.0 - run_up)
        points_m = pose.points_m * [-1.0, 1.0, -1.0]
        stands_m = np.array([from_m[0] + 0.12, 0.0, from_m[2] + behind_m])
        self._body.show(LimbPose(points_m + stands_m, pose.known))
        return stands_m


def _pose(run_up: float) -> LimbPose | None:
    skeleton = standard_skeleton(1.80)
    local = np.tile(rotations.IDENTITY_XYZW, (len(NAMES), 1))
    times = sorted(_KEYS)
    for bone in _KEYS[0.0]:
        degrees = [np.interp(run_up, times, [_KEYS[t][bone][k] for t in times]) for k in range(3)]
        local[INDEX[bone]] = rotations.exp(np.radians(degrees))
    swing = 40.0 * np.sin(2 * np.pi * run_up)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        lowered = rotations.exp(np.radians([0.0, 0.0, sign * 62.0]))
        forth = rotations.exp(np.radians([-sign * swing, 0.0, 0.0]))
        local[INDEX[f"{side}UpperArm"]] = rotations.multiply(forth, lowered)
    local[INDEX["spine"]] = rotations.exp(np.radians([12.0 * run_up, 0.0, 0.0]))
    rest = rest_pose(skeleton)
    posed = Pose(rest.root_m, global_from_local(skeleton, local))
    joints_m = joint_positions(skeleton, posed)
    joints_m[:, 1] -= joints_m[:, 1].min() - 0.03  # a foot on the ground
    return pose_of_joints(dict(zip(NAMES, joints_m.tolist(), strict=True)))
