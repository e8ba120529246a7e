"""The shirt as the program reads it is the standard of calib/."""

import json

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.areas import ARM_AREAS, FOREARM_END, SHOULDER_END, TORSO_QUARTERS, Area
from mocapd.body.model import build_model
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.standard_shirt import N_COLOURS, N_PATCHES, standard_shirt


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


def test_each_patch_covers_the_area_of_its_number() -> None:
    names = [name.replace("cuff", "wrist").upper() for name in standard_shirt().patch_names]
    arms = [area for side in ARM_AREAS.values() for area in list(Area)[side]]
    assert [area.name for area in (*TORSO_QUARTERS, *arms)] == names
    assert [*TORSO_QUARTERS, *arms] == list(range(1, N_PATCHES + 1))


def test_every_colour_is_on_two_patches() -> None:
    counts = np.bincount(standard_shirt().colour_of_patch, minlength=N_COLOURS + 1)
    assert (counts[1:] == 2).all()


def test_arm_spans_follow_each_other() -> None:
    spans = standard_shirt().arm_fractions
    assert spans["shoulder"][1] == spans["upper_arm"][0]
    assert spans["upper_arm"][1] == 1.0
    assert spans["forearm"][0] == 0.0
    assert spans["forearm"][1] == spans["cuff"][0]
    assert spans["shoulder"][1] == SHOULDER_END
    assert spans["forearm"][1] == FOREARM_END


def test_a_body_in_the_shirt_shows_its_colours() -> None:
    model = build_model(1.66)
    labels = shirt_labels(model)
    np.testing.assert_array_equal(labels.label, standard_shirt().colour_of_patch[model.area])
    np.testing.assert_array_equal(labels.area, model.area)
    assert set(labels.label) == set(range(N_COLOURS + 1))
