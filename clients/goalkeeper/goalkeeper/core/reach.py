"""Where the player stands, which way he faces and how far he reaches: from a T-pose that is held. Pure."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from goalkeeper.core.limbs import LimbPose
from mocapd.types import Floats

HOLD_S = 0.6
_SIDES = ("left", "right")
_ARM = ("UpperArm", "LowerArm", "Hand", "Tip")
_NEEDED = tuple(side + point for side in _SIDES for point in _ARM)
_STRAIGHT = 0.90  # distance of shoulder and hand, of the arm's length
_LEVEL = 0.30  # height of the hand above or below the shoulder, of the arm's length


@dataclass(frozen=True, slots=True)
class Reach:
    """side_m: from the middle of the body to the fingertips of the outstretched arm; up_m: fingertips above the
    floor, arm raised; centre_m: x, z of the hips; yaw_rad: about +Y, 0 faces +Z."""

    side_m: float
    up_m: float
    centre_m: tuple[float, float]
    yaw_rad: float

    def to_goal(self, points_m: Floats) -> Floats:
        """Points (...,3) of the world as seen from the goal's middle, the player facing +Z at its origin."""
        x, z = self.centre_m
        moved = points_m - np.array([x, 0.0, z])
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        out: Floats = moved @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return out

    def placed(self, pose: LimbPose) -> LimbPose:
        """The pose before the goal."""
        return LimbPose(self.to_goal(pose.points_m), pose.known)


# Of a person of 1.75 m at the origin of the room: until the player has shown his own.
USUAL_REACH = Reach(0.86, 2.15, (0.0, 0.0), 0.0)


def is_t_pose(pose: LimbPose) -> bool:
    """Whether both arms are stretched out to the sides."""
    if not pose.knows(*_NEEDED):
        return False
    apart = pose.point("leftHand") - pose.point("rightHand")
    for side in _SIDES:
        shoulder, elbow, hand = (pose.point(side + b) for b in ("UpperArm", "LowerArm", "Hand"))
        arm_m = np.linalg.norm(elbow - shoulder) + np.linalg.norm(hand - elbow)
        if np.linalg.norm(hand - shoulder) < _STRAIGHT * arm_m:
            return False
        if abs(hand[1] - shoulder[1]) > _LEVEL * arm_m:
            return False
    shoulders = pose.point("leftUpperArm") - pose.point("rightUpperArm")
    return bool(np.linalg.norm(apart) > 2.5 * np.linalg.norm(shoulders))


def reach_of(pose: LimbPose) -> Reach:
    """How far these arms reach where this person stands; with arms that are not known, as USUAL_REACH does. He faces
    across the line of his hands in a T-pose, else that of his shoulders."""
    hips = pose.point("hips")
    centre_m = (float(hips[0]), float(hips[2]))
    if not pose.knows(*_NEEDED):
        return Reach(USUAL_REACH.side_m, USUAL_REACH.up_m, centre_m, 0.0)
    shoulders = [pose.point(f"{side}UpperArm") for side in _SIDES]
    arms_m = [
        sum(
            float(np.linalg.norm(pose.point(side + b) - pose.point(side + a)))
            for a, b in pairwise(_ARM)
        )
        for side in _SIDES
    ]
    arm_m = 0.5 * sum(arms_m)
    line = (pose.point("leftTip"), pose.point("rightTip")) if is_t_pose(pose) else shoulders
    across = line[0] - line[1]
    half_m = 0.5 * float(np.linalg.norm(shoulders[0] - shoulders[1]))
    return Reach(
        half_m + arm_m,
        0.5 * float(shoulders[0][1] + shoulders[1][1]) + arm_m,
        centre_m,
        float(np.arctan2(-across[2], across[0])),
    )


class ReachFinder:
    """Waits for a T-pose that is held for HOLD_S."""

    def __init__(self) -> None:
        self._held: list[Floats] = []
        self._held_s = 0.0

    @property
    def progress(self) -> float:
        """How much of the time it was held, 0..1."""
        return min(self._held_s / HOLD_S, 1.0)

    def step(self, pose: LimbPose | None, dt_s: float) -> Reach | None:
        """One tick further; the reach once it is known."""
        if pose is None or not is_t_pose(pose):
            self._held.clear()
            self._held_s = 0.0
            return None
        self._held.append(pose.points_m)
        self._held_s += dt_s
        if self._held_s < HOLD_S:
            return None
        return reach_of(LimbPose(np.mean(self._held, axis=0), pose.known))
