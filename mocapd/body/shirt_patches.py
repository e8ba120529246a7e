"""The shirt's standard: its twenty patches by name, and which colour each has."""

import json
from dataclasses import dataclass
from enum import IntEnum
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mocapd.assets import asset_path

N_COLOURS = 10


class ShirtPatch(IntEnum):
    """Patches as `Surface.patch` numbers them; names are those of the standard's file."""

    NONE = 0
    TORSO_FRONT_UPPER_LEFT = 1
    TORSO_FRONT_UPPER_RIGHT = 2
    TORSO_FRONT_LOWER_LEFT = 3
    TORSO_FRONT_LOWER_RIGHT = 4
    TORSO_BACK_UPPER_LEFT = 5
    TORSO_BACK_UPPER_RIGHT = 6
    TORSO_BACK_LOWER_LEFT = 7
    TORSO_BACK_LOWER_RIGHT = 8
    LEFT_SHOULDER = 9
    LEFT_UPPER_ARM_FRONT = 10
    LEFT_UPPER_ARM_BACK = 11
    LEFT_FOREARM_FRONT = 12
    LEFT_FOREARM_BACK = 13
    LEFT_CUFF = 14
    RIGHT_SHOULDER = 15
    RIGHT_UPPER_ARM_FRONT = 16
    RIGHT_UPPER_ARM_BACK = 17
    RIGHT_FOREARM_FRONT = 18
    RIGHT_FOREARM_BACK = 19
    RIGHT_CUFF = 20


N_PATCHES = len(ShirtPatch) - 1
N_LABELS = N_PATCHES + 1  # counts per patch have a place for what is no shirt, too
TORSO_PATCHES = tuple(patch for patch in ShirtPatch if patch.name.startswith("TORSO"))
SLEEVE_PATCHES = {
    "left": slice(ShirtPatch.LEFT_SHOULDER, ShirtPatch.LEFT_CUFF + 1),
    "right": slice(ShirtPatch.RIGHT_SHOULDER, ShirtPatch.RIGHT_CUFF + 1),
}


@dataclass(frozen=True, slots=True, eq=False)
class Shirt:
    """patch_names[p-1] and colour_of_patch[p] for patch p = 1..20 (index 0: not shirt, colour 0); srgb (10,3) uint8."""

    version: str
    patch_names: tuple[str, ...]
    colour_names: tuple[str, ...]
    colour_of_patch: NDArray[np.uint8]  # (21,)
    srgb: NDArray[np.uint8]  # (10, 3)
    arm_fractions: dict[str, tuple[float, float]]


@cache
def standard_shirt() -> Shirt:
    """The shirt standard-v1 of calib/."""
    data = json.loads(asset_path("shirt_standard_v1.json").read_text())
    patches = sorted(data["patches"], key=lambda patch: int(patch["index"]))
    colours = sorted(data["colours"], key=lambda colour: int(colour["id"]))
    return Shirt(
        version=data["version"],
        patch_names=tuple(patch["name"] for patch in patches),
        colour_names=tuple(colour["name"] for colour in colours),
        colour_of_patch=np.array([0] + [patch["colour"] for patch in patches], dtype=np.uint8),
        srgb=np.array([colour["srgb"] for colour in colours], dtype=np.uint8),
        arm_fractions={name: tuple(span) for name, span in data["arm_fractions"].items()},
    )
