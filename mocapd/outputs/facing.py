"""Which way a person faces, from a frame as it is sent."""

import math

from mocapd.outputs.wire import SkeletonFrame

SEEN_ABOVE = 0.15  # confidence
_OWN = 0.75  # of the upper chest's confidence: a head of less only follows it, see the trackers
_LEVEL = 0.3  # of the forward direction, at least this much must be level [share]; else it says little of the yaw
# who is asked to look ahead does so with head and body: the first of these that is seen
_BONES = ("head", "upperChest", "hips")


def facing_yaw_rad(frame: SkeletonFrame) -> float | None:
    """The turn about +Y that takes +Z to where the person looks [rad]: positive to its left, towards +X.

    None when nothing is seen that would tell.
    """
    chest = frame.joints.get("upperChest")
    for name in _BONES:
        joint = frame.joints.get(name)
        if joint is None or joint.c <= SEEN_ABOVE:
            continue
        if name == "head" and chest is not None and joint.c < _OWN * chest.c:
            continue
        x, y, z, w = joint.r
        to_left, ahead = 2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y)
        if math.hypot(to_left, ahead) > _LEVEL:
            return math.atan2(to_left, ahead)
    return None
