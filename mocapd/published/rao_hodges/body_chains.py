"""A whole body as chains of ellipsoids, and the pose of the skeleton that their angles give."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.published.rao_hodges.limb_angles import arm_angles, legs_angles
from mocapd.published.rao_hodges.limb_chain import LimbChain, arm, legs, trunk, whole_body
from mocapd.published.rao_hodges.limb_weight import pose_limb
from mocapd.types import Floats, Pose

LIMBS = ("legs", "left_arm", "right_arm")  # in the order in which they are tracked
# joints that turn with the bone of an ellipsoid besides that bone's own
_WITH = {"Foot": "Toes", "LowerArm": "Hand"}


@dataclass(frozen=True, slots=True, eq=False)
class BodyPlace:
    """root_m (3,), root_turn (3,3): the hips; angles (18,): of LIMBS, one after the other [rad]."""

    root_m: Floats
    root_turn: Floats
    angles: Floats

    def with_limb(self, part: slice, angles: Floats) -> "BodyPlace":
        """The same with other angles of one limb."""
        every = self.angles.copy()
        every[part] = angles
        return replace(self, angles=every)


@dataclass(frozen=True, slots=True, eq=False)
class BodyChains:
    """The chains of one person. whole: trunk and limbs; parts: the angles of each limb in the whole's."""

    shape: BodyShape
    trunk: LimbChain
    limbs: dict[str, LimbChain]
    whole: LimbChain
    parts: dict[str, slice]
    hips_height_m: float  # in the T-pose


def body_chains(shape: BodyShape) -> BodyChains:
    """Of a person of this shape."""
    skeleton, h = skeleton_of(shape), shape.stature_m
    limbs = {
        "legs": legs(skeleton, h),
        **{f"{side}_arm": arm(skeleton, h, side) for side in ("left", "right")},
    }
    middle = trunk(skeleton, h)
    ends = np.cumsum([0, *(chain.n_dof for chain in limbs.values())]).tolist()
    parts = {name: slice(a, b) for name, a, b in zip(limbs, ends, ends[1:], strict=False)}
    whole = whole_body([middle, *limbs.values()])
    return BodyChains(shape, middle, limbs, whole, parts, float(skeleton.rest_m[0, 1]))


def pose_of(body: BodyChains, place: BodyPlace) -> Pose:
    """The skeleton's pose: spine, neck and collar bones turn with the hips, hands and toes with the bone above."""
    R = pose_limb(body.whole, place.angles, place.root_turn, place.root_m).R[0]
    every = np.broadcast_to(place.root_turn, (N_JOINTS, 3, 3)).copy()
    for bone, turned in zip(body.whole.bones, R, strict=True):
        every[_turned_with(bone)] = turned
    return Pose(place.root_m.copy(), rotations.from_matrix(every))


def place_of(pose: Pose) -> BodyPlace:
    """The angles that come nearest to a skeleton's pose."""
    quats = pose.quats_xyzw[None]
    angles = np.concatenate(
        [legs_angles(quats)[0], *(arm_angles(quats, side)[0] for side in ("left", "right"))]
    )
    return BodyPlace(pose.root_m.copy(), rotations.to_matrix(pose.quats_xyzw[0]), angles)


def by_joint(body: BodyChains, values: Floats) -> Floats:
    """(J,): of each joint the value (E,) of the ellipsoid that it turns with; of the trunk's joints the abdomen's."""
    out = np.full(N_JOINTS, values[0])
    for bone, value in zip(body.whole.bones, values, strict=True):
        out[_turned_with(bone)] = value
    return out


def _turned_with(bone: str) -> list[int]:
    """The joints that turn with the bone of an ellipsoid."""
    names = [bone, *(bone.replace(above, below) for above, below in _WITH.items() if above in bone)]
    return [INDEX[name] for name in names]
