"""From pictures to colour ids: each kernel against a plain twin."""

import numpy as np
import pytest

from mocapd.body.arrays import plain
from mocapd.shirt.segmentation import bare_skin
from mocapd.shirt.segmentation import shirt_appearance as looks
from mocapd.shirt.segmentation.cell_kernels import (
    CELL,
    FAR,
    ClassifierWeights,
    LearnedPixels,
    bin_of,
    classify,
    colour_distances,
)
from mocapd.shirt.segmentation.segmentation_kernels import (
    agreement,
    colour_statistics,
    count_colours,
)
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes, Floats, Ints, Singles
from mocapd.vision.foreground_kernels import changed, learn_background
from mocapd.vision.room_background import relight_background

H, W = 36, 48
TOLERANCE = 0.05
MODEL_MEAN = standard_shirt().srgb / 255.0
MODEL_COVARIANCE = np.tile(0.04**2 * np.eye(3), (10, 1, 1))


def blobs(seed: int, h: int = H, w: int = W) -> Bytes:
    """An id map of overlapping rectangles."""
    rng = np.random.default_rng(seed)
    ids = np.zeros((h, w), np.uint8)
    for k in rng.permutation(np.arange(1, 11))[:8]:
        y, x = rng.integers(0, h - 12), rng.integers(0, w - 12)
        ids[y : y + rng.integers(5, 13), x : x + rng.integers(5, 13)] = k
    return ids


def picture_of(ids: Bytes, seed: int, noise: float = 0.02) -> Bytes:
    """BGR of the shirt's colours, grey elsewhere."""
    rng = np.random.default_rng(seed)
    rgb = np.vstack([[0.45, 0.45, 0.45], MODEL_MEAN])[ids] + rng.normal(0.0, noise, (*ids.shape, 3))
    return (np.clip(rgb, 0.0, 1.0)[..., ::-1] * 255).round().astype(np.uint8)


def affine() -> Singles:
    start = looks.fresh(np.eye(3))
    mean, covariance = looks.gaussians(start, MODEL_MEAN, MODEL_COVARIANCE, 0.04, 0.015, 0.25)
    return looks.whitening(mean, covariance)


NO_SKIN = bare_skin.whitening(np.zeros(4), 0.04, 0.015, 0.25)


# --- classification --------------------------------------------------------------------------


NOBODY = (
    np.zeros((3, 2)),
    np.zeros((1, 3), np.int32),
    np.zeros(0, np.int64),
    np.zeros(1, np.uint8),
)


