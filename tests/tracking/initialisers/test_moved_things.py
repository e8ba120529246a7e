"""Rooms in which a thing is moved and nobody is."""

import pytest

from tests.tracking.stances.moved_things import THINGS
from tests.tracking.stances_study import ghosts


@pytest.mark.parametrize("name", ["chair_stereo", "cupboard_stereo", "plant"])
def test_a_thing_that_is_moved_is_nobody(name: str) -> None:
    (thing,) = [one for one in THINGS if one.name == name]
    assert ghosts(thing, "markerless") == 0
