"""The soft hull: the hard one for certain masks; better than hard and than votes for uncertain ones."""

import numpy as np

from mocapd.types import Floats
from mocapd.vision.hull.ray_hull import CERTAIN, carve_log_odds, point_log_odds, voxel_centres
from tests.vision.hull.ring_of_cameras import BOX_M, FIGURE, inside_figure, silhouette
from tests.vision.hull.test_ray_hull import CAMERAS, MASKS, inside_masks

POINTS_M, _ = voxel_centres(BOX_M, 0.04)


def certain(masks: list[np.ndarray]) -> list[np.ndarray]:
    return [np.where(mask > 0, CERTAIN, -CERTAIN).astype(np.float32) for mask in masks]


def test_certain_masks_give_the_hard_hull() -> None:
    hard = inside_masks(POINTS_M, CAMERAS, MASKS)
    soft = carve_log_odds(CAMERAS, certain(MASKS), POINTS_M) > 0.0
    assert hard.sum() > 1000
    assert np.array_equal(soft, hard)


def test_each_camera_more_leaves_less_and_the_body_stays() -> None:
    kept = [carve_log_odds(CAMERAS[:n], certain(MASKS[:n]), POINTS_M) > 0.0 for n in (2, 3, 4)]
    assert kept[0].sum() > kept[1].sum() > kept[2].sum()
    body = inside_figure(POINTS_M)
    for hull in kept:
        assert (hull & body).sum() > 0.98 * body.sum()  # but for half pixels along the outline


def test_one_camera_in_doubt_does_not_cut_a_limb_off() -> None:
    """It half believes that the leg is background; the others see it."""
    leg: Floats = np.array([0.18, 0.45, 0.02])
    maps = certain(MASKS)
    without = silhouette(CAMERAS[0], [FIGURE[0], FIGURE[2]])
    maps[0][(MASKS[0] > 0) & (without == 0)] = -1.5
    assert carve_log_odds(CAMERAS, maps, leg[None])[0] > 0.0
    # and a certain background is a veto, whatever the others see
    maps[0][without == 0] = -CERTAIN
    assert carve_log_odds(CAMERAS, maps, leg[None])[0] < -10.0


def test_doubt_in_one_camera_adds_no_ghost() -> None:
    """Votes of all but one camera keep what that camera alone would carve; here the others are believed."""
    ghosts = inside_masks(POINTS_M, CAMERAS[1:], MASKS[1:]) & ~inside_masks(
        POINTS_M, CAMERAS, MASKS
    )
    assert ghosts.sum() > 50
    assert not (carve_log_odds(CAMERAS, certain(MASKS), POINTS_M)[ghosts] > 0.0).any()


def test_foreground_is_weak_evidence_and_background_strong() -> None:
    odds = np.array([-50.0, -2.0, 0.0, 2.0, 50.0], np.float32)
    said = point_log_odds(odds, covered=0.4)
    assert (np.diff(said) > 0.0).all()
    assert np.isclose(said[2], 0.0, atol=1e-6)
    assert np.isclose(said[-1], -np.log(0.4), atol=1e-5)
    assert said[0] < -45.0


def test_a_point_that_fewer_than_two_cameras_see_is_not_of_the_hull() -> None:
    behind: Floats = np.array([[40.0, 1.0, 40.0]])
    assert carve_log_odds(CAMERAS, certain(MASKS), behind)[0] == -np.inf


def test_voxels_fill_the_box() -> None:
    centres, counts = voxel_centres(np.array([[0.0, 0.0, 0.0], [0.2, 0.4, 0.1]]), 0.1)
    assert counts == (2, 4, 1)
    assert np.allclose(centres[0], 0.05)
    assert np.allclose(centres[-1], [0.15, 0.35, 0.05])
    assert np.allclose(centres[1], [0.05, 0.15, 0.05])
