"""Which way a person faces, from a frame as it is sent."""

import math

from mocapd.outputs.wire import SkeletonFrame

_MIN_CONFIDENCE = 0.15  # confidence
# of the upper chest's confidence: below, the head has no evidence of its own and only follows the chest
_OWN = 0.75
_LEVEL = 0.3  # least horizontal length of the unit forward vector; below, the yaw is ill-defined
_BONES = ("head", "upperChest", "hips")  # the first confident one gives the yaw


def facing_yaw_rad(frame: SkeletonFrame) -> float | None:
    """The rotation about +Y from +Z to the person's forward direction [rad]: positive to the person's left, towards +X.

    None when no bone is confident enough.
    """
    chest = frame.joints.get("upperChest")
    for name in _BONES:
        joint = frame.joints.get(name)
        if joint is None or joint.c <= _MIN_CONFIDENCE:
            continue
        if name == "head" and chest is not None and joint.c < _OWN * chest.c:
            continue
        x, y, z, w = joint.r
        to_left, ahead = 2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y)
        if math.hypot(to_left, ahead) > _LEVEL:
            return math.atan2(to_left, ahead)
    return None
