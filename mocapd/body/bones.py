"""The bones of a VRM 1.0 humanoid that are tracked, and how they hang together; imports nothing, for clients."""

NAMES = (
    "hips", "spine", "chest", "upperChest", "neck", "head",
    "leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand",
    "leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes",
    "rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand",
    "rightUpperLeg", "rightLowerLeg", "rightFoot", "rightToes",
)  # fmt: skip
PARENT_OF = {
    "spine": "hips", "chest": "spine", "upperChest": "chest", "neck": "upperChest", "head": "neck",
    "leftShoulder": "upperChest", "leftUpperArm": "leftShoulder", "leftLowerArm": "leftUpperArm",
    "leftHand": "leftLowerArm", "leftUpperLeg": "hips", "leftLowerLeg": "leftUpperLeg",
    "leftFoot": "leftLowerLeg", "leftToes": "leftFoot",
    "rightShoulder": "upperChest", "rightUpperArm": "rightShoulder", "rightLowerArm": "rightUpperArm",
    "rightHand": "rightLowerArm", "rightUpperLeg": "hips", "rightLowerLeg": "rightUpperLeg",
    "rightFoot": "rightLowerLeg", "rightToes": "rightFoot",
}  # fmt: skip


def other_side(bone: str) -> str:
    """`leftHand` to `rightHand` and back; a bone in the middle is its own."""
    if bone.startswith("left"):
        return "right" + bone[4:]
    return "left" + bone[5:] if bone.startswith("right") else bone
