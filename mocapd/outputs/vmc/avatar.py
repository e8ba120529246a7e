"""The bones that a VMC receiver is told of: the wearer's own, or those of an avatar's file."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.geometry.rotations import IDENTITY_XYZW
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.vmc.bone_names import other_side
from mocapd.types import Floats, Ints

_REFLECTED = np.array([-1.0, 1.0, 1.0])  # at the plane x = 0


@dataclass(frozen=True, slots=True, eq=False)
class Avatar:
    """Bones (B,) by VRM 1.0 name, the hips first, parents before their children; in the T-pose, axes of the world.

    parents (B,): the nearest bone above, -1 for the hips. offsets_m (B,3): from the node directly above, in that node's
    axes [m]; of the hips nothing is read. rest_xyzw (B,4): global rotation of the bone; from_above_xyzw (B,4): the inverse of
    that of the node directly above, which in a file need not be a bone. hips_from_world (4,4): into the axes of the node
    above the hips. hips_height_m: of the hips above the floor. is_straight: whether all those rotations are none.
    """

    names: tuple[str, ...]
    parents: Ints
    offsets_m: Floats
    rest_xyzw: Floats
    from_above_xyzw: Floats
    hips_from_world: Floats
    hips_height_m: float
    is_straight: bool


def wearer_avatar(rest: RestSkeleton) -> Avatar:
    """The wearer's own bones: straight in the T-pose, nothing between them."""
    straight = np.tile(IDENTITY_XYZW, (len(rest.names), 1))
    return Avatar(
        rest.names,
        np.array(rest.parents, dtype=np.int64),
        np.array(rest.offsets_m),
        straight,
        straight,
        np.eye(4),
        rest.offsets_m[0][1],
        is_straight=True,
    )


def mirrored(avatar: Avatar) -> Avatar:
    """Bones as long as those of the other side, as the person in a mirror has them; for straight bones."""
    place = {name: k for k, name in enumerate(avatar.names)}
    others = [place.get(other_side(name), k) for k, name in enumerate(avatar.names)]
    return replace(avatar, offsets_m=avatar.offsets_m[others] * _REFLECTED)
