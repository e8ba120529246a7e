"""What matching points of a room say of cameras whose pictures are not as calibrated."""

import numpy as np
import pytest

from mocapd.calibrate.consistency.room_points import RoomVerdict, judge_room
from mocapd.geometry.camera_model import project
from mocapd.types import Floats
from tests.geometry.rigs import looking_at

SIZE_PX = np.array([640.0, 480.0])
LEFT = looking_at("left", np.array([-1.2, 1.5, 2.8]), np.array([0.0, 1.0, 0.0]))
RIGHT = looking_at("right", np.array([1.3, 1.3, 2.5]), np.array([0.1, 1.1, 0.0]))


def matches(seed: int, count: int = 90, wrong: int = 30) -> tuple[Floats, Floats]:
    """Points of a room in both pictures (N,2), with false matches among them."""
    rng = np.random.default_rng(seed)
    points_m = rng.uniform([-2.0, 0.0, -2.5], [2.0, 2.4, 0.5], (count, 3))
    px = [project(camera, points_m) + rng.normal(0.0, 0.5, (count, 2)) for camera in (LEFT, RIGHT)]
    false = [rng.uniform([0.0, 0.0], SIZE_PX, (wrong, 2)) for _ in px]
    return np.concatenate([px[0], false[0]]), np.concatenate([px[1], false[1]])


def judged(px: tuple[Floats, Floats]) -> RoomVerdict:
    return judge_room((LEFT, RIGHT), px)


@pytest.mark.parametrize("seed", range(4))
def test_cameras_as_calibrated_and_matches_that_mean_nothing_contradict_nothing(seed: int) -> None:
    assert not judged(matches(seed)).is_contradiction
    assert not judged(matches(seed, 0, 120)).is_contradiction
    assert not judged(matches(seed, 6, 5)).is_contradiction


@pytest.mark.parametrize("scale", [0.7, 1.2, 1.5])
@pytest.mark.parametrize("middle_px", [(320.0, 240.0), (160.0, 120.0)])
def test_a_picture_that_was_cut_out_or_made_smaller_is_found(
    scale: float, middle_px: tuple[float, float]
) -> None:
    here, there = matches(1)
    middle = np.array(middle_px)
    verdict = judged((here, middle + scale * (there - middle)))
    assert verdict.is_contradiction
    assert verdict.change is not None
    assert (verdict.change.is_mirrored, verdict.change.is_turned) == (False, False)
    assert 1 in verdict.change.cameras
    assert verdict.change.count > 50


def test_the_same_zoom_of_both_cameras_is_found_with_its_factor() -> None:
    middles = [camera.K[:2, 2] for camera in (LEFT, RIGHT)]
    here, there = (
        middle + 1.4 * (px - middle) for middle, px in zip(middles, matches(2), strict=True)
    )
    change = judged((here, there)).change
    assert change is not None
    assert (change.cameras, change.is_central) == ((0, 1), True)
    assert change.scale == pytest.approx(1.4, abs=0.1)


def test_a_mirrored_and_a_turned_picture_are_found() -> None:
    here, there = matches(3)
    mirrored = judged((here, np.array([639.0, 0.0]) + np.array([-1.0, 1.0]) * there)).change
    turned = judged((SIZE_PX - 1.0 - here, there)).change
    assert mirrored is not None
    assert turned is not None
    assert (mirrored.is_mirrored, mirrored.is_turned) == (True, False)
    assert (turned.is_mirrored, turned.is_turned, turned.cameras) == (False, True, (0,))


def test_a_camera_that_was_moved_contradicts_the_rig() -> None:
    moved = looking_at("right", np.array([0.2, 2.3, 3.1]), np.array([-0.6, 0.7, 0.0]))
    assert judge_room((LEFT, moved), matches(4)).is_contradiction
