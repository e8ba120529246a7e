"""Generic key poses that the pose database blends: directions of the limbs, written for the left arm.

Our own, generic and of no particular sport. A direction is x to the arm's own side, y up, z forwards,
of any length, in the frame of the upper chest.
"""

import numpy as np

from mocapd.geometry import rotations
from mocapd.types import Floats

Direction = tuple[float, float, float]

# upper arm, forearm
ARMS: dict[str, tuple[Direction, Direction]] = {
    "t_pose": ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
    "t_bent_forward": ((1.0, 0.0, 0.1), (0.3, 0.0, 1.0)),
    "hanging": ((0.16, -1.0, 0.0), (0.08, -1.0, 0.2)),
    "hanging_bent": ((0.2, -1.0, 0.05), (0.05, -0.5, 0.85)),
    "behind_hip": ((0.25, -0.9, -0.45), (0.1, -0.95, -0.1)),
    "swung_back": ((0.25, -0.75, -0.65), (0.15, -0.8, -0.55)),
    "side_low": ((0.8, -0.7, 0.05), (0.75, -0.7, 0.2)),
    "side_high": ((0.85, 0.65, 0.05), (0.75, 0.75, 0.15)),
    "raised": ((0.3, 1.0, 0.05), (0.1, 1.0, 0.1)),
    "raised_forward": ((0.2, 0.75, 0.65), (0.05, 0.8, 0.65)),
    "forward": ((0.1, -0.05, 1.0), (0.0, 0.0, 1.0)),
    "forward_low": ((0.15, -0.75, 0.65), (0.05, -0.65, 0.75)),
    "forward_side": ((0.7, 0.0, 0.7), (0.65, 0.05, 0.75)),
    "hand_on_hip": ((0.65, -0.75, -0.25), (-0.6, -0.7, 0.35)),
    "waving": ((0.85, -0.2, 0.3), (0.25, 1.0, 0.2)),
    "waving_high": ((0.8, 0.4, 0.25), (0.1, 1.0, 0.15)),
    "goalpost": ((1.0, 0.0, 0.0), (0.05, 1.0, 0.1)),
    "scarecrow": ((1.0, 0.05, 0.0), (0.1, -1.0, 0.2)),
    "wind_up": ((0.85, 0.2, -0.45), (0.2, 0.85, -0.55)),
    "wind_up_low": ((0.75, -0.45, -0.5), (0.7, 0.3, -0.6)),
    "followed_through": ((-0.25, -0.35, 0.9), (-0.6, -0.5, 0.6)),
    "guarding": ((0.25, -0.8, 0.45), (-0.15, 0.8, 0.6)),
    "guarding_wide": ((0.6, -0.6, 0.5), (0.35, 0.4, 0.85)),
    "crossed": ((0.15, -0.75, 0.6), (-1.0, 0.15, 0.35)),
    "folded_low": ((0.15, -0.95, 0.25), (-0.9, -0.1, 0.45)),
    "hand_on_belly": ((0.3, -0.95, 0.1), (-0.75, -0.15, 0.6)),
    "hugging": ((0.15, -0.1, 1.0), (-0.9, 0.05, 0.4)),
    "across_high": ((-0.35, 0.15, 0.9), (-0.75, 0.4, 0.5)),
    "across_low": ((-0.2, -0.7, 0.65), (-0.65, -0.55, 0.5)),
    "reaching": ((0.3, 0.45, 0.85), (0.1, 0.65, 0.75)),
    "reaching_across": ((-0.1, 0.1, 1.0), (-0.4, 0.1, 0.9)),
    "both_hands_ball": ((0.35, -0.6, 0.7), (-0.35, 0.0, 0.95)),
    "overhead_bent": ((0.45, 0.9, 0.1), (-0.5, 0.6, -0.35)),
    "behind_head": ((0.8, 0.6, 0.0), (-0.55, 0.45, -0.65)),
    "hand_on_head": ((0.75, 0.5, 0.3), (-0.7, 0.75, -0.05)),
    "hand_at_ear": ((0.5, -0.7, 0.45), (-0.15, 0.95, -0.1)),
    "hand_at_chin": ((0.2, -0.85, 0.4), (-0.45, 0.85, 0.25)),
    "behind_back": ((0.4, -0.8, -0.5), (-0.7, -0.5, -0.45)),
    "dribbling": ((0.35, -0.85, 0.3), (0.2, -0.45, 0.9)),
    "pointing_up": ((0.5, 0.2, 0.85), (0.2, 0.9, 0.5)),
}

# flexion, turn to the left, bend [deg] of the whole spine
TORSOS: dict[str, Direction] = {
    "upright": (0.0, 0.0, 0.0),
    "stooping": (30.0, 0.0, 0.0),
    "bowing": (60.0, 0.0, 0.0),
    "arched": (-18.0, 0.0, 0.0),
    "turned_left": (5.0, 38.0, 0.0),
    "turned_right": (5.0, -38.0, 0.0),
    "bent_left": (5.0, 0.0, 26.0),
    "bent_right": (5.0, 0.0, -26.0),
    "reaching_down_left": (35.0, 25.0, 12.0),
    "reaching_down_right": (35.0, -25.0, -12.0),
}


def arm_rotations(name: str) -> tuple[Floats, Floats]:
    """Rotations (4,) of the left upper arm in the chest's frame and of the forearm in the upper arm's.

    The elbow is a hinge about -y of the upper arm; of a straight arm the twist is that of the
    shortest way from the T-pose.
    """
    upper, fore = (np.array(d) / np.linalg.norm(d) for d in ARMS[name])
    x = np.array([1.0, 0.0, 0.0])
    swing = _shortest(x, upper)
    towards = rotations.rotate(rotations.inverse(swing), fore)
    flexion = np.arctan2(np.hypot(towards[1], towards[2]), towards[0])
    # about x, z turns by -angle towards y: the plane of the hinge through the forearm; a nearly
    # straight arm hardly tells its twist, so the twist fades in with the bend
    twist = -np.arctan2(towards[1], towards[2]) * min(1.0, flexion / np.radians(35.0))
    q_upper = rotations.multiply(swing, rotations.exp(twist * x))
    return q_upper, rotations.exp(np.array([0.0, -flexion, 0.0]))


def _shortest(a: Floats, b: Floats) -> Floats:
    """The smallest rotation (4,) that takes the unit vector a to b."""
    cross = np.cross(a, b)
    return rotations.canonical(np.append(cross, 1.0 + a @ b))
