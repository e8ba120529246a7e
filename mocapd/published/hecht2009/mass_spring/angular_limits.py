"""How far the limbs, the neck and the waist turn, in frames that three points span: as tables for the kernels.

Two kinds. A *swing* bounds the direction of a part in the frame of the trunk next to it; it is measured from the T-pose by
the vector axis * tan(angle / 2), which needs no trigonometry, within a box. A *hinge* bounds how an elbow or a knee bends:
by how much, and to which side of the upper part, which is what the twist of the upper arm or thigh allows; the side is
measured from the T-pose, carried along by the smallest turn that leads to the upper part's direction. The
numbers are those of `body.joint_limits`.
"""

from typing import NamedTuple

import numpy as np

from mocapd.body.pose_space import full_body
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    KNEE,
    NECK,
    SHOULDER,
    WAIST,
    WRIST,
)
from mocapd.types import Floats, Ints

UPPER, LOWER = 0, 1  # the trunk's frames: shoulder line over waist, hip line under waist
X, Y, Z = 0, 1, 2

# The trunk's frame takes the place of the collar bone's, which moves by 30 degrees in it both ways and rises by 45, and is
# seldom at its end together with the upper arm: half of that.
_COLLAR_DEG = 15.0, 22.0
# between trunk and neck the shoulder line gives way
_GIRDLE_DEG = 35.0, 25.0
# Knees bend in the plane that the thigh's twist gives, up to 60 degrees to either side; neutral twists differ by 15.
_KNEE_SIDE_DEG = 75.0
# Thighs of deep squats swing out twice as far, but with limits that wide the particles went wrong.
_THIGH_ASIDE_DEG = 60.0
# straighter than that a limb has no side: joints overstretch by 7 to 10, and points are noisy
_STRAIGHT_DEG = 10.0
_BENT_MOST_DEG = 155.0


class Swings(NamedTuple):
    """W limits on the direction from the mean of points 1, 2 to the mean of points 3, 4.

    points (W,4); frame (W,) UPPER or LOWER; axis (W,) and sign (W,): the direction in the T-pose, an axis of the frame;
    lower, upper (W,2): tan(angle / 2) about the two axes after `axis`, in cyclic order.
    """

    points: Ints
    frame: Ints
    axis: Ints
    sign: Floats
    lower: Floats
    upper: Floats


class Hinges(NamedTuple):
    """H limits on the bend at b of points a, b, c.

    points (H,3); frame (H,); axis (H,) and sign (H,): direction a to b in the T-pose, an axis of the frame; forward (H,):
    +1 bends to +Z in the T-pose, -1 to -Z; side (H,4): cosine and sine of the middle of the sides it bends to, counted
    about a to b from `forward`, then of half their width; bend (3,): cosine and sine of what counts as straight, cosine
    of the greatest bend.
    """

    points: Ints
    frame: Ints
    axis: Ints
    sign: Floats
    forward: Floats
    side: Floats
    bend: Floats


def swings() -> Swings:
    """Neck on trunk, head on neck, waist, then shoulders and hips, the left first."""
    limits = full_body().limits
    group = full_body().group
    rows: list[tuple[tuple[int, ...], int, int, float, Floats, Floats]] = []

    def add(
        points: tuple[int, ...], frame: int, axis: int, sign: float, low: Floats, high: Floats
    ) -> None:
        others = [(axis + 1) % 3, (axis + 2) % 3]
        rows.append((points, frame, axis, sign, np.tan(low[others] / 2), np.tan(high[others] / 2)))

    most_aside = np.radians(_THIGH_ASIDE_DEG)
    girdle = np.radians([_GIRDLE_DEG[0], 0.0, _GIRDLE_DEG[1]])
    add((*SHOULDER, NECK, NECK), UPPER, Y, 1.0, -girdle, girdle)
    low, high = limits.lower_rad[group("neck")], limits.upper_rad[group("neck")]
    add((NECK, NECK, HEAD, HEAD), UPPER, Y, 1.0, low, high)
    low, high = limits.lower_rad[group("spine")], limits.upper_rad[group("spine")]
    add((*WAIST, *HIP), UPPER, Y, -1.0, -high, -low)  # the hips from the trunk, not the other way
    for s, side in enumerate(("left", "right")):
        outward = 1.0 if s == 0 else -1.0
        g = group(side + "UpperArm")
        to_side, up = np.radians(_COLLAR_DEG)
        low = limits.lower_rad[g] - [0.0, to_side, up if s == 1 else 0.0]
        high = limits.upper_rad[g] + [0.0, to_side, up if s == 0 else 0.0]
        add((SHOULDER[s], SHOULDER[s], ELBOW[s], ELBOW[s]), UPPER, X, outward, low, high)
        g = group(side + "UpperLeg")
        low, high = limits.lower_rad[g].copy(), limits.upper_rad[g].copy()
        low[Z], high[Z] = np.maximum(low[Z], -most_aside), np.minimum(high[Z], most_aside)
        add((HIP[s], HIP[s], KNEE[s], KNEE[s]), LOWER, Y, -1.0, low, high)
    points, frame, axis, sign, lower, upper = zip(*rows, strict=True)
    return Swings(
        np.array(points), np.array(frame), np.array(axis), np.array(sign), np.array(lower),
        np.array(upper),
    )  # fmt: skip


def hinges() -> Hinges:
    """Elbows, then knees, the left first."""
    limits = full_body().limits
    points, side = [], []
    for s, name in enumerate(("left", "right")):
        points.append((SHOULDER[s], ELBOW[s], WRIST[s]))
        # a twist about the arm's own direction, which is +X of the left arm and -X of the right
        g = full_body().group(name + "UpperArm")
        twist = limits.lower_rad[g][X], limits.upper_rad[g][X]
        side.append(twist if s == 0 else (-twist[1], -twist[0]))
    for s in (0, 1):
        points.append((HIP[s], KNEE[s], ANKLE[s]))
        side.append((-np.radians(_KNEE_SIDE_DEG), np.radians(_KNEE_SIDE_DEG)))
    low, high = np.array(side).T
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    straight, most = np.radians(_STRAIGHT_DEG), np.radians(_BENT_MOST_DEG)
    return Hinges(
        np.array(points), np.array([UPPER, UPPER, LOWER, LOWER]), np.array([X, X, Y, Y]),
        np.array([1.0, -1.0, -1.0, -1.0]), np.array([1.0, 1.0, -1.0, -1.0]),
        np.stack([np.cos(middle), np.sin(middle), np.cos(half), np.sin(half)], axis=1),
        np.array([np.cos(straight), np.sin(straight), np.cos(most)]),
    )  # fmt: skip
