"""Unity's HumanBodyBones and what hangs on what, and the two products that every receiver needs.

Written again here rather than imported, so that a mistake in mocapd's own tables or mathematics
is not made twice.
"""

from collections.abc import Mapping, Sequence

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # x y z w
Transform = tuple[Vector, Quaternion]

ORIGIN: Transform = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))

_SIDE = {
    "UpperLeg": "Hips", "LowerLeg": "UpperLeg", "Foot": "LowerLeg", "Toes": "Foot",
    "Shoulder": "UpperChest", "UpperArm": "Shoulder", "LowerArm": "UpperArm", "Hand": "LowerArm",
    **{
        finger + part: above
        for finger in ("Thumb", "Index", "Middle", "Ring", "Little")
        for part, above in (
            ("Proximal", "Hand"), ("Intermediate", f"{finger}Proximal"), ("Distal", f"{finger}Intermediate"),
        )
    },
}  # fmt: skip
_MIDDLE = ("Hips", "UpperChest")

# Parents before their children
PARENT_OF: Mapping[str, str | None] = {
    "Hips": None, "Spine": "Hips", "Chest": "Spine", "UpperChest": "Chest", "Neck": "UpperChest", "Head": "Neck",
    "LeftEye": "Head", "RightEye": "Head", "Jaw": "Head",
    **{
        side + bone: above if above in _MIDDLE else side + above
        for side in ("Left", "Right")
        for bone, above in _SIDE.items()
    },
}  # fmt: skip


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """First b, then a; the same algebra in left-handed and right-handed axes."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(q: Quaternion, v: Vector) -> Vector:
    """q v q*, for unit quaternions."""
    x, y, z, w = q
    turned = multiply(multiply(q, (*v, 0.0)), (-x, -y, -z, w))
    return turned[:3]


def combined(parent: Transform, local: Transform) -> Transform:
    """A transform in the frame of its parent's parent."""
    (at, turn), (offset, own) = parent, local
    moved = rotated(turn, offset)
    return (at[0] + moved[0], at[1] + moved[1], at[2] + moved[2]), multiply(turn, own)


def chained(
    locals_: Mapping[str, Transform],
    root: Transform = ORIGIN,
    bones: Sequence[str] = tuple(PARENT_OF),
) -> dict[str, Transform]:
    """Bones that an avatar has, chained from its root: as Unity's and Unreal's hierarchies are posed.

    `locals_` has a transform for each of `bones`; the parent of a bone is the nearest above it that is one of them.
    """
    world: dict[str, Transform] = {}
    for bone in bones:
        above = PARENT_OF[bone]
        while above is not None and above not in world:
            above = PARENT_OF[above]
        world[bone] = combined(root if above is None else world[above], locals_[bone])
    return world
