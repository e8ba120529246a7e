"""Patches looked for along rays: against a naive twin, and on a textured wall whose distance is known."""

import numpy as np
import pytest

from mocapd.geometry.camera_model import project, rays
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.ray_matching_kernels import EVERYWHERE, PatchLabels, match_along_rays
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

TARGET = np.array([0.0, 1.0, 0.0])
LEFT, RIGHT = (
    looking_at(name, np.array([x, 1.2, 2.8]), TARGET + [x, 0.0, 0.0]) for name, x in (("left", -0.06), ("right", 0.06))
)  # fmt: skip

ANY = (99, 0.0)  # a best place may be as good as others


def texture(x: Floats, y: Floats) -> Floats:
    """Grey values of a wall at x, y [m]: waves of a few centimetres in no common direction."""
    waves = (np.sin(61.0 * x + 13.0 * y), np.sin(-37.0 * x + 49.0 * y), np.cos(83.0 * x - 29.0 * y))
    return np.asarray(128.0 + 35.0 * sum(waves))


def wall_seen_by(camera: Camera, z_m: float) -> np.ndarray:
    """The picture (480,640) of the wall at z = z_m."""
    x, y = np.meshgrid(np.arange(640.0), np.arange(480.0))
    origin, along = rays(camera, np.stack([x, y], axis=-1))
    points = origin + along * ((z_m - origin[2]) / along[..., 2])[..., None]
    return np.clip(texture(points[..., 0], points[..., 1]), 0, 255).astype(np.uint8)


def naive_match(grey: Bytes, other: Bytes, at: Floats, there: Floats, half: int) -> Floats:
    """Correlations (K,) of whole-pixel patches."""

    def patch(of: Bytes, place: Floats) -> Floats:
        x, y = int(place[0]), int(place[1])
        cut = of[y - half : y + half + 1, x - half : x + half + 1].astype(float)
        out: Floats = cut - cut.mean()
        return out

    mine = patch(grey, at)
    return np.array([
        (mine * patch(other, place)).sum() / (np.linalg.norm(mine) * np.linalg.norm(patch(other, place)))
        for place in there
    ])  # fmt: skip


def test_whole_pixels_equal_the_naive_twin() -> None:
    rng = np.random.default_rng(0)
    grey = rng.integers(0, 255, (80, 90), dtype=np.uint8)
    other = np.roll(grey, 3, axis=1)
    at = np.array([[40.0, 41.0], [22.0, 30.0]])
    there = at[:, None] + np.stack([np.arange(-6.0, 7.0), np.zeros(13)], axis=1)
    place, alike = np.empty(2), np.empty(2)
    match_along_rays(grey, other, at, there, 5, 1.0, *ANY, EVERYWHERE, place, alike)
    for n in range(2):
        wanted = naive_match(grey, other, at[n], there[n], 5)
        assert np.argmax(wanted) == 9  # three to the right
        assert abs(place[n] - 9.0) < 0.5
        assert alike[n] == pytest.approx(wanted.max(), abs=1e-5)  # sums of single precision


@pytest.mark.parametrize("z_m", [-0.25, 0.0, 0.2])
def test_the_distance_of_a_wall_is_found_to_a_centimetre(z_m: float) -> None:
    pictures = wall_seen_by(LEFT, z_m), wall_seen_by(RIGHT, z_m)
    at = np.array([[x, y] for x in range(150, 500, 50) for y in range(100, 400, 60)], dtype=float)
    origin, along = rays(LEFT, at)
    truth = (z_m - origin[2]) / along[:, 2]
    tried = (0.0 - origin[2]) / along[:, 2]
    offsets = np.linspace(-0.4, 0.4, 17)
    points = origin + (tried[:, None] + offsets)[..., None] * along[:, None]
    there = project(RIGHT, points.reshape(-1, 3)).reshape(len(at), 17, 2)
    place, alike = np.empty(len(at)), np.empty(len(at))
    match_along_rays(*pictures, at, there, 6, 4.0, *ANY, EVERYWHERE, place, alike)
    assert (alike > 0.85).mean() > 0.9
    found = tried + np.interp(place, np.arange(17), offsets)
    error_m = np.abs(found - truth)[alike > 0.85]
    assert np.median(error_m) < 0.012
    assert np.percentile(error_m, 90) < 0.03


