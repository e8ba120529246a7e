"""The shirt's standard: its twenty patches, one for each `Area` of trunk and arms, and which colour each has."""

import json
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mocapd.assets import asset_path

N_COLOURS = 10
N_PATCHES = 20


@dataclass(frozen=True, slots=True, eq=False)
class Shirt:
    """patch_names[p-1] and colour_of_patch[p] for patch p = 1..20, the number of its `Area` (index 0: not shirt, colour 0);
    srgb (10,3) uint8."""

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
