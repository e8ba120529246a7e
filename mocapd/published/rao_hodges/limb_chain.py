"""A limb as ellipsoids that hang on each other, with one angle for each degree of freedom.

Angles turn about axes of the T-pose, which are those of the root at rest: x to the person's left, y up, z forwards.
A thigh turns by Rz Ry Rx, an upper arm by Rx Ry Rz, so that hanging and raised limbs stay away from the singularity,
at 90 degrees of the middle angle. Knee and ankle turn about x. The elbow turns about the axis of its hinge in the T-pose,
positive where it bends.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.types import Floats, Ints, Skeleton

LEG_BONES = ("UpperLeg", "LowerLeg", "Foot")
ARM_BONES = ("UpperArm", "LowerArm")
_X, _Y, _Z = np.eye(3)

# Half widths and depths in statures, cloth included, as `body.leg_tubes` and `body.arm_tubes` have them. Thigh, shank
# and upper arm reach a little past both joints, so that no points between two ellipsoids are left out.
_OVERLAP = 1.08
_THIGH, _SHANK = (0.054, 0.058), (0.035, 0.038)
_UPPER_ARM = (0.035, 0.037)
_FOREARM = (0.023, 0.027)  # with the hand, which is flat and faces down
_HAND_LENGTH = 0.085
_FOOT = (0.029, 0.027, 0.080)  # half width, height and length of a shoe
_FOOT_CENTRE = (0.0, -0.022, 0.033)  # from the ankle
_ABDOMEN, _CHEST, _HEAD = (0.094, 0.110, 0.070), (0.100, 0.105, 0.070), (0.046, 0.068, 0.058)
_ABDOMEN_UP, _CHEST_UP = 0.18, 0.68  # of the way from the hips to the neck
_HEAD_FROM_JOINT = (0.0, 0.048, 0.012)


class ChainArrays(NamedTuple):
    """E ellipsoids, D degrees of freedom, for kernels. parents (E,), -1: hangs on the root; joints_m (E,3): the joint at
    which an ellipsoid turns, from its parent's joint or the root's, in the T-pose; first_dof (E+1,): the angles of
    ellipsoid e are first_dof[e] to first_dof[e + 1]; axes (D,3); centres_m (E,3) from the joint; radii_m (E,3)."""

    parents: Ints
    joints_m: Floats
    first_dof: Ints
    axes: Floats
    centres_m: Floats
    radii_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """One ellipsoid, whose parts are those of `ChainArrays`; dofs: the kind and the axis of each of its angles."""

    bone: str
    parent: int
    joint_m: Floats
    dofs: tuple[tuple[str, Floats], ...]
    centre_m: Floats
    radii_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class LimbChain:
    """One or several limbs that share a root. bones (E,): the bone of each ellipsoid's rotation; kinds (D,): the angle's
    name in the tables of `limb_motion`, without its side; mirrored (D,): on the right side, where angles about y and z
    have the opposite sign."""

    name: str
    segments: tuple[Segment, ...]
    bones: tuple[str, ...]
    kinds: tuple[str, ...]
    mirrored: tuple[bool, ...]
    arrays: ChainArrays

    @property
    def n_dof(self) -> int:
        """How many angles there are."""
        return len(self.kinds)


def legs(skeleton: Skeleton, stature_m: float) -> LimbChain:
    """Both legs: six ellipsoids, ten angles. The root of every chain is the hips joint."""
    return _chain("legs", _joined([_leg(skeleton, side, stature_m) for side in ("left", "right")]))


def arm(skeleton: Skeleton, stature_m: float, side: str) -> LimbChain:
    """One arm: two ellipsoids, four angles."""
    return _chain(f"{side}_arm", _arm(skeleton, side, stature_m))


def trunk(skeleton: Skeleton, stature_m: float) -> LimbChain:
    """Abdomen, chest and head, which are rigid: three ellipsoids, no angles."""
    return _chain("trunk", _trunk(skeleton, stature_m))


def whole_body(parts: Sequence[LimbChain]) -> LimbChain:
    """Chains of one root as one chain, with their angles concatenated."""
    return _chain("whole", _joined([part.segments for part in parts]))


def _joined(parts: Sequence[Sequence[Segment]]) -> list[Segment]:
    out: list[Segment] = []
    for part in parts:
        first = len(out)
        out += [replace(s, parent=s.parent + first) if s.parent >= 0 else s for s in part]
    return out


def _leg(skeleton: Skeleton, side: str, h: float) -> list[Segment]:
    hips, hip, knee, ankle = (
        skeleton.rest_m[INDEX[bone]] for bone in ("hips", *(side + bone for bone in LEG_BONES))
    )
    thigh = (("hip_z", _Z), ("hip_y", _Y), ("hip_x", _X))
    return [
        Segment(side + "UpperLeg", -1, hip - hips, thigh, 0.5 * (knee - hip), _vertical_radii(hip - knee, _THIGH, h)),
        Segment(side + "LowerLeg", 0, knee - hip, (("knee_x", _X),), 0.5 * (ankle - knee),
                _vertical_radii(knee - ankle, _SHANK, h)),
        Segment(side + "Foot", 1, ankle - knee, (("ankle_x", _X),), np.array(_FOOT_CENTRE) * h,
                np.array(_FOOT) * h),
    ]  # fmt: skip


def _trunk(skeleton: Skeleton, h: float) -> list[Segment]:
    hips, neck, head = (skeleton.rest_m[INDEX[bone]] for bone in ("hips", "neck", "head"))
    spots = (
        ("hips", hips + _ABDOMEN_UP * (neck - hips), _ABDOMEN),
        ("chest", hips + _CHEST_UP * (neck - hips), _CHEST),
        ("head", head + np.array(_HEAD_FROM_JOINT) * h, _HEAD),
    )
    return [
        Segment(bone, -1, np.zeros(3), (), middle - hips, np.array(radii) * h)
        for bone, middle, radii in spots
    ]


def _vertical_radii(bone_m: Floats, half: tuple[float, float], h: float) -> Floats:
    along = 0.5 * _OVERLAP * float(np.linalg.norm(bone_m))
    return np.array([half[0] * h, along, half[1] * h])


def _arm(skeleton: Skeleton, side: str, h: float) -> list[Segment]:
    shoulder, elbow, wrist = (skeleton.rest_m[INDEX[side + bone]] for bone in (*ARM_BONES, "Hand"))
    upper, fore = float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(wrist - elbow))
    out = 1.0 if side == "left" else -1.0
    turns = (("shoulder_x", _X), ("shoulder_y", _Y), ("shoulder_z", _Z))
    reach = 0.5 * (fore + _HAND_LENGTH * h)
    return [
        Segment(side + "UpperArm", -1, shoulder - skeleton.rest_m[0], turns, 0.5 * (elbow - shoulder),
                np.array([0.5 * _OVERLAP * upper, _UPPER_ARM[0] * h, _UPPER_ARM[1] * h])),
        Segment(side + "LowerArm", 0, elbow - shoulder, (("elbow", -out * _Y),), (wrist - elbow) * (reach / fore),
                np.array([reach, _FOREARM[0] * h, _FOREARM[1] * h])),
    ]  # fmt: skip


def _chain(name: str, segments: list[Segment]) -> LimbChain:
    dofs = [(segment.bone, kind) for segment in segments for kind, _ in segment.dofs]
    arrays = ChainArrays(
        np.array([segment.parent for segment in segments], np.int64),
        np.array([segment.joint_m for segment in segments]),
        np.cumsum([0, *(len(segment.dofs) for segment in segments)]).astype(np.int64),
        np.array([axis for segment in segments for _, axis in segment.dofs]).reshape(-1, 3),
        np.array([segment.centre_m for segment in segments]),
        np.array([segment.radii_m for segment in segments]),
    )
    kinds = tuple(kind for _, kind in dofs)
    mirrored = tuple(bone.startswith("right") and kind[-2:] in ("_y", "_z") for bone, kind in dofs)
    bones = tuple(segment.bone for segment in segments)
    return LimbChain(name, tuple(segments), bones, kinds, mirrored, arrays)
