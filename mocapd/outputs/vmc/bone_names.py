"""VRM 1.0 bone names: Unity's spelling, the opposite side, and leaf bones.

VMC names bones as Unity's HumanBodyBones, where case matters. VRM 0.x counts the thumb as Unity
does, VRM 1.0 begins it with the metacarpal. Sources: VMC protocol specification;
vrm-c/vrm-specification humanoid.md.
"""

_FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
_THUMB_BELOW = {"ThumbMetacarpal": "ThumbProximal", "ThumbProximal": "ThumbIntermediate"}
_THUMB_ABOVE = {unity: vrm for vrm, unity in _THUMB_BELOW.items()}


def unity_name(bone: str) -> str:
    """As Unity spells it: hips is Hips, leftThumbMetacarpal is LeftThumbProximal."""
    name = bone[:1].upper() + bone[1:]
    for side in ("Left", "Right"):
        if name.startswith(side):
            return side + _THUMB_BELOW.get(name[len(side) :], name[len(side) :])
    return name


def vrm1_name(bone: str) -> str:
    """A bone of VRM 0.x by its name in VRM 1.0."""
    for side in ("left", "right"):
        if bone.startswith(side):
            return side + _THUMB_ABOVE.get(bone[len(side) :], bone[len(side) :])
    return bone


def is_leaf(bone: str) -> bool:
    """True for toes, fingers, eyes and jaw, which are not sent while untracked.

    A receiver leaves a missing bone in its avatar's own pose; a rotation of zero would deform it.
    """
    return bone == "jaw" or bone.endswith(("Toes", "Eye")) or any(f in bone for f in _FINGERS)
