"""The keeper's body as points and capsules, from the joints of one frame.

Points are joints and three that lie beyond them: the crown and the tips of the hands. A limb is a capsule
between two points. Everything that the ball can touch is one of `LIMBS`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats, Ints

Bools = NDArray[np.bool_]

JOINTS = (
    "hips", "upperChest", "neck", "head",
    "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm", "rightLowerArm", "rightHand",
    "leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes",
    "rightUpperLeg", "rightLowerLeg", "rightFoot", "rightToes",
)  # fmt: skip
# A point beyond a joint: its name, the joint before, the joint, how far on in that direction [m].
_BEYOND = (
    ("crown", "neck", "head", 0.10),
    ("leftTip", "leftLowerArm", "leftHand", 0.13),
    ("rightTip", "rightLowerArm", "rightHand", 0.13),
)
POINTS = (*JOINTS, *(name for name, _, _, _ in _BEYOND))
INDEX = {name: i for i, name in enumerate(POINTS)}
FARTHEST_M = 50.0  # from the origin; who is farther away is no pose in a room


class Part(StrEnum):
    """What of the body stopped a ball."""

    HAND = "hand"
    ARM = "arm"
    BODY = "body"
    HEAD = "head"
    LEG = "leg"


@dataclass(frozen=True, slots=True)
class Limb:
    """A capsule: the two points between which it lies, and its radius [m]."""

    name: str
    part: Part
    start: str
    end: str
    radius_m: float


def _both_sides(name: str, part: Part, start: str, end: str, radius_m: float) -> tuple[Limb, ...]:
    return tuple(
        Limb(f"{side} {name}", part, side + start, side + end, radius_m)
        for side in ("left", "right")
    )


# Radii of an adult; those of the hands with gloves.
LIMBS = (
    *_both_sides("hand", Part.HAND, "Hand", "Tip", 0.075),
    *_both_sides("forearm", Part.ARM, "LowerArm", "Hand", 0.048),
    *_both_sides("upper arm", Part.ARM, "UpperArm", "LowerArm", 0.056),
    Limb("head", Part.HEAD, "head", "crown", 0.105),
    Limb("trunk", Part.BODY, "hips", "upperChest", 0.155),
    Limb("throat", Part.BODY, "upperChest", "neck", 0.10),
    Limb("shoulders", Part.BODY, "leftUpperArm", "rightUpperArm", 0.085),
    Limb("hips", Part.BODY, "leftUpperLeg", "rightUpperLeg", 0.10),
    *_both_sides("thigh", Part.LEG, "UpperLeg", "LowerLeg", 0.080),
    *_both_sides("shin", Part.LEG, "LowerLeg", "Foot", 0.060),
    *_both_sides("foot", Part.LEG, "Foot", "Toes", 0.050),
)
STARTS: Ints = np.array([INDEX[limb.start] for limb in LIMBS])
ENDS: Ints = np.array([INDEX[limb.end] for limb in LIMBS])
RADII_M: Floats = np.array([limb.radius_m for limb in LIMBS])


@dataclass(frozen=True, slots=True, eq=False)
class LimbPose:
    """points_m (P,3): in the order of POINTS [m]; known (P,): whether the frame had that point."""

    points_m: Floats
    known: Bools

    def point(self, name: str) -> Floats:
        """One point (3,) [m]."""
        point: Floats = self.points_m[INDEX[name]]
        return point

    def knows(self, *names: str) -> bool:
        """Whether all of these are known."""
        return all(bool(self.known[INDEX[name]]) for name in names)


def pose_of_joints(joints_m: Mapping[str, Sequence[float]]) -> LimbPose | None:
    """The pose of joints by VRM 1.0 name (three numbers each [m]); a joint that is absent, not finite or
    farther than FARTHEST_M is not known. None: there is nobody, as without hips or chest nothing stands."""
    points_m = np.zeros((len(POINTS), 3))
    known = np.zeros(len(POINTS), dtype=bool)
    for i, name in enumerate(JOINTS):
        given = joints_m.get(name)
        if given is not None and max(map(abs, given)) < FARTHEST_M and given[0] == given[0]:
            points_m[i], known[i] = given, True
    known &= np.isfinite(points_m).all(axis=1)
    points_m[~known] = 0.0
    for name, before, joint, on_m in _BEYOND:
        at, a, b = INDEX[name], INDEX[before], INDEX[joint]
        length_m = float(np.linalg.norm(points_m[b] - points_m[a]))
        if known[a] and known[b] and length_m > 1e-6:
            points_m[at] = points_m[b] + on_m * (points_m[b] - points_m[a]) / length_m
            known[at] = True
    if not (known[INDEX["hips"]] and known[INDEX["upperChest"]]):
        return None
    return LimbPose(points_m, known)


def known_limbs(pose: LimbPose) -> Bools:
    """(L,): of which limbs both points are known."""
    both: Bools = pose.known[STARTS] & pose.known[ENDS]
    return both
