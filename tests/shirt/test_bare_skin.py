"""Skin: where the face is in a picture, what is learned there, and that it is no colour of the shirt."""

import numpy as np

from mocapd.body.arrays import plain
from mocapd.fit.solver import Fitter
from mocapd.shirt.segmentation import shirt_appearance as looks
from mocapd.shirt.segmentation.bare_skin import (
    add_statistics,
    face_disc,
    hand_sized,
    statistics,
    whitening,
)
from mocapd.shirt.segmentation.cell_kernels import (
    CELL,
    ClassifierWeights,
    LearnedPixels,
    classify,
)
from mocapd.shirt.segmentation.segmentation_kernels import bare_pixels
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes, Floats
from tests.fit.synthetic import CAMERAS, FACTOR, STATURE_M, fitter, standing

SKIN_RGB = np.array([0.80, 0.60, 0.52])
PINK = 1 + int(np.abs(standard_shirt().srgb / 255.0 - SKIN_RGB).sum(axis=1).argmin())
NO_SHIRT = np.zeros((60, 60), np.uint8)


def posed(by: Fitter, yaw_rad: float, camera: int) -> None:
    drawing = by.drawings[camera]
    state = standing("hanging", "hanging", yaw_rad)
    drawing.pose(state.root_m, state.local_xyzw, by.shaper(state.factors).rest)


def picture(rgb: Floats, noise: float = 0.02) -> Bytes:
    """(60,60,3) BGR of one colour."""
    rng = np.random.default_rng(0)
    seen = rgb + rng.normal(0.0, noise, (60, 60, 3))
    return (np.clip(seen, 0.0, 1.0)[..., ::-1] * 255).round().astype(np.uint8)


def test_the_face_is_above_the_shirt_where_it_is_seen() -> None:
    by = fitter(3)
    for camera in (0, 1):
        posed(by, 0.2, camera)
        drawing = by.drawings[camera]
        disc = face_disc(drawing.camera, drawing.posed, STATURE_M, FACTOR)
        assert disc is not None
        x, y, radius = disc
        state = standing("hanging", "hanging", 0.2)
        roi = drawing.region(state, 0.0, 0)
        assert roi is not None
        ids = drawing.render(state, 0.0, roi)
        top = roi[1] + int(np.flatnonzero((ids > 0).any(axis=1))[0])
        assert y + 0.5 * radius < top
        assert y > top - 25.0  # within a head's height at 2.5 m
        assert roi[0] < x < roi[2]
        assert 2.0 < radius < 10.0


def test_who_turns_away_shows_no_face() -> None:
    by = fitter(3)
    posed(by, 0.2, 2)
    behind = by.drawings[2]
    assert face_disc(behind.camera, behind.posed, STATURE_M, FACTOR) is None
    posed(by, np.pi, 2)
    assert face_disc(behind.camera, behind.posed, STATURE_M, FACTOR) is not None
    assert CAMERAS[2].name == "behind"


def test_only_what_can_be_skin_is_learned() -> None:
    disc, W = (30.0, 30.0, 8.0), np.eye(3)
    skin = statistics(picture(SKIN_RGB), NO_SHIRT, (0, 0), disc, W)
    assert skin[0] > 100
    np.testing.assert_allclose(skin[3:0:-1] / skin[0], SKIN_RGB, atol=0.01)
    for other in ([0.2, 0.5, 0.2], [0.3, 0.3, 0.8], [0.04, 0.03, 0.03], [0.6, 0.6, 0.6]):
        assert statistics(picture(np.array(other)), NO_SHIRT, (0, 0), disc, W)[0] == 0
    # an arm before the face
    covered = np.full((60, 60), 3, np.uint8)
    assert statistics(picture(SKIN_RGB), covered, (0, 0), disc, W)[0] == 0
    # outside of what was drawn
    assert statistics(picture(SKIN_RGB), NO_SHIRT, (100, 100), disc, W)[0] == 0


def test_in_another_light_it_is_known_by_the_white_balance() -> None:
    light = np.diag([0.5, 0.7, 1.0])  # a blue lamp
    seen = picture(light @ SKIN_RGB)
    disc = (30.0, 30.0, 8.0)
    assert statistics(seen, NO_SHIRT, (0, 0), disc, np.linalg.inv(light))[0] > 100
    assert statistics(seen, NO_SHIRT, (0, 0), disc, np.eye(3))[0] == 0


