"""The arms of an upper body that another tracker sees, told the more slowly the less the pictures confirm them."""

from dataclasses import replace

import numpy as np

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.trackers.base import Track
from mocapd.trackers.steadying import SteadyingParams, Told, behind, steadied

_ARMS = np.array(
    [INDEX[s + n] for s in ("left", "right") for n in ("UpperArm", "LowerArm", "Hand")]
)


def with_steady_arms(
    track: Track, shape: BodyShape, last: Told | None, params: SteadyingParams
) -> tuple[Track, Told | None]:
    """The track as it is told after `last`, and what is to be remembered of that: nothing without a body."""
    body = track.body
    if body.pose is None or body.joints_m is None:
        return track, None
    arms = np.ones_like(body.confidence)
    arms[_ARMS] = body.confidence[_ARMS]
    told = steadied(body.pose, arms, body.t_ns, last, params)
    skeleton = skeleton_of(shape)
    joints_m = joint_positions(skeleton, told.pose)
    uncertainty_m = behind(body.uncertainty_m, joints_m, body.joints_m)
    steady = replace(body, pose=told.pose, joints_m=joints_m, uncertainty_m=uncertainty_m)
    return replace(track, body=steady), told
