"""The bones sent to a VMC receiver: the wearer's, or those of an avatar's file."""

from dataclasses import dataclass, replace

from mocapd.body.bones import other_side
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.quaternions import IDENTITY_XYZW
from mocapd.outputs.wire import Quaternion, Vector

Row = tuple[float, float, float, float]

_SAME_AXES: tuple[Row, Row, Row] = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
)


@dataclass(frozen=True, slots=True)
class Avatar:
    """Bones by VRM 1.0 name, the hips first, parents before their children; in the T-pose, axes of the world.

    parents: index of the nearest bone above, -1 for the hips. offsets_m: from the parent node, in that node's axes [m];
    unused for the hips. rest_xyzw: global rotation of each bone; from_above_xyzw: the inverse of the parent node's
    global rotation (in a file the parent node need not be a bone). hips_from_world: rows of the transform from the world
    into the axes of the node above the hips. hips_height_m: of the hips above the floor. is_straight: all those
    rotations are the identity.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets_m: tuple[Vector, ...]
    rest_xyzw: tuple[Quaternion, ...]
    from_above_xyzw: tuple[Quaternion, ...]
    hips_from_world: tuple[Row, Row, Row]
    hips_height_m: float
    is_straight: bool


def wearer_avatar(rest: RestSkeleton) -> Avatar:
    """The wearer's bones, without rotations in the T-pose."""
    straight = (IDENTITY_XYZW,) * len(rest.names)
    return Avatar(
        rest.names,
        rest.parents,
        rest.offsets_m,
        straight,
        straight,
        _SAME_AXES,
        rest.offsets_m[0][1],
        is_straight=True,
    )


def mirror_avatar(avatar: Avatar) -> Avatar:
    """Swaps the bone lengths of left and right, as in a mirror; for straight bones."""
    place = {name: k for k, name in enumerate(avatar.names)}
    others = [place.get(other_side(name), k) for k, name in enumerate(avatar.names)]
    return replace(
        avatar, offsets_m=tuple(map(reflect_position, (avatar.offsets_m[k] for k in others)))
    )


def reflect_position(position_m: Vector) -> Vector:
    """The mirror image at the plane x = 0."""
    x, y, z = position_m
    return -x, y, z
