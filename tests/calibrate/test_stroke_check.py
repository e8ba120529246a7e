"""Strokes that cannot be right are refused by the names of their colours; sloppy ones are not."""

import numpy as np
import pytest

from mocapd.calibrate.colours.stroke_check import check_strokes, require_good_strokes
from mocapd.errors import InputError
from tests.calibrate.swatches import MODEL, NAMES, swapped, swatches

LIGHTS = {
    "warm": np.array([1.15, 0.95, 0.65]),
    "cold": np.array([0.7, 0.9, 1.1]),
    "dim": np.array([0.5, 0.5, 0.5]),
}


@pytest.mark.parametrize("light", LIGHTS)
def test_good_strokes_pass_in_any_light(light: str) -> None:
    pixels, strokes = swatches(LIGHTS[light])
    assert check_strokes(pixels, strokes, MODEL) == ()
    require_good_strokes(pixels, strokes, MODEL, "cam0")


def test_three_of_ten_colours_are_too_few_and_the_missing_ones_are_named() -> None:
    pixels, strokes = swatches(LIGHTS["warm"])
    strokes[strokes > 3] = 0
    with pytest.raises(InputError) as caught:
        require_good_strokes(pixels, strokes, MODEL, "cam0")
    message = str(caught.value)
    assert "only 3 of 10 colours" in message
    drawn, missing = message.split("--")
    assert "red, orange, yellow" in drawn
    assert all(name in missing for name in NAMES[3:])


def test_no_strokes_at_all() -> None:
    pixels, strokes = swatches(LIGHTS["warm"])
    (problem,) = check_strokes(pixels, np.zeros_like(strokes), MODEL)
    assert "none" in problem.what
    assert problem.colours == tuple(range(1, 11))


@pytest.mark.parametrize(("a", "b"), [(1, 5), (7, 3), (9, 6), (10, 8)])
def test_exchanged_strokes_are_named_with_what_they_lie_on(a: int, b: int) -> None:
    pixels, strokes = swatches(LIGHTS["warm"])
    problems = check_strokes(pixels, swapped(strokes, a, b), MODEL)
    # of a bright and a dark colour one may pass for the other in deep shade
    assert {k for p in problems for k in p.colours} == {a, b}
    assert all(p.serious for p in problems)
    for problem in problems:
        drawn, seen = problem.colours
        assert f"for {NAMES[drawn - 1]} lies on what looks {NAMES[seen - 1]}" in problem.what


def test_a_stroke_on_the_wall_is_found_where_it_is() -> None:
    pixels, strokes = swatches(LIGHTS["cold"])
    strokes[strokes == 1] = 0
    strokes[2:8, 2:30] = 1  # on the grey border
    (problem,) = check_strokes(pixels, strokes, MODEL)
    assert problem.colours[0] == 1
    ((x, y),) = problem.at_px
    assert 2 <= x < 30
    assert 2 <= y < 8


def test_one_wrong_stroke_beside_a_larger_right_one_is_only_a_hint() -> None:
    pixels, strokes = swatches(LIGHTS["cold"])
    strokes[2:6, 2:12] = 1
    (problem,) = check_strokes(pixels, strokes, MODEL)
    assert not problem.serious
    require_good_strokes(pixels, strokes, MODEL, "cam0")


def test_all_colours_on_the_wrong_patches_fit_no_light() -> None:
    pixels, strokes = swatches(LIGHTS["warm"])
    order = np.array([0, 5, 8, 7, 9, 3, 2, 10, 4, 6, 1], np.uint8)
    with pytest.raises(InputError, match="no light makes"):
        require_good_strokes(pixels, order[strokes], MODEL, "cam0")
