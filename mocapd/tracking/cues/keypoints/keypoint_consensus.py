"""What three cameras and more agree on: which keypoints are left and right, and how much each is worth.

A network that sees one picture takes the left arm or leg for the right one now and then, and is as sure of both. Rays of such
a camera miss those of the others. So the labels of each camera are read as they are and exchanged, and the reading is taken
under which rays meet best, by as few exchanges as that takes. Rays that miss the place where the others meet then count less,
wherever the body is thought to be.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS, OTHER_SIDE
from mocapd.fit.terms.joint_term import JointRays
from mocapd.tracking.cues.keypoints.keypoint_consensus_kernels import read_as
from mocapd.types import Floats, Ints

LEAST_CAMERAS = 3  # of two that contradict each other, either may be wrong
# arms and legs are exchanged as a whole
_LIMB_JOINTS = [
    [INDEX[side + joint] for side in SIDES for joint in limb]
    for limb in (("LowerArm", "Hand"), ("LowerLeg", "Foot", "Toes"))
]
_PREDICTED_SD_M = 0.2  # of a joint about its prediction
_ROBUST2 = 9.0  # squared standard deviations at which a ray has a quarter of its weight
_EXCHANGE_COST = 3.0  # of each, which rays must gain by it [squared standard deviations]
_MOST_EXCHANGED = 2  # cameras
_REWEIGHTS = 2


def agreed_keypoints(rays: Sequence[JointRays], joints_m: Floats) -> list[JointRays]:
    """The keypoints (of C cameras) with arms or legs exchanged where a camera took left for right, and with less information
    on those that the others contradict; unchanged before fewer than three cameras. joints_m (J,3): as predicted."""
    if len(rays) < LEAST_CAMERAS:
        return list(rays)
    readings = _readings(len(rays))
    labels = np.where(readings[:, :, None], OTHER_SIDE, np.arange(N_JOINTS))  # (M,C,J)
    costs, share = np.empty((len(readings), N_JOINTS)), np.empty(labels.shape)
    least = 1.0 / _PREDICTED_SD_M**2
    read_as(labels, _squares(rays), joints_m, least, _ROBUST2, _REWEIGHTS, costs, share)
    chosen, shares = labels[0].copy(), share[0].copy()
    for joints in _LIMB_JOINTS:
        best = int(np.argmin(costs[:, joints].sum(1) + _EXCHANGE_COST * readings.sum(1)))
        chosen[:, joints], shares[:, joints] = labels[best][:, joints], share[best][:, joints]
    return [_read(*one) for one in zip(rays, chosen, shares, strict=True)]


def _read(rays: JointRays, labels: Ints, shares: Floats) -> JointRays:
    """One camera's keypoints with labels (J,), pairs of which are exchanged, and a share (J,) of their information."""
    joints = labels[rays.joints]
    share = shares[joints]
    return replace(
        rays,
        joints=joints,
        information=share[:, None] * rays.information,
        depth_information=share * rays.depth_information,
    )


def _squares(rays: Sequence[JointRays]) -> tuple[Floats, Floats, Floats]:
    """`JointRays.squares` of each camera and joint (C,J,...), without a keypoint 0."""
    A, b, c = (np.zeros((len(rays), N_JOINTS, *shape)) for shape in ((3, 3), (3,), ()))
    for i, one in enumerate(rays):
        A[i, one.joints], b[i, one.joints], c[i, one.joints] = one.squares
    return A, b, c


@cache
def _readings(cameras: int) -> NDArray[np.bool_]:
    """Which cameras exchange (M,C), none in the first; at most two, and never most of them."""
    most = min(_MOST_EXCHANGED, cameras // 2)
    every = [one for one in product((False, True), repeat=cameras) if sum(one) <= most]
    return np.array(sorted(every, key=sum))
