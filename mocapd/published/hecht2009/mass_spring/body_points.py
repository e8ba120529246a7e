"""The sixteen points of the flexible body: their order, sides, limbs, and where they are in the T-pose.

HEAD, from which the body hangs, is straight above the NECK at the height of the head's middle (half way from chin to
crown and from face to nape, what a tracker of heads measures), which is a few centimetres before it: hung from its
middle, the whole body would swing forwards by so much. NECK and the points of the limbs are joints of the skeleton; the
two WAIST points part the trunk in two, at half the height between the joints `spine` and `chest`.
"""

import numpy as np

from mocapd.body.head_proportions import MIDDLE
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import INDEX
from mocapd.types import Floats, Skeleton

N_POINTS = 16
HEAD, NECK = 0, 1
# of either side, the left first
SHOULDER, ELBOW, WRIST = (2, 9), (3, 10), (4, 11)
WAIST = (5, 12)
HIP, KNEE, ANKLE = (6, 13), (7, 14), (8, 15)

# the three points of each limb, from the trunk outwards: the state of one particle filter
LIMBS = {
    "left_arm": (SHOULDER[0], ELBOW[0], WRIST[0]),
    "right_arm": (SHOULDER[1], ELBOW[1], WRIST[1]),
    "left_leg": (HIP[0], KNEE[0], ANKLE[0]),
    "right_leg": (HIP[1], KNEE[1], ANKLE[1]),
}

# points that are joints, and those joints
_OF_JOINTS = {NECK: "neck"} | {
    points[s]: side + bone
    for points, bone in (
        (SHOULDER, "UpperArm"), (ELBOW, "LowerArm"), (WRIST, "Hand"),
        (HIP, "UpperLeg"), (KNEE, "LowerLeg"), (ANKLE, "Foot"),
    )
    for s, side in enumerate(("left", "right"))
}  # fmt: skip
JOINT_POINTS = np.array(list(_OF_JOINTS))
JOINTS_OF_POINTS = np.array([INDEX[name] for name in _OF_JOINTS.values()])

_WAIST_HALF_WIDTH = 0.075  # in statures: a little inside of the trunk's surface


def rest_points(shape: BodyShape, skeleton: Skeleton) -> Floats:
    """The points (16,3) in the T-pose [m], at the origin and facing +Z; skeleton: that of the shape."""
    rest = skeleton.rest_m
    out = np.empty((N_POINTS, 3))
    out[JOINT_POINTS] = rest[JOINTS_OF_POINTS]
    out[HEAD] = out[NECK]
    out[HEAD, 1] = _head_middle(shape, skeleton)[1]
    waist = 0.5 * (rest[INDEX["spine"]] + rest[INDEX["chest"]])
    half = _WAIST_HALF_WIDTH * shape.stature_m * shape.factor("torso_width")
    out[WAIST[0]], out[WAIST[1]] = waist + [half, 0.0, 0.0], waist - [half, 0.0, 0.0]
    return out


def head_ahead_m(shape: BodyShape, skeleton: Skeleton) -> float:
    """How far the head's middle is before HEAD [m]."""
    return float(_head_middle(shape, skeleton)[2] - skeleton.rest_m[INDEX["neck"], 2])


def head_forward(points_m: Floats) -> Floats:
    """The unit direction (...,3) from HEAD to the head's middle, of points (...,16,3): a head is held upright, and faces
    forwards from the shoulder line."""
    across = points_m[..., SHOULDER[0], :] - points_m[..., SHOULDER[1], :]
    forward = np.cross(across, [0.0, 1.0, 0.0])
    unit: Floats = forward / np.maximum(np.sqrt(np.vecdot(forward, forward)), 1e-12)[..., None]
    return unit


def _head_middle(shape: BodyShape, skeleton: Skeleton) -> Floats:
    size = shape.stature_m * shape.factor("head_size")
    middle: Floats = skeleton.rest_m[INDEX["head"]] + MIDDLE * size
    return middle
