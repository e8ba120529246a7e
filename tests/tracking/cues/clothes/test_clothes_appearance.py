"""Colours of regions: learned where they agree, told apart, joined when alike, expected in another light."""

import gc
import weakref

import numpy as np
import pytest

from mocapd.body.arrays import plain
from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.fit_params import FitParams, LegSearchParams, LimbSearchParams
from mocapd.tracking.cues.clothes.appearance import Appearance, AppearanceParams, region_distances
from mocapd.tracking.cues.clothes.appearance_kernels import (
    BITS,
    N_BINS,
    N_CLASSES,
    RegionCosts,
    classify_regions,
    log_table,
)
from mocapd.tracking.cues.clothes.region_merge import NO_MERGE, RegionSolverCache, choose_merge
from mocapd.tracking.cues.clothes.regions import Band, Region
from mocapd.types import Bytes, Singles
from mocapd.vision.foreground_kernels import BEFORE, CLOTH_OR_SHADOW, SHADOW
from tests.geometry.rigs import ring

COLOURS: dict[Region | Band, tuple[int, int, int]] = {
    Region.TRUNK: (180, 40, 40), Region.FACE: (120, 150, 210), Region.FOREARM: (180, 44, 38),
    Region.LEG: (60, 60, 70), Region.FOOT: (20, 200, 200), Region.HAND: (118, 148, 214), Region.HAIR: (10, 20, 40),
}  # fmt: skip


