"""The rest-skeleton message of a skeleton, and the test whether a change is worth a new message. Pure."""

import numpy as np

from mocapd.outputs.messages import RestSkeleton
from mocapd.types import Skeleton

# least change of a joint of the T-pose that is sent again [m]; the shape estimate never stops changing
NOTICEABLE_M = 0.005


def rest_skeleton(skeleton: Skeleton, *, instance: str, stature_m: float) -> RestSkeleton:
    """The T-pose as sent."""
    parents, rest_m = skeleton.parents, skeleton.rest_m
    offsets_m = rest_m - np.where(parents[:, None] >= 0, rest_m[parents], 0.0)
    return RestSkeleton(
        instance,
        0,  # the only person
        stature_m,
        skeleton.names,
        tuple(parents.tolist()),
        tuple((x, y, z) for x, y, z in offsets_m.tolist()),
    )


def is_noticeable(sent: Skeleton, current: Skeleton) -> bool:
    """True if the skeletons differ for a receiver: in bones, or in a joint's position by NOTICEABLE_M or more."""
    if sent.names != current.names or not np.array_equal(sent.parents, current.parents):
        return True
    return bool(np.abs(current.rest_m - sent.rest_m).max() >= NOTICEABLE_M)
