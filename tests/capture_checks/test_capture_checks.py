"""A few of the wrong captures, as a part of the study that `python -m tests.capture_checks` is."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.capture_checks.__main__ import said_of
from tests.capture_checks.cases import CASES, WrongCapture, make_wrong

CHOSEN = {
    "24 Hz": "mended",
    "millimetres": "refused",
    "left-handed world": "refused",
    "2 frames late, pair_clutter_jacks": "mended",
    "cropped aside": "warned",
    "of another room": "warned",
}


@pytest.mark.parametrize(
    "case", [one for one in CASES if one.name in CHOSEN], ids=lambda one: one.name
)
def test_a_wrong_capture_is_not_tracked_without_the_right_word(
    case: WrongCapture, dev_captures: Callable[[str], Path], tmp_path: Path
) -> None:
    outcome, reasons, words = said_of(make_wrong(case, dev_captures(case.capture).parent, tmp_path))
    assert reasons == case.wanted
    assert outcome == CHOSEN[case.name]
    assert words


def test_a_capture_as_it_is_gives_no_word(dev_captures: Callable[[str], Path]) -> None:
    """One with somebody else in the room, whom one camera sees for longer."""
    assert said_of(dev_captures("pair_clutter_martial")) == ("SILENT", (), [])