def test_what_has_no_texture_or_ends_the_search_is_not_believed() -> None:
    flat = np.full((80, 90), 120, np.uint8)
    at = np.array([[40.0, 40.0]])
    there = at[:, None] + np.stack([np.arange(-3.0, 4.0), np.zeros(7)], axis=1)
    place, alike = np.empty(1), np.empty(1)
    match_along_rays(flat, flat, at, there, 5, 1.0, *ANY, EVERYWHERE, place, alike)
    assert alike[0] == -1.0
    rng = np.random.default_rng(1)
    grey = rng.integers(0, 255, (80, 90), dtype=np.uint8)
    match_along_rays(
        grey, np.roll(grey, 9, axis=1), at, there, 5, 1.0, *ANY, EVERYWHERE, place, alike
    )
    assert alike[0] < 0.6
    match_along_rays(
        grey, np.roll(grey, 3, axis=1), at, there, 5, 1.0, *ANY, EVERYWHERE, place, alike
    )
    assert alike[0] == -1.0  # at the end of what was tried
    match_along_rays(
        grey, grey, at, np.full_like(there, np.nan), 5, 1.0, *ANY, EVERYWHERE, place, alike
    )
    assert alike[0] == -1.0


def test_stripes_along_the_ray_are_alike_everywhere_and_not_believed() -> None:
    rows = np.repeat(np.where(np.arange(80) // 6 % 2, 200.0, 60.0)[:, None], 90, axis=1)
    noise = np.random.default_rng(5).normal(0.0, 3.0, (2, 80, 90))
    grey, other = ((rows + one).astype(np.uint8) for one in noise)
    at = np.array([[40.0, 40.0], [45.0, 33.0]])
    there = at[:, None] + np.stack([np.arange(-6.0, 7.0), np.zeros(13)], axis=1)
    place, alike = np.empty(2), np.empty(2)
    match_along_rays(grey, other, at, there, 5, 4.0, *ANY, EVERYWHERE, place, alike)
    assert (alike > 0.85).any()
    match_along_rays(grey, other, at, there, 5, 4.0, 2, 0.03, EVERYWHERE, place, alike)
    assert (alike == -1.0).all()
    spots = np.random.default_rng(6).integers(0, 255, (80, 90), dtype=np.uint8)
    match_along_rays(
        spots, np.roll(spots, 3, axis=1), at, there, 5, 4.0, 2, 0.03, EVERYWHERE, place, alike
    )
    assert (alike > 0.85).all()


def test_only_the_surface_of_the_middle_counts_not_what_shows_beside_it() -> None:
    """A band whose own texture moved by two pixels, before a room of far more contrast that moved by none."""
    rng = np.random.default_rng(7)
    room = rng.integers(0, 255, (80, 90), dtype=np.uint8)
    texture = rng.integers(100, 140, (80, 90), dtype=np.uint8)
    on = np.zeros((80, 90), np.uint8)
    on[:, 36:45] = 1
    grey = np.where(on > 0, texture, room)
    other = np.where(np.roll(on, 2, axis=1) > 0, np.roll(texture, 2, axis=1), room)
    at = np.array([[40.0, 40.0]])
    there = at[:, None] + np.stack([np.arange(-4.0, 5.0), np.zeros(9)], axis=1)
    place, alike = np.empty(1), np.empty(1)
    surfaces = {2.0: PatchLabels(on, 0, 0, 1), 0.0: EVERYWHERE}
    for moved, surface in surfaces.items():
        match_along_rays(grey, other, at, there, 6, 4.0, *ANY, surface, place, alike)
        assert abs(place[0] - 4.0 - moved) < 0.6
    nothing = PatchLabels(np.zeros_like(on), 0, 0, 1)
    match_along_rays(grey, other, at, there, 6, 4.0, *ANY, nothing, place, alike)
    assert alike[0] == -1.0