def dressed(gain: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """A picture (42,210,3) of seven blocks side by side, one for each region, and what is drawn there."""
    rng = np.random.default_rng(2)
    drawn = np.zeros((42, 210), np.uint8)
    picture = np.full((42, 210, 3), 128.0)
    for k, (region, colour) in enumerate(COLOURS.items()):
        drawn[6:36, 30 * k + 5 : 30 * k + 25] = region
        picture[6:36, 30 * k + 5 : 30 * k + 25] = colour
    noisy = gain * picture + rng.normal(0.0, 3.0, picture.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8), drawn


def before_of(drawn: np.ndarray) -> np.ndarray:
    return np.where(drawn > 0, BEFORE, 0).astype(np.uint8)


def learned() -> tuple[Appearance, np.ndarray, np.ndarray]:
    appearance = Appearance(AppearanceParams())
    picture, drawn = dressed()
    appearance.learn(picture, drawn, before_of(drawn))
    return appearance, picture, drawn


def unlooked(drawn: Bytes) -> Singles:
    """The odds of a picture that the network did not look at."""
    return np.zeros(drawn.shape, np.float32)


def test_a_region_is_known_by_its_colour_where_it_was_not_expected() -> None:
    appearance, picture, drawn = learned()
    elsewhere = np.roll(drawn, 12, axis=1)
    ids = appearance.classify(
        picture, before_of(drawn), region_distances(elsewhere), np.ones_like(drawn), unlooked(drawn)
    )
    for region in (Region.LEG, Region.FOOT, Region.HAIR):
        assert np.mean(ids[drawn == region] == region) > 0.95


def test_colours_overlap_as_they_are_alike() -> None:
    appearance, _, _ = learned()
    assert appearance.overlap(Region.FOREARM, Region.TRUNK) > 0.7
    assert appearance.overlap(Region.HAND, Region.FACE) > 0.7
    assert appearance.overlap(Region.LEG, Region.HAIR) < 0.2


def test_a_long_sleeve_is_one_with_the_trunk_and_hands_stay_their_own() -> None:
    appearance, _, _ = learned()
    look = choose_merge([appearance], 0.55)
    assert look[Region.FOREARM] == Region.TRUNK
    assert look[Region.HAND] == Region.HAND
    body = build_model(1.75, full_body())
    fitters = RegionSolverCache(
        body, ring(2), [2, 2], FitParams(), LimbSearchParams(), LegSearchParams()
    )
    apart, one = (fitters.of(worn)[0].labels.label for worn in (NO_MERGE, look))
    assert set(apart.tolist()) == {int(part) for part in (*Region, *Band)}
    assert (one[apart == Region.FOREARM] == Region.TRUNK).all()
    assert (one[apart == Region.HAND] == Region.HAND).all()


def test_who_is_bare_armed_and_sleeved_ends_with_one_region_for_all() -> None:
    """Hands like forearms that are like the trunk: the name of the last one is taken."""
    appearance = Appearance(AppearanceParams())
    picture, drawn = dressed()
    for region in (Region.FOREARM, Region.HAND):
        picture[drawn == region] = picture[drawn == Region.TRUNK][
            : np.count_nonzero(drawn == region)
        ]
    appearance.learn(picture, drawn, before_of(drawn))
    assert choose_merge([appearance], 0.55)[Region.HAND] == Region.TRUNK


def test_shirt_and_sleeves_end_where_the_colours_change() -> None:
    """Trousers reach to the waist, and short sleeves leave the lower half of the upper arm bare; one band that is seen
    badly, between others that are clear, does not tear a chain."""
    of_bands = {
        Band.LOW_HIPS: Region.LEG, Band.HIGH_HIPS: Region.LEG, Band.WAIST: Region.TRUNK,
        Band.LOW_SLEEVE: Region.HAND, Band.HIGH_SLEEVE: Region.TRUNK,
    }  # fmt: skip
    colours: dict[Region | Band, tuple[int, int, int]] = {
        **COLOURS,
        Region.FOREARM: COLOURS[Region.HAND],
    }
    colours.update({band: colours[region] for band, region in of_bands.items()})
    drawn = np.zeros((42, 30 * len(colours)), np.uint8)
    picture = np.full((*drawn.shape, 3), 128, np.uint8)
    for k, (part, colour) in enumerate(colours.items()):
        drawn[6:36, 30 * k + 5 : 30 * k + 25] = part
        picture[6:36, 30 * k + 5 : 30 * k + 25] = colour
    appearance = Appearance(AppearanceParams())
    appearance.learn(picture, drawn, before_of(drawn))
    look = choose_merge([appearance], 0.55)
    assert [look[band] for band in (Band.LOW_HIPS, Band.HIGH_HIPS)] == [Region.LEG] * 2
    assert [look[band] for band in (Band.WAIST, Band.HIGH_SLEEVE)] == [Region.TRUNK] * 2
    assert look[Band.LOW_SLEEVE] == look[Region.FOREARM]
    appearance.merge_regions(look)
    body = build_model(1.75, full_body())
    worn = (
        RegionSolverCache(body, ring(2), [2, 2], FitParams(), LimbSearchParams(), LegSearchParams())
        .of(look)[0]
        .labels
    )
    assert worn.label.max() <= max(Region)


def test_colours_are_expected_as_dim_as_the_background_became() -> None:
    appearance, _, drawn = learned()
    dim, _ = dressed(0.5)
    shifted = region_distances(np.roll(drawn, 12, axis=1))
    before = before_of(drawn)
    appearance.relight(np.full(3, 0.5))
    ids = appearance.classify(dim, before, shifted, np.ones_like(drawn), unlooked(drawn))
    assert np.mean(ids[drawn == Region.FOOT] == Region.FOOT) > 0.9


def test_a_pose_that_disagrees_does_not_teach() -> None:
    """Skin before the chest stays skin, however long the arm is drawn beside it."""
    appearance, picture, drawn = learned()
    wrong = np.where(drawn == Region.FOOT, Region.TRUNK, drawn).astype(np.uint8)
    for _ in range(200):
        ids = appearance.classify(
            picture, before_of(drawn), region_distances(drawn), np.ones_like(drawn), unlooked(drawn)
        )
        appearance.learn(picture, wrong, before_of(drawn), ids)
    assert appearance.overlap(Region.TRUNK, Region.FOOT) < 0.05


def is_body(what: int, on_floor: int, person_odds: float) -> bool:
    """Of a dark pixel 6 px from the body."""
    table = np.full((N_CLASSES, N_BINS), 5.0, np.float32)
    distance = np.full((N_CLASSES - 1, 1, 1), 6.0, np.float32)
    costs = RegionCosts(0.25, 40.0, 26.0, 1e6, 0.5, 8.0, (1.5, 4.0), 0.75, 4.0, 1.0, 3.0)
    out = np.empty((1, 1), np.uint8)
    classify_regions(
        np.zeros((1, 1, 3), np.uint8), np.full((1, 1), what, np.uint8), distance, table,
        np.full((1, 1), on_floor, np.uint8), np.full((1, 1), person_odds, np.float32), plain(costs), out,
    )  # fmt: skip
    return bool(out[0, 0])


@pytest.mark.parametrize(("what", "on_floor", "body"), [
    (BEFORE, 1, True), (SHADOW, 1, False), (CLOTH_OR_SHADOW, 1, False), (CLOTH_OR_SHADOW, 0, True),
])  # fmt: skip
def test_a_dark_pixel_is_a_shadow_on_the_floor_and_cloth_elsewhere(
    what: int, on_floor: int, body: bool
) -> None:
    assert is_body(what, on_floor, 0.0) == body


def test_where_the_network_sees_the_person_a_likely_shadow_is_cloth() -> None:
    assert is_body(CLOTH_OR_SHADOW, 1, 5.0)
    assert not is_body(CLOTH_OR_SHADOW, 1, -5.0)


def test_the_table_is_the_smoothed_share_of_each_class() -> None:
    rng = np.random.default_rng(0)
    n = 1 << BITS
    counts = rng.exponential(1.0, (N_CLASSES, N_BINS)).astype(np.float32)
    out = np.empty_like(counts)
    log_table(counts, 2e-5, np.empty(N_BINS, np.float32), out)
    for k in range(N_CLASSES):
        smooth = counts[k].reshape(n, n, n).astype(float)
        for axis in range(3):
            low = np.take(smooth, np.maximum(np.arange(n) - 1, 0), axis)
            high = np.take(smooth, np.minimum(np.arange(n) + 1, n - 1), axis)
            smooth = 0.5 * smooth + 0.25 * (low + high)
        expected = -np.log(smooth.ravel() / (counts[k].sum() + 1e-3) + 2e-5)
        assert out[k] == pytest.approx(expected, rel=1e-4)


def test_of_many_who_came_in_other_clothes_few_fitters_are_kept() -> None:
    body = build_model(1.75, full_body())
    fitters = RegionSolverCache(
        body, ring(2), [4, 4], FitParams(), LimbSearchParams(), LegSearchParams()
    )
    looks = [(*NO_MERGE[:-1], worn) for worn in range(6)]
    made = [weakref.ref(fitters.of(look).fitter) for look in looks]
    assert fitters.of(looks[-2]).fitter is made[-2]()
    gc.collect()
    assert [ref() is not None for ref in made] == [False, False, True, True, True, True]
