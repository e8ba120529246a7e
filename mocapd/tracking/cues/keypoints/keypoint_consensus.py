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

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.terms.joint_term import JointRays
from mocapd.types import Floats, Ints

LEAST_CAMERAS = 3  # of two that contradict each other, either may be wrong
_LIMBS = (("LowerArm", "Hand"), ("LowerLeg", "Foot", "Toes"))
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
    equations = _equations(rays)
    labels, shares = np.tile(np.arange(N_JOINTS), (len(rays), 1)), np.ones((len(rays), N_JOINTS))
    for own, other in _groups():
        labels[:, own], shares[:, own] = _best_reading(equations, joints_m, own, other)
    return [_read(*one) for one in zip(rays, labels, shares, strict=True)]


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


def _best_reading(
    equations: tuple[Floats, Floats, Floats], joints_m: Floats, own: Ints, other: Ints
) -> tuple[Ints, Floats]:
    """Which label of each camera is each joint of `own` (C,N), that or the one of `other` (N,), and what share of its
    information agrees with the other cameras (C,N)."""
    count = len(equations[0])
    readings = _readings(count) if (own != other).any() else _readings(count)[:1]  # (M,C)
    labels = np.where(readings[:, :, None], other, own)  # (M,C,N)
    rows, offsets, weights = (part[np.arange(count)[:, None], labels] for part in equations)
    predicted_m, least = joints_m[own], 1.0 / _PREDICTED_SD_M**2
    share = np.ones(labels.shape)
    for _ in range(1 + _REWEIGHTS):
        weighted = (share[..., None, None] * weights) @ rows
        A = (rows.swapaxes(-1, -2) @ weighted).sum(1) + least * np.eye(3)
        b = (weighted.swapaxes(-1, -2) @ offsets[..., None]).sum(1)[..., 0] + least * predicted_m
        places_m = np.linalg.solve(A, b[..., None])[..., 0]  # (M,N,3)
        beside = (rows @ places_m[:, None, :, :, None])[..., 0] - offsets
        off2 = np.einsum("mcni,mcnij,mcnj->mcn", beside, weights, beside)
        share = (1.0 + off2 / _ROBUST2) ** -2
    away2 = least * np.square(places_m - predicted_m).sum(-1)
    costs = _robust(off2).sum((1, 2)) + _robust(away2).sum(1) + _EXCHANGE_COST * readings.sum(1)
    best = int(np.argmin(costs))
    return labels[best], share[best]


def _equations(rays: Sequence[JointRays]) -> tuple[Floats, Floats, Floats]:
    """`JointRays.equations` of each camera and joint (C,J,...), without a keypoint 0."""
    count = len(rays)
    rows, offsets = np.zeros((count, N_JOINTS, 2, 3)), np.zeros((count, N_JOINTS, 2))
    weights = np.zeros((count, N_JOINTS, 2, 2))
    for i, one in enumerate(rays):
        rows[i, one.joints], offsets[i, one.joints], weights[i, one.joints] = one.equations
    return rows, offsets, weights


@cache
def _groups() -> tuple[tuple[Ints, Ints], ...]:
    """Joints (N,) that are exchanged together, each with the joint of the other side; last the others, each with itself."""
    groups, rest = [], set(range(N_JOINTS))
    for limb in _LIMBS:
        left, right = ([INDEX[side + joint] for joint in limb] for side in ("left", "right"))
        groups.append((np.array(left + right), np.array(right + left)))
        rest -= {*left, *right}
    others = np.array(sorted(rest))
    return (*groups, (others, others))


@cache
def _readings(cameras: int) -> NDArray[np.bool_]:
    """Which cameras exchange (M,C), none in the first; at most two, and never most of them."""
    most = min(_MOST_EXCHANGED, cameras // 2)
    every = [one for one in product((False, True), repeat=cameras) if sum(one) <= most]
    return np.array(sorted(every, key=sum))


def _robust(squares: Floats) -> Floats:
    """Geman-McClure of squared standard deviations."""
    out: Floats = squares / (1.0 + squares / _ROBUST2)
    return out
