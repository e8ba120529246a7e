"""The shirt as the program reads it is the standard of calib/."""

import json

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.shirt_patches import (
    N_COLOURS,
    N_PATCHES,
    SLEEVE_PATCHES,
    TORSO_PATCHES,
    ShirtPatch,
    standard_shirt,
)


def test_it_says_what_the_file_says() -> None:
    data = json.loads(asset_path("shirt_standard_v1.json").read_text())
    shirt = standard_shirt()
    assert shirt.version == data["version"]
    assert len(shirt.patch_names) == N_PATCHES
    assert len(shirt.colour_names) == N_COLOURS
    assert shirt.colour_of_patch[0] == 0
    for patch in data["patches"]:
        assert shirt.patch_names[patch["index"] - 1] == patch["name"]
        assert shirt.colour_of_patch[patch["index"]] == patch["colour"]
    for colour in data["colours"]:
        assert shirt.colour_names[colour["id"] - 1] == colour["name"]
        assert shirt.srgb[colour["id"] - 1].tolist() == colour["srgb"]


def test_patches_have_the_standard_s_names() -> None:
    names = standard_shirt().patch_names
    assert [patch.name.lower() for patch in ShirtPatch if patch] == list(names)
    covered = [
        *TORSO_PATCHES,
        *(p for side in SLEEVE_PATCHES.values() for p in list(ShirtPatch)[side]),
    ]
    assert covered == [patch for patch in ShirtPatch if patch]


def test_every_colour_is_on_two_patches() -> None:
    counts = np.bincount(standard_shirt().colour_of_patch, minlength=N_COLOURS + 1)
    assert (counts[1:] == 2).all()


def test_arm_spans_follow_each_other() -> None:
    spans = standard_shirt().arm_fractions
    assert spans["shoulder"][1] == spans["upper_arm"][0]
    assert spans["upper_arm"][1] == 1.0
    assert spans["forearm"][0] == 0.0
    assert spans["forearm"][1] == spans["cuff"][0]
