"""What a head looks like is learned from its face, in whatever light."""

import numpy as np
import pytest

from mocapd.published.hecht2009.head.head_colour_kernels import colour_bin
from mocapd.published.hecht2009.head.head_colours import (
    HeadEllipse,
    chroma_bins,
    face_side,
    has_colours,
    initial_colours,
    light_gain,
    update_colours,
)
from mocapd.types import Bytes

SKINS = ((95, 125, 190), (35, 50, 85), (150, 180, 225))
HAIR = (30, 35, 45)
ROOM = (150, 150, 140)
SHIRT = (140, 60, 40)
OUTLINE = HeadEllipse(np.array([80.0, 60.0, 20.0, 27.0]), np.array([0.0, -1.0]))


def person(skin: tuple[int, int, int], light: float = 1.0, turned: float = 0.0) -> Bytes:
    """A head with hair above and, `turned` -1..1, on the side that it looks away from."""
    v, u = np.mgrid[:160, :160]
    x, y = (u - 80) / 20.0, (v - 60) / 27.0
    out = np.tile(np.array(ROOM, float), (160, 160, 1))
    out[(abs(u - 80) < 45) & (v > 95)] = SHIRT
    head = x**2 + y**2 < 1.0
    out[head] = skin
    out[head & ((y < -0.5) | ((x * np.sign(turned) < 2 * abs(turned) - 1) if turned else False))] = HAIR  # fmt: skip
    out += np.random.default_rng(0).normal(0, 3, out.shape)
    return np.asarray(np.clip(light * out, 0, 255), np.uint8)


@pytest.mark.parametrize("skin", SKINS)
def test_skin_is_told_from_room_and_shirt_whatever_its_colour(skin: tuple[int, int, int]) -> None:
    picture = person(skin)
    colours = update_colours(initial_colours(), picture, OUTLINE, True, 1 / 30)
    skin_odds = np.append(colours.skin_odds, -1.0)  # the last one: of what is too dark to tell
    marked = (skin_odds[chroma_bins(picture.reshape(-1, 3))] > 0.0).reshape(picture.shape[:2])
    assert marked[60:75, 70:90].mean() > 0.95
    assert marked[20:90, :40].mean() < 0.05
    assert marked[110:150, 50:110].mean() < 0.05


@pytest.mark.parametrize("light", [0.6, 1.3])
def test_a_head_is_told_from_the_room_when_the_light_has_changed(light: float) -> None:
    colours = update_colours(initial_colours(), person(SKINS[0]), OUTLINE, True, 1 / 30)
    later = person(SKINS[0], light)
    gain = light_gain(later, OUTLINE)

    def odds(v: int, u: int) -> float:
        b, g, r = later[v, u].tolist()
        return float(colours.head_odds[colour_bin(b, g, r, gain)])

    face = np.mean([odds(v, u) for v in range(60, 75) for u in range(72, 88)])
    hair = np.mean([odds(v, u) for v in range(38, 44) for u in range(75, 85)])
    room = np.mean([odds(v, u) for v in range(30, 90) for u in range(10, 40)])
    assert min(face, hair) > 0.3
    assert room < -0.3


def test_nothing_is_skin_before_a_face_was_seen() -> None:
    picture = person(SKINS[0])
    assert not has_colours(initial_colours())
    assert face_side(initial_colours(), picture, OUTLINE) is None
    without_face = update_colours(initial_colours(), picture, OUTLINE, False, 1 / 30)
    assert has_colours(without_face)
    assert face_side(without_face, picture, OUTLINE) is None


def test_the_skin_of_a_turned_head_lies_to_the_side_that_it_looks_to() -> None:
    colours = update_colours(initial_colours(), person(SKINS[0]), OUTLINE, True, 1 / 30)
    sides = []
    for turned in (-0.6, 0.0, 0.6):
        seen = face_side(colours, person(SKINS[0], turned=turned), OUTLINE)
        assert seen is not None
        sides.append(seen[1])
    assert sides[0] < -0.2 < sides[1] < 0.2 < sides[2]
    assert abs(sides[1]) < 0.05


def test_what_was_learned_fades_as_time_passes() -> None:
    colours = update_colours(initial_colours(), person(SKINS[0]), OUTLINE, True, 0.0)
    other = person(SKINS[1])
    soon, late = (update_colours(colours, other, OUTLINE, True, dt_s) for dt_s in (0.01, 20.0))
    b, g, r = other[70, 80].tolist()
    at = colour_bin(b, g, r, light_gain(other, OUTLINE))
    assert late.head[at] / late.head.sum() > soon.head[at] / soon.head.sum() > 0.0


def test_a_head_at_the_edge_of_the_picture_is_learned_from_what_is_seen() -> None:
    outline = HeadEllipse(np.array([-5.0, 2.0, 20.0, 27.0]), np.array([0.0, -1.0]))
    assert np.isfinite(update_colours(initial_colours(), person(SKINS[0]), outline, True, 0.1).head_odds).all()  # fmt: skip
    beyond = HeadEllipse(np.array([-500.0, 2.0, 20.0, 27.0]), np.array([0.0, -1.0]))
    assert light_gain(person(SKINS[0]), beyond) == 1.0
    assert not has_colours(update_colours(initial_colours(), person(SKINS[0]), beyond, True, 0.1))