def naive_distances(
    ids: Bytes, middles: list[tuple[float, float, int]], limit: int, divisor: Ints
) -> Bytes:
    """Chamfer 3-4 distance of each cell to each colour in px, FAR beyond the limit.

    On an empty grid the chamfer distance of an offset is 4 for each diagonal step and 3 for each
    straight one. middles: x, y and colour of surface points that count though they may be hidden.
    """
    h, w = ids.shape
    h4, w4 = -(-h // CELL), -(-w // CELL)
    out = np.full((h4, w4, 10), FAR, np.uint8)
    rows, columns = np.mgrid[:h4, :w4]
    for k in range(10):
        places = [(2 * y, 2 * x) for y, x in np.argwhere(ids[::2, ::2] == k + 1)]
        places += [(round(y), round(x)) for x, y, c in middles if c == k + 1]
        best = np.full((h4, w4), 10**6)
        for y, x in places:
            if not (0 <= y < h and 0 <= x < w):
                continue
            dy, dx = np.abs(rows - y // CELL), np.abs(columns - x // CELL)
            np.minimum(best, 3 * np.maximum(dy, dx) + np.minimum(dy, dx), out=best)
        within = best <= 3 * limit * divisor[k]
        out[..., k][within] = np.minimum(CELL * best // (3 * divisor[k]), FAR - 1)[within]
    return out


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("shape", [(36, 48), (35, 47)])
def test_distances_equal_the_naive_twin(seed: int, shape: tuple[int, int]) -> None:
    ids = blobs(seed, *shape)
    divisor = np.ones(10, np.int64)
    divisor[[2, 7]] = 3
    limit = 3
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-10.0, 60.0, (15, 2))
    triangles = np.arange(15, dtype=np.int32).reshape(5, 3)
    colour, sleeves = rng.integers(1, 11, 5).astype(np.uint8), np.array([0, 1, 3, 4])
    middles = [(*xy[triangles[t]].mean(axis=0), int(colour[t])) for t in sleeves]
    out = np.full((-(-shape[0] // CELL), -(-shape[1] // CELL), 10), 77, np.uint8)
    colour_distances(ids, xy, triangles, sleeves, colour, limit, divisor, out)
    np.testing.assert_array_equal(out, naive_distances(ids, middles, limit, divisor))


def naive_classify(
    picture: Bytes, at: tuple[int, int], distance: Bytes, prior: float, threshold: float,
    mean: Singles, age: Bytes, counts: tuple[Singles, Singles], penalties: tuple[float, float],
) -> tuple[Floats, Bytes]:  # fmt: skip
    """Costs (h,w,11) with the threshold as the cost of nothing, and where background is seen (h,w):
    2 yes, or no colour is expected so near; 1 no; 0 unknown."""
    h, w = CELL * distance.shape[0], CELL * distance.shape[1]
    part = (slice(at[1], at[1] + h), slice(at[0], at[0] + w))
    bgr = picture[part].astype(float)
    homogeneous = np.concatenate([bgr, np.ones((h, w, 1))], axis=2)
    whitened = np.einsum("kij,hwj->hwki", affine(), homogeneous)
    d = np.kron(distance, np.ones((CELL, CELL, 1))).astype(float)
    costs = np.linalg.norm(whitened, axis=3) + prior * d
    costs[d == FAR] = np.inf
    known = age[part] >= 6
    same = known & (np.abs(bgr - mean[part]) < TOLERANCE * 255).all(axis=2)
    costs += penalties[0] * same[..., None]
    bins = (bgr.astype(int) >> 3) @ np.array([1 << 10, 1 << 5, 1])
    shirt, other = (count[bins] for count in counts)
    costs += (penalties[1] * other / (other + shirt + 8.0))[..., None]
    nothing = np.full((h, w, 1), threshold)
    out_of_reach = ((d == FAR) | (prior * d >= threshold)).all(axis=2)
    background = np.where(same | out_of_reach, 2, np.where(known, 1, 0))
    return np.concatenate([nothing, costs], axis=2), background


@pytest.mark.parametrize("seed", range(3))
def test_classification_equals_the_naive_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = blobs(seed, H + 10, W + 14)
    picture = picture_of(truth, seed, noise=0.06)
    h, w, at = H, W, (6, 4)
    distance = np.empty((h // CELL, w // CELL, 10), np.uint8)
    predicted = np.roll(truth, 2, axis=1)[at[1] : at[1] + h, at[0] : at[0] + w]
    colour_distances(np.ascontiguousarray(predicted), *NOBODY, 2, np.ones(10, np.int64), distance)
    mean = (picture + rng.normal(0.0, 12.0, picture.shape)).astype(np.float32)
    age = rng.integers(0, 12, picture.shape[:2]).astype(np.uint8)
    counts = [
        (rng.random(1 << 15) * 30 * (rng.random(1 << 15) < 0.4)).astype(np.float32) for _ in "ab"
    ]
    ids, pixel_weight = np.empty((h, w), np.uint8), np.empty((h, w), np.uint8)
    classify(
        picture, *at, distance, affine(), NO_SKIN, plain(LearnedPixels(mean, age, *counts)),
        plain(ClassifierWeights(0.05, 3.0, TOLERANCE, 1.5, 1.2, 0.3, 0.25, 0.5)), ids, pixel_weight,
    )  # fmt: skip
    costs, background = naive_classify(
        picture, at, distance, 0.05, 3.0, mean, age, (counts[0], counts[1]), (1.5, 1.2)
    )
    ordered = np.sort(costs, axis=2)
    decided = ordered[..., 1] - ordered[..., 0] > 1e-4
    assert decided.mean() > 0.98
    expected = costs.argmin(axis=2)
    either = (background == 2) & (expected > 0)
    assert (either & decided).mean() > 0.02
    expected[either] = 0
    background[either] = 1
    np.testing.assert_array_equal(ids[decided], expected[decided])
    # 1 for sure background, else the given pixel_weight, of 255
    weights = np.array([127, 63, 255])[background]
    np.testing.assert_array_equal(pixel_weight[decided], weights[decided])
    assert 0.05 < (ids > 0).mean() < 0.9


def test_the_prior_tells_two_patches_of_one_look_apart() -> None:
    """Where a colour is not expected it is not seen, however well it fits."""
    ids = np.zeros((20, 40), np.uint8)
    ids[5:15, 4:10] = ids[5:15, 30:36] = 6
    picture = picture_of(ids, 0)
    predicted = np.where(np.arange(40) < 20, ids, 0).astype(np.uint8)
    distance = np.empty((5, 10, 10), np.uint8)
    colour_distances(predicted, *NOBODY, 3, np.ones(10, np.int64), distance)
    got, pixel_weight = np.empty_like(ids), np.empty_like(ids)
    no_count = np.zeros(1 << 15, np.float32)
    learned = LearnedPixels(
        np.zeros((20, 40, 3), np.float32), np.zeros((20, 40), np.uint8), no_count, no_count
    )
    classify(
        picture, 0, 0, distance, affine(), NO_SKIN, plain(learned),
        plain(ClassifierWeights(0.05, 3.0, TOLERANCE, 1.5, 1.5, 0.3, 0.25, 0.5)), got, pixel_weight,
    )  # fmt: skip
    assert (got[6:14, 5:9] == 6).mean() > 0.9
    assert not got[:, 26:].any()


# --- background ------------------------------------------------------------------------------


def test_background_is_learned_beside_the_body_only() -> None:
    rng = np.random.default_rng(0)
    room = rng.integers(0, 256, (H, W, 3), dtype=np.uint8)
    body = np.zeros((H, W), np.uint8)
    body[10:20, 10:20] = 1
    mean, age = np.zeros((H, W, 3), np.float32), np.zeros((H, W), np.uint8)
    for look in range(20):
        noisy = np.clip(room + rng.normal(0.0, 2.0, room.shape), 0, 255).astype(np.uint8)
        learn_background(noisy, body, mean, age, 0.02, look % 2, 2)
    beside = body == 0
    assert (age[beside] == 10).all()  # every second row at each look
    assert not age[~beside].any()
    assert not mean[~beside].any()
    assert np.abs(mean[beside] - room[beside]).max() < 5.0


def test_background_is_the_mean_of_what_was_seen_then_follows_slowly() -> None:
    body = np.zeros((2, 2), np.uint8)
    mean, age = np.zeros((2, 2, 3), np.float32), np.zeros((2, 2), np.uint8)
    seen = [10, 40, 100, 30]
    for value in seen:
        learn_background(np.full((2, 2, 3), value, np.uint8), body, mean, age, 0.1, 0, 1)
    np.testing.assert_allclose(mean, np.mean(seen), rtol=1e-5)
    age[:] = 255
    learn_background(np.full((2, 2, 3), 145, np.uint8), body, mean, age, 0.1, 0, 1)
    np.testing.assert_allclose(mean, 45.0 + 0.1 * 100.0, rtol=1e-5)
    assert (age == 255).all()  # it does not overflow


def test_a_lamp_that_goes_out_changes_the_background_and_snapping_follows_it() -> None:
    rng = np.random.default_rng(1)
    bright = rng.integers(100, 200, (H, W, 3), dtype=np.uint8)
    dark = (bright // 3).astype(np.uint8)
    body = np.zeros((H, W), np.uint8)
    body[4:30, 20:30] = 1
    mean, age = bright.astype(np.float32), np.full((H, W), 50, np.uint8)
    assert changed(bright, body, mean, age, TOLERANCE) == 0.0
    assert changed(dark, body, mean, age, TOLERANCE) == 1.0
    mean[body == 1] = 120.0
    relight_background(dark, body, mean, age)
    assert changed(dark, body, mean, age, TOLERANCE) == 0.0
    np.testing.assert_array_equal(mean[body == 0], dark[body == 0])
    assert (age[body == 0] == 50).all()
    # behind the body the background is as much darker as around it, and gives way when it is seen
    np.testing.assert_allclose(mean[body == 1], 40.0, rtol=0.02)
    assert (age[body == 1] == 8).all()


def test_the_light_behind_the_body_is_that_of_its_surroundings() -> None:
    """One half of the room goes dark: so does what is behind the body there."""
    h, w = 240, 320
    left = np.arange(w)[None, :, None] < w // 2
    lit, now = np.full((h, w, 3), 160, np.uint8), np.empty((h, w, 3), np.uint8)
    now[:] = np.where(left, 160, 40)
    body = np.zeros((h, w), np.uint8)
    body[80:180, 30:70] = body[80:180, 250:290] = 1
    mean, age = lit.astype(np.float32), np.full((h, w), 50, np.uint8)
    relight_background(now, body, mean, age)
    assert mean[80:180, 30:70].mean() == pytest.approx(160.0, rel=0.05)
    assert mean[80:180, 250:290].mean() == pytest.approx(40.0, rel=0.1)


def test_with_nobody_known_a_jump_of_the_light_leaves_nothing_known() -> None:
    """Whoever steps into the light as it goes on must not be taken for background."""
    mean, age = np.zeros((H, W, 3), np.float32), np.full((H, W), 50, np.uint8)
    lit = np.full((H, W, 3), 200, np.uint8)
    relight_background(lit, np.zeros((H, W), np.uint8), mean, age)
    assert not age.any()


def test_changed_looks_at_known_background_only() -> None:
    mean, age = np.zeros((H, W, 3), np.float32), np.full((H, W), 5, np.uint8)
    white = np.full((H, W, 3), 255, np.uint8)
    body = np.zeros((H, W), np.uint8)
    assert changed(white, body, mean, age, TOLERANCE) == 0.0
    age[: H // 2] = 6
    half = np.where(np.arange(W)[None, :, None] < W // 2, white, 0).astype(np.uint8)
    assert changed(half, body, mean, age, TOLERANCE) == pytest.approx(0.5)


# --- statistics ------------------------------------------------------------------------------


def test_colours_are_counted_on_the_shirt_and_away_from_the_body() -> None:
    model, seen = blobs(3), blobs(3)
    seen[::5] = 0
    picture = picture_of(blobs(4, H + 6, W + 8), 4)
    body = (np.random.default_rng(1).random(picture.shape[:2]) < 0.5).astype(np.uint8)
    pixel_weight = np.where(np.random.default_rng(0).random((H, W)) < 0.5, 255, 60).astype(np.uint8)
    shirt, other = np.zeros(1 << 15, np.float32), np.zeros(1 << 15, np.float32)
    count_colours(picture, 4, 2, body, model, seen, pixel_weight, shirt, other)
    wanted_shirt, wanted_other = np.zeros(1 << 15), np.zeros(1 << 15)
    for y in range(0, H, 2):
        for x in range(0, W, 2):
            b, g, r = (int(value) for value in picture[2 + y, 4 + x])
            bin_ = (b // 8) * 1024 + (g // 8) * 32 + r // 8
            assert bin_ == bin_of(picture[2 + y, 4 + x])
            if model[y, x]:
                wanted_shirt[bin_] += seen[y, x] == model[y, x]
            elif pixel_weight[y, x] != 255 and not body[2 + y, 4 + x]:
                wanted_other[bin_] += 1
    np.testing.assert_array_equal(shirt, wanted_shirt)
    np.testing.assert_array_equal(other, wanted_other)
    assert shirt.sum() > 10
    assert other.sum() > 10


@pytest.mark.parametrize("only_classified", [True, False])
def test_statistics_equal_the_naive_twin(only_classified: bool) -> None:
    model, seen = blobs(5), blobs(5)
    seen[:, ::4] = 0
    picture = picture_of(blobs(6, H + 8, W + 6), 6)
    sums = np.zeros((10, 4))
    colour_statistics(picture, 4, 6, model, seen, only_classified, sums)
    wanted = np.zeros((10, 4))
    for y in range(1, H - 1):
        for x in range(1, W - 1):
            k = model[y, x]
            cross = [model[y - 1, x], model[y + 1, x], model[y, x - 1], model[y, x + 1]]
            if k and all(c == k for c in cross) and (seen[y, x] == k or not only_classified):
                wanted[k - 1] += [1.0, *(picture[6 + y, 4 + x] / 255.0)]
    np.testing.assert_allclose(sums, wanted, atol=1e-9)
    assert sums[:, 0].sum() > 30


def test_agreement_counts_what_was_rendered_and_seen_alike() -> None:
    model, seen = blobs(7), blobs(8)
    assert agreement(model, seen) == ((model > 0).sum(), ((model == seen) & (model > 0)).sum())
