"""Body lengths that a user can check with a tape measure."""

from mocapd.body.shape import BodyShape, skeleton_of


def lengths_cm(shape: BodyShape) -> dict[str, float]:
    """By name, between the centres of joints [cm]."""
    skeleton = skeleton_of(shape)
    at = {name: skeleton.rest_m[i] for i, name in enumerate(skeleton.names)}

    def length_cm(a: str, b: str) -> float:
        return float(100.0 * sum((at[a] - at[b]) ** 2) ** 0.5)

    upper = length_cm("leftUpperArm", "leftLowerArm")
    fore = length_cm("leftLowerArm", "leftHand")
    return {
        "shoulder to shoulder": length_cm("leftUpperArm", "rightUpperArm"),
        "upper arm": upper,
        "forearm": fore,
        "arm to the wrist": upper + fore,
        "hips to neck": length_cm("hips", "neck"),
    }
