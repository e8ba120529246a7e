"""The whole body's regions: what looks alike, whatever is worn."""

import numpy as np
import pytest

from mocapd.body.areas import TORSO_QUARTERS, Area
from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import LEFT_ARM, RIGHT_ARM
from mocapd.tracking.cues.clothes.regions import (
    Band,
    Region,
    region_labels,
    regions,
    silhouette_labels,
)

BODY = build_model(1.75, full_body())


def test_every_region_is_where_it_should_be() -> None:
    of, centres = regions(BODY), BODY.centres_m
    rest = BODY.rest_m
    assert set(of.tolist()) == {int(part) for part in (*Region, *Band)}
    head = (of == Region.FACE) | (of == Region.HAIR)
    assert centres[head, 1].min() > rest[INDEX["leftUpperArm"], 1] - 0.05
    assert centres[of == Region.FACE, 2].min() > centres[head, 2].mean()
    assert centres[of == Region.HAIR, 1].max() > centres[of == Region.FACE, 1].max() + 0.03
    assert np.abs(centres[of == Region.HAND, 0]).min() > rest[INDEX["leftHand"], 0] - 0.06
    assert centres[of == Region.FOOT, 1].max() < rest[INDEX["leftFoot"], 1] + 0.02
    elbow = rest[INDEX["leftLowerArm"], 0]
    assert np.abs(centres[of == Region.FOREARM, 0]).min() > elbow - 0.06
    assert np.abs(centres[of == Region.TRUNK, 0]).max() < elbow + 0.06


def test_bands_follow_each_other_from_the_limbs_on() -> None:
    of, centres = regions(BODY), BODY.centres_m
    height = {
        band: centres[of == band, 1].mean() for band in (Band.LOW_HIPS, Band.HIGH_HIPS, Band.WAIST)
    }
    assert height[Band.LOW_HIPS] < BODY.rest_m[INDEX["leftUpperLeg"], 1] < height[Band.WAIST]
    assert height[Band.LOW_HIPS] < height[Band.HIGH_HIPS] < height[Band.WAIST]
    outwards = [
        np.abs(centres[of == part, 0]).mean()
        for part in (Band.HIGH_SLEEVE, Band.LOW_SLEEVE, Region.FOREARM)
    ]
    assert outwards == sorted(outwards)


def test_left_and_right_are_alike() -> None:
    of = regions(BODY)
    for region in (*Region, *Band):
        x = BODY.centres_m[of == region, 0]
        assert abs(np.count_nonzero(x > 0.0) - np.count_nonzero(x < 0.0)) <= 0.02 * len(x)


def test_labels_are_the_regions_or_one_for_all() -> None:
    of, worn = regions(BODY), region_labels(BODY).label
    assert np.array_equal(worn[of <= max(Region)], of[of <= max(Region)])
    assert set(worn.tolist()) == {int(region) for region in Region}
    assert set(silhouette_labels(BODY).label.tolist()) == {1}


def test_a_body_without_legs_is_refused() -> None:
    with pytest.raises(ValueError, match="no legs"):
        region_labels(build_model(1.75))


def test_pixels_are_counted_by_limb() -> None:
    of, centres = region_labels(BODY).area, BODY.centres_m
    knee = BODY.rest_m[INDEX["leftLowerLeg"], 1]
    for thigh, shin, side in (
        (Area.LEFT_THIGH, Area.LEFT_SHIN, 1.0),
        (Area.RIGHT_THIGH, Area.RIGHT_SHIN, -1.0),
    ):
        assert (side * centres[(of == thigh) | (of == shin), 0] > -0.02).all()
        assert centres[of == thigh, 1].mean() > knee > centres[of == shin, 1].mean()
    assert centres[of == Area.HEAD, 1].min() > centres[of == Area.TORSO, 1].mean()
    assert not np.isin(of, TORSO_QUARTERS).any()
    on_arms = np.isin(BODY.part, (LEFT_ARM, RIGHT_ARM))
    sleeves = on_arms & (BODY.area >= Area.LEFT_SHOULDER)
    assert (of[sleeves] == BODY.area[sleeves]).all()
    trunk = on_arms & (BODY.area > 0) & ~sleeves
    assert (of[trunk] == Area.TORSO).all()
    assert set(of[on_arms & (BODY.area == 0)].tolist()) == {Area.LEFT_WRIST, Area.RIGHT_WRIST}
