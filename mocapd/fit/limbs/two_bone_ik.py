"""Two-bone inverse kinematics: a limb's bones through given places of its middle joint and end."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.geometry import rotations
from mocapd.types import Floats

_STRAIGHT = 0.25  # sine of the bend below which the joints do not define the limb's plane


@dataclass(frozen=True, slots=True)
class Limb:
    """The joints where its bones begin and end, and the hinge's axis in the T-pose, about which it bends."""

    upper: int
    lower: int
    end: int
    hinge: tuple[float, float, float]


LIMBS = {
    f"{side}_{limb}": Limb(INDEX[side + upper], INDEX[side + lower], INDEX[side + end], hinge)
    for side, outwards in zip(SIDES, (1.0, -1.0), strict=True)
    for limb, upper, lower, end, hinge in (
        ("arm", "UpperArm", "LowerArm", "Hand", (0.0, -outwards, 0.0)),
        ("leg", "UpperLeg", "LowerLeg", "Foot", (1.0, 0.0, 0.0)),
    )
}


def two_bone_pose(
    limb: Limb, rest_m: Floats, joints_m: Floats, global_xyzw: Floats, places_m: Floats
) -> Floats | None:
    """Rotations (2,4) of the limb's bones, each relative to its parent, that bring its second joint and its end to
    places_m (J,3); None where one of these is NaN.

    rest_m (J,3): joints in the T-pose; joints_m (J,3) and global_xyzw (J,4): the body as it is.
    """
    d1 = places_m[limb.lower] - joints_m[limb.upper]
    d2 = places_m[limb.end] - places_m[limb.lower]
    lengths = np.linalg.norm(d1), np.linalg.norm(d2)
    if not np.isfinite(lengths).all() or min(lengths) < 1e-3:
        return None
    d1, d2, hinge = d1 / lengths[0], d2 / lengths[1], np.array(limb.hinge)
    axis = np.cross(d1, d2)
    if np.linalg.norm(axis) < _STRAIGHT:
        axis = rotations.rotate(global_xyzw[limb.upper], hinge)
    bones = (rest_m[limb.lower] - rest_m[limb.upper], rest_m[limb.end] - rest_m[limb.lower])
    turned = np.stack(
        [_frame(d, axis) @ _frame(bone, hinge).T for d, bone in zip((d1, d2), bones, strict=True)]
    )
    upper, lower = rotations.from_matrix(turned)
    parent = global_xyzw[PARENTS[limb.upper]]
    return np.stack(
        [
            rotations.multiply(rotations.inverse(parent), upper),
            rotations.multiply(rotations.inverse(upper), lower),
        ]
    )


def _frame(along: Floats, axis: Floats) -> Floats:
    """Columns: along, the axis as far as it is across, and what is across both."""
    x = along / np.linalg.norm(along)
    y = axis - (axis @ x) * x
    y /= max(float(np.linalg.norm(y)), 1e-9)
    return np.stack([x, y, np.cross(x, y)], axis=-1)
