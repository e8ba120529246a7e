"""From a skeleton to its message, and when it has changed enough to be told again. Pure."""

import numpy as np

from mocapd.outputs.messages import RestSkeleton
from mocapd.types import Skeleton

NOTICEABLE_M = 0.005  # that a joint of the T-pose has moved; what is learned while tracking goes on for ever [m]


def rest_skeleton(
    skeleton: Skeleton, *, instance: str, stature_m: float, person: int = 0
) -> RestSkeleton:
    """The T-pose as sent."""
    parents, rest_m = skeleton.parents, skeleton.rest_m
    offsets_m = rest_m - np.where(parents[:, None] >= 0, rest_m[parents], 0.0)
    return RestSkeleton(
        instance,
        person,
        stature_m,
        skeleton.names,
        tuple(parents.tolist()),
        tuple((x, y, z) for x, y, z in offsets_m.tolist()),
    )


def is_noticeable(told: Skeleton, now: Skeleton) -> bool:
    """Whether a receiver of the first would see that it is not the second: other bones, or a joint that is
    elsewhere by NOTICEABLE_M and more."""
    if told.names != now.names or not np.array_equal(told.parents, now.parents):
        return True
    return bool(np.abs(now.rest_m - told.rest_m).max() >= NOTICEABLE_M)
