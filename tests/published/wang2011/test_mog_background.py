"""Background subtraction: a newcomer is foreground, the room is not."""

import numpy as np

from mocapd.published.wang2011.mog_background import BackgroundSubtractor, MixtureParams
from mocapd.types import Bytes


def room(seed: int, person: bool = False) -> Bytes:
    image = np.full((120, 160, 3), 110.0)
    image[:, 80:] = 60.0
    if person:
        image[40:90, 30:70] = (40, 200, 220)
    image += np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return image.round().astype(np.uint8)


def test_a_person_who_comes_in_is_foreground() -> None:
    subtractor = BackgroundSubtractor(MixtureParams(shift=1, grow=0))
    for seed in range(30):
        empty = subtractor.apply(room(seed))
    assert (empty > 0).mean() < 0.01
    mask = subtractor.apply(room(99, person=True))
    assert mask.shape == (60, 80)
    assert (mask[22:43, 17:33] == 255).mean() > 0.95
    assert (mask[:, 45:] > 0).mean() < 0.01


def test_reset_forgets_the_room() -> None:
    first, second = (BackgroundSubtractor(MixtureParams()) for _ in range(2))
    for seed in range(10):
        first.apply(room(seed, person=True))
    first.reset()
    for seed in range(5):
        same = first.apply(room(seed)), second.apply(room(seed))
        assert (same[0] == same[1]).all()


def test_growing_keeps_a_margin() -> None:
    plain = BackgroundSubtractor(MixtureParams(shift=1, grow=0))
    grown = BackgroundSubtractor(MixtureParams(shift=1, grow=2))
    for seed in range(10):
        plain.apply(room(seed))
        grown.apply(room(seed))
    small = plain.apply(room(99, person=True))
    large = grown.apply(room(99, person=True))
    assert (large[small > 0] == 255).all()
    assert (large > 0).sum() > (small > 0).sum()


def test_the_mask_covers_a_frame_whose_sides_are_no_multiple_of_its_blocks() -> None:
    subtractor = BackgroundSubtractor(MixtureParams(shift=2, grow=0))
    for seed in range(30):
        subtractor.apply(room(seed)[:118, :157])
    newcomer = np.full((118, 157, 3), 110, np.uint8)
    newcomer[100:] = (40, 200, 220)
    mask = subtractor.apply(newcomer)
    assert mask.shape == (30, 40)  # a classifier reads it at 117 >> 2, 156 >> 2
    assert (mask[26:] == 255).all()
