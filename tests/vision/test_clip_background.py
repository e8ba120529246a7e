"""The room behind somebody who never leaves: what they uncover is learned, what they always cover is not made up."""

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes, Floats
from mocapd.vision.clip_background import clip_background

H, W, N = 120, 160, 40
TIMES_S: Floats = np.arange(N) / 15.0
TALL, BROAD = slice(20, 110), 40


def room() -> Bytes:
    rng = np.random.default_rng(3)
    coarse = rng.integers(60, 200, (H // 8, W // 8, 3))
    return np.asarray(np.kron(coarse, np.ones((8, 8, 1))), np.uint8)


def film(left_px: NDArray[np.intp]) -> list[Bytes]:
    """A patterned person as broad as BROAD, whose left edge is at left_px (N,), before the noisy room."""
    rng = np.random.default_rng(4)
    pattern = np.kron(rng.integers(0, 255, (30, 14, 3)), np.ones((3, 3, 1)))[:, :BROAD]
    out = []
    for x in left_px.tolist():
        picture = room().astype(int)
        picture[TALL, x : x + BROAD] = pattern
        out.append(np.clip(picture + rng.normal(0.0, 2.0, picture.shape), 0, 255).astype(np.uint8))
    return out


def covered(left_px: NDArray[np.intp]) -> NDArray[np.intp]:
    """How many pictures (h,w) show the person."""
    count = np.zeros((H, W), np.intp)
    for x in left_px.tolist():
        count[TALL, x : x + BROAD] += 1
    return count


def test_who_walks_through_the_picture_leaves_the_room_behind() -> None:
    left = np.linspace(0, W - BROAD, N).astype(int)
    learned, known = clip_background(film(left), TIMES_S)
    assert known.mean() > 0.98
    off = np.abs(learned.astype(int) - room())[known]
    assert np.percentile(off, 99) < 8


def test_what_somebody_who_sways_always_covers_is_not_known() -> None:
    left = (60 + 12 * np.sin(np.arange(N) * 0.7)).round().astype(int)
    learned, known = clip_background(film(left), TIMES_S)
    often = covered(left)
    assert not known[often == N].any()
    assert known[often == 0].mean() > 0.9
    off = np.abs(learned.astype(int) - room()).max(axis=-1)
    assert np.percentile(off[known], 99) < 12  # nothing of the person in it


def test_a_smooth_part_of_somebody_is_no_island_of_room() -> None:
    left = (60 + 3 * np.sin(np.arange(N) * 0.7)).round().astype(int)
    shown = film(left)
    for picture, x in zip(shown, left.tolist(), strict=True):
        picture[40:90, x + 8 : x + BROAD - 8] = (40, 90, 200)
    _, known = clip_background(shown, TIMES_S)
    assert not known[50:80, 72:88].any()


def test_one_picture_alone_tells_nothing() -> None:
    _, known = clip_background(film(np.array([50])), TIMES_S[:1])
    assert not known.any()
