"""Which way a person faces: to the left is positive, and what is not seen tells nothing."""

import pytest

from mocapd.outputs.facing import facing_yaw_rad
from tests.outputs.vrchat.poses import known_but, stepping_left


@pytest.mark.parametrize("yaw_deg", [0.0, 60.0, -120.0, 179.0])
def test_it_is_the_turn_from_ahead_to_the_left(yaw_deg: float) -> None:
    ahead, turned = facing_yaw_rad(stepping_left()), facing_yaw_rad(stepping_left(yaw_deg=yaw_deg))
    assert ahead is not None
    assert turned is not None
    assert turned - ahead == pytest.approx(yaw_deg * 3.14159265 / 180.0, abs=1e-6)


def test_the_first_of_head_chest_and_hips_that_is_seen_tells_it() -> None:
    head = facing_yaw_rad(stepping_left(head_yaw_deg=50.0))
    chest = facing_yaw_rad(stepping_left(head_yaw_deg=50.0, confidence=known_but(0.5, "head")))
    hips = facing_yaw_rad(stepping_left(confidence=known_but(0.1, "head", "upperChest")))
    assert head is not None
    assert head > 0.7
    assert chest == pytest.approx(0.0, abs=0.02)
    assert hips == pytest.approx(0.0, abs=1e-9)
    nothing = known_but(0.1, "head", "upperChest", "hips")
    assert facing_yaw_rad(stepping_left(confidence=nothing)) is None
    assert facing_yaw_rad(stepping_left(live=False)) is None