def test_it_follows_the_light() -> None:
    sums = np.zeros(4)
    bright = np.array([50.0, 20.0, 25.0, 35.0])
    for _ in range(30):
        sums = add_statistics(sums, bright, 0.1, 1.0)
    np.testing.assert_allclose(sums[1:] / sums[0], bright[1:] / 50.0)
    dark = bright * np.array([1.0, 0.5, 0.5, 0.5])
    for _ in range(30):
        sums = add_statistics(sums, dark, 0.1, 1.0)
    np.testing.assert_allclose(sums[1:] / sums[0], dark[1:] / 50.0, rtol=0.1)
    np.testing.assert_array_equal(add_statistics(sums, np.zeros(4), 0.1, 1.0), sums)


def classified(seen: Bytes, skin: Floats) -> Bytes:
    """Ids of a picture in which every colour is expected everywhere."""
    h, w = seen.shape[:2]
    mean, covariance = looks.gaussians(
        looks.fresh(np.eye(3)),
        standard_shirt().srgb / 255.0,
        np.zeros((10, 3, 3)),
        0.04,
        0.015,
        0.25,
    )
    nothing = np.zeros(1 << 15, np.float32)
    known = LearnedPixels(
        np.zeros((h, w, 3), np.float32), np.zeros((h, w), np.uint8), nothing, nothing
    )
    ids, weight = np.empty((h, w), np.uint8), np.empty((h, w), np.uint8)
    classify(
        seen, 0, 0, np.zeros((h // CELL, w // CELL, 10), np.uint8), looks.whitening(mean, covariance),
        whitening(skin, 0.04, 0.015, 0.25), plain(known),
        plain(ClassifierWeights(0.05, 3.0, 0.05, 1.5, 1.5, 0.3, 0.25, 0.5)), ids, weight,
    )  # fmt: skip
    return ids


def test_skin_is_no_colour_of_the_shirt_and_the_shirt_stays_what_it_is() -> None:
    own = standard_shirt().srgb[PINK - 1] / 255.0
    between = 0.2 * own + 0.8 * SKIN_RGB
    unknown = np.zeros(4)
    known = np.concatenate([[100.0], 100.0 * SKIN_RGB[::-1]])
    assert (classified(picture(between), unknown) > 0).mean() > 0.9
    assert (classified(picture(between), known) > 0).mean() < 0.2
    for k, rgb in enumerate(standard_shirt().srgb / 255.0, start=1):
        assert (classified(picture(rgb), known) == k).mean() > 0.95


def test_skin_seen_too_little_is_not_believed() -> None:
    few = np.concatenate([[10.0], 10.0 * SKIN_RGB[::-1]])
    seen = picture(SKIN_RGB)
    np.testing.assert_array_equal(classified(seen, few), classified(seen, np.zeros(4)))


def test_bare_is_what_looks_like_skin_and_is_neither_shirt_nor_background() -> None:
    affine = whitening(np.array([100.0, *(100.0 * SKIN_RGB[::-1])]), 0.04, 0.015, 0.25)
    seen = picture(SKIN_RGB)
    seen[:, 40:] = picture(np.array([0.1, 0.3, 0.8]))[:, 40:]
    ids = np.zeros((40, 50), np.uint8)
    ids[:10] = PINK
    mean, age = seen.astype(np.float32), np.zeros((60, 60), np.uint8)
    age[40:] = 255  # here the wall is known, and of the colour of skin
    out = np.empty(ids.shape, np.bool_)
    bare_pixels(seen, 0, 10, ids, affine, 3.0, mean, age, 14.0, out)
    assert out[10:30, :40].mean() > 0.95
    assert not out[:10].any()
    assert not out[30:].any()
    assert out[:, 40:].mean() < 0.01


def test_a_wall_of_the_colour_of_skin_and_specks_are_no_hand() -> None:
    may_be = np.zeros((100, 100), np.bool_)
    hand = np.s_[10:20, 10:18]
    may_be[hand] = True
    may_be[40:80, 30:90] = True
    may_be[5, 60] = may_be[90, 5] = True
    expected = np.zeros_like(may_be)
    expected[hand] = True
    np.testing.assert_array_equal(hand_sized(may_be), expected)
    assert not hand_sized(np.zeros((8, 8), np.bool_)).any()
