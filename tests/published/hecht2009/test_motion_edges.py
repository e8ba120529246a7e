"""Edge and motion images: outlines stand out, moving ones more, and against a plain pass."""

import cv2
import numpy as np
import pytest

from mocapd.published.hecht2009.edge_kernels import FULL, mark_edges
from mocapd.published.hecht2009.motion_edges import motion_edges, work_picture
from mocapd.types import Bytes

H, W = 60, 80


def bar(x: int, half: int = 6) -> Bytes:
    """A light vertical bar about column x on a dark ground."""
    out = np.full((H, W), 60, np.uint8)
    out[:, x - half : x + half] = 160
    return out


def test_marks_as_a_plain_pass_does() -> None:
    rng = np.random.default_rng(1)
    dx, dy = rng.integers(-200, 200, (2, H, W)).astype(np.int16)
    difference = rng.integers(0, 40, (H, W)).astype(np.uint8)
    out = np.empty((H, W, 3), np.int16)
    mark_edges(dx, dy, difference, 150, 20, 1000, 400, out)
    steep = np.abs(dx.astype(int)) + np.abs(dy.astype(int)) >= 150
    strength = np.where(steep, np.where(difference >= 20, 1000, 400), 0)
    twice = 2.0 * np.arctan2(dy, dx)
    expected = strength[..., None] * np.stack([np.ones((H, W)), np.cos(twice), np.sin(twice)], -1)
    assert np.abs(out - expected).max() < 1.01


def test_a_still_outline_stands_out_and_nothing_moves() -> None:
    seen = motion_edges(bar(40), bar(40))
    strength = seen.edges[..., 0]
    assert strength[30, 34] > 0.4 * FULL
    assert strength[30, 46] > 0.4 * FULL
    assert strength[30, 40] < 0.1 * FULL
    assert strength[30, 10] == 0
    assert not seen.motion.any()


@pytest.mark.parametrize("turn_deg", [0.0, 30.0, 90.0, 135.0])
def test_an_outline_tells_its_direction_whichever_side_is_lighter(turn_deg: float) -> None:
    normal = np.array([np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))])
    y, x = np.mgrid[:H, :W]
    across = (x - 40) * normal[0] + (y - 30) * normal[1]
    step = (60 + 100 * np.clip(across + 0.5, 0.0, 1.0)).astype(np.uint8)
    for grey in (step, 255 - step):
        strength, cosine, sine = motion_edges(grey, None).edges[30, 40] / FULL
        assert strength > 0.4
        twice = np.radians(2.0 * turn_deg)
        assert cosine * np.cos(twice) + sine * np.sin(twice) > 0.9 * strength


def test_a_moving_outline_counts_more_than_a_still_one() -> None:
    picture, before = bar(20), bar(20)
    picture[:, 50:60] = 160
    before[:, 52:62] = 160
    seen = motion_edges(picture, before)
    moving, still = seen.edges[30, 46:54, 0].max(), seen.edges[30, 10:30, 0].max()
    assert moving > 1.3 * still > 0
    assert seen.motion[7, 13] > 10 * max(int(seen.motion[7, 3]), 1)


def test_the_first_picture_has_still_edges_only() -> None:
    seen = motion_edges(bar(40), None)
    assert (seen.edges == motion_edges(bar(40), bar(40)).edges).all()
    assert not seen.motion.any()


def test_noise_of_a_webcam_is_neither_motion_nor_edge() -> None:
    rng = np.random.default_rng(2)
    before, now = (
        work_picture(np.clip(pixels, 0, 255).astype(np.uint8), (W, H))
        for pixels in rng.normal(120.0, 4.0, (2, 2 * H, 2 * W, 3))
    )
    seen = motion_edges(now.grey, before.grey)
    assert not seen.motion.any()
    assert np.mean(seen.edges[..., 0] > 0.1 * FULL) < 0.01


@pytest.mark.parametrize("size", [(480, 640), (720, 1280), (45, 61)])
def test_a_work_picture_is_the_average_of_its_pixels(size: tuple[int, int]) -> None:
    pixels = np.random.default_rng(3).integers(0, 255, (*size, 3)).astype(np.uint8)
    out = work_picture(pixels, (size[1] // 2, size[0] // 2))
    if size[0] % 2 == 0:
        blocks = pixels.reshape(size[0] // 2, 2, size[1] // 2, 2, 3).mean(axis=(1, 3))
        assert np.abs(out.colour - blocks).max() <= 1.0
    assert (out.grey == cv2.cvtColor(out.colour, cv2.COLOR_BGR2GRAY)).all()
