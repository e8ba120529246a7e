"""Avatars of unlike legs, as mocapd_feet.gd is given them."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from mocapd.types import Floats
from tests.golden import stepping_left
from tests.outputs.receivers.godot_xr_body import reference_axes
from tests.outputs.receivers.humanoid import PARENT_OF

LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")
ON_FLOOR = ("Foot", "Toes")


def godot_name(bone: str) -> str:
    return bone[0].upper() + bone[1:]


def wearer_offsets_m() -> dict[str, Floats]:
    """An avatar of the wearer's own bones: places relative to the parent's in the T-pose, of the hips from the floor."""
    rest = stepping_left.rest()
    return {
        godot_name(name): np.array(offset_m)
        for name, offset_m in zip(rest.names, rest.offsets_m, strict=True)
    }


def _with_legs(hips_m: float, **of_the_left_m: tuple[float, float, float]) -> dict[str, Floats]:
    legs = {
        side + part: np.array(at_m) * (1.0 if side == "Left" else -1.0, 1.0, 1.0)
        for side in ("Left", "Right")
        for part, at_m in of_the_left_m.items()
    }
    return wearer_offsets_m() | {"Hips": np.array((0.0, hips_m, 0.0))} | legs


AVATARS: Mapping[str, Mapping[str, Floats]] = {
    "the wearer": wearer_offsets_m(),
    # the reference pose of SkeletonProfileHumanoid: ankles on the floor, legs that begin beside the hips
    "the reference": _with_legs(
        0.75,
        UpperLeg=(0.1, 0.0, 0.0),
        LowerLeg=(0.0, -0.375, 0.0),
        Foot=(0.0, -0.375, 0.0),
        Toes=(0.0, 0.0, 0.15),
    ),
    # short thighs that begin far below the hips, and high heels
    "in boots": _with_legs(
        1.1,
        UpperLeg=(0.12, -0.2, 0.02),
        LowerLeg=(0.0, -0.3, 0.01),
        Foot=(0.0, -0.42, 0.0),
        Toes=(0.01, -0.1, 0.12),
    ),
}


def heights_m(offsets_m: Mapping[str, Floats]) -> dict[str, float]:
    """Of feet and toes over the floor in the T-pose, by the avatar's names."""
    out = {}
    for side in ("Left", "Right"):
        at_m = float(offsets_m["Hips"][1])
        for part in LEG:
            at_m += float(offsets_m[side + part][1])
            if part in ON_FLOOR:
                out[side + part] = at_m
    return out


def as_given(offsets_m: Mapping[str, Floats]) -> dict[str, dict[str, Any]]:
    """By VRM 1.0 name: each bone's place in the axes of the bone above, and what of it is how high."""
    axes = reference_axes(offsets_m)
    above = {
        side + part: PARENT_OF[side + part] or "" for side in ("Left", "Right") for part in LEG
    }
    return {
        "rests_m": {
            bone[0].lower() + bone[1:]: (axes[parent].T @ offsets_m[bone]).tolist()
            for bone, parent in above.items()
        },
        "heights_m": {b[0].lower() + b[1:]: at_m for b, at_m in heights_m(offsets_m).items()},
    }
