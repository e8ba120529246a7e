"""What the foreground says of a body: of its parts, and of all of it."""

import numpy as np
import pytest

from mocapd.published.hecht2009.part_samples import PartSamples, samples_of
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, CLOTH_OR_SHADOW, SHADOW, UNKNOWN

PARTS, ALONG = 3, 4


def counted(labels: list[list[int]], shown: Bytes | None = None) -> PartSamples:
    inside = np.ones(PARTS * ALONG, bool) if shown is None else shown.ravel() > 0
    return samples_of(np.array(labels, np.uint8).ravel(), inside, ALONG)


def test_cloth_stands_for_a_body_and_room_and_shadow_against_it() -> None:
    samples = counted(
        [[BEFORE] * 4, [BEFORE, CLOTH_OR_SHADOW, SHADOW, BACKGROUND], [BACKGROUND] * 4]
    )
    assert samples.confirmed_shares() == pytest.approx([1.0, 0.5, 0.0])
    assert samples.body_share() == pytest.approx(0.5)
    assert (samples + samples).body_share() == pytest.approx(0.5)


def test_a_few_samples_beside_an_unknown_room_do_not_decide() -> None:
    """After a takeover nobody knows the room behind the body."""
    samples = counted([[UNKNOWN] * 4, [UNKNOWN, UNKNOWN, UNKNOWN, BACKGROUND], [UNKNOWN] * 4])
    assert samples.body_share() > 0.9
    assert samples.confirmed_shares() == pytest.approx([0.5, 0.375, 0.5])


def test_what_no_picture_shows_says_nothing() -> None:
    shown = np.zeros((PARTS, ALONG), np.uint8)
    shown[0, :2] = 1
    samples = counted([[BACKGROUND] * 4] * PARTS, shown)
    assert samples.confirmed_shares() == pytest.approx([0.0, 0.5, 0.5])
    assert samples.body_share() == 0.0
    assert PartSamples.none(PARTS).body_share() == 1.0
