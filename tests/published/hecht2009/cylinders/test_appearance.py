"""Learned colours: those of the cloth, of what is seen, and fixed in the end."""

from functools import cache

import numpy as np
import pytest

from mocapd.published.hecht2009.cylinders.limb_params import LimbScoreParams
from mocapd.published.hecht2009.cylinders.occlusion import allocate_occlusion, fill_occlusion
from mocapd.published.hecht2009.cylinders.occlusion_kernels import OcclusionModel
from mocapd.published.hecht2009.cylinders.part_colours import (
    ENOUGH_S,
    AppearanceModel,
    learn,
    observe,
    reference_colours,
)
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from mocapd.types import Bytes, Floats
from tests.published.hecht2009.cylinders.naive import ENDS_M, RADII_M, WORK_PX, camera

HIDDEN_BY_M = LimbScoreParams().hidden_by_m
FOREARM, SHIN, UPPER_TRUNK = 4, 8, 1
SURE = np.ones((len(ENDS_M), 2))
EVERYWHERE = np.full((WORK_PX[1], WORK_PX[0]), 255, np.uint8)


@cache  # not at import, where each of several processes would compile what it takes
def occluded() -> tuple[OcclusionModel, Floats, Floats]:
    """What hides what, and all parts as the camera sees them: their quads, and their depths [m]."""
    occlusion = allocate_occlusion(len(ENDS_M), WORK_PX, 8.0)
    return occlusion, *fill_occlusion(occlusion, work_camera(camera(), WORK_PX), ENDS_M, RADII_M)


def clothed(seed: int, noise: float = 0.0) -> Bytes:
    """A picture in which a sleeve ends half way down the left forearm: blue cloth, then skin; grey elsewhere."""
    forearm = occluded()[1][FOREARM]
    start, end = 0.5 * (forearm[0] + forearm[3]), 0.5 * (forearm[1] + forearm[2])
    y, x = np.mgrid[: WORK_PX[1], : WORK_PX[0]]
    along = ((np.stack([x, y], -1) - start) @ (end - start)) / ((end - start) @ (end - start))
    out = np.where(along[..., None] < 0.5, [180.0, 60.0, 30.0], [120.0, 150.0, 210.0])
    far = np.hypot(x - 0.5 * (start + end)[0], y - 0.5 * (start + end)[1]) > 40.0
    out[far] = 90.0
    out += np.random.default_rng(seed).normal(0.0, noise, out.shape)
    return np.clip(out, 0.0, 255.0).astype(np.uint8)


def learned(
    model: AppearanceModel, colour: Bytes, mask: Bytes = EVERYWHERE, confidence: Floats = SURE,
    dt_s: float = 0.1,
) -> AppearanceModel:  # fmt: skip
    occlusion, quads, depths_m = occluded()
    seen = observe(quads, depths_m, colour, mask, occlusion, HIDDEN_BY_M)
    return learn(model, 0, seen, confidence, dt_s)


def test_the_cloths_colours_are_found_through_noise() -> None:
    model = AppearanceModel.initial(1, len(ENDS_M))
    for i in range(10):
        model = learned(model, clothed(i, 25.0))
    assert model.colour[0, FOREARM, :4] == pytest.approx(
        np.tile([180.0, 60.0, 30.0], (4, 1)), abs=12
    )
    assert model.colour[0, FOREARM, 6:] == pytest.approx(
        np.tile([120.0, 150.0, 210.0], (4, 1)), abs=12
    )


def test_what_the_mask_leaves_out_is_not_learned() -> None:
    mask = np.zeros_like(EVERYWHERE)
    model = learned(AppearanceModel.initial(1, len(ENDS_M)), clothed(0), mask)
    assert not model.visible_s.any()
    assert np.isnan(reference_colours(model, 10)).all()


def test_a_part_behind_another_is_not_learned_from_it() -> None:
    # the trunk is behind the left forearm where they cross, and behind nothing else of its size
    ends = ENDS_M.copy()
    ends[SHIN] = [[0.0, 1.35, -0.4], [0.0, 1.25, -0.4]]
    occlusion = allocate_occlusion(len(ends), WORK_PX, 8.0)
    quads, depths = fill_occlusion(occlusion, work_camera(camera(), WORK_PX), ends, RADII_M)
    seen = observe(quads, depths, clothed(0), EVERYWHERE, occlusion, HIDDEN_BY_M)
    assert not seen.share[SHIN].any()
    assert seen.share[UPPER_TRUNK].min() > 0.5


def test_rings_near_an_unsure_end_learn_less() -> None:
    confidence = SURE.copy()
    confidence[FOREARM] = [1.0, 0.0]
    model = learned(AppearanceModel.initial(1, len(ENDS_M)), clothed(0), confidence=confidence)
    visible_s = model.visible_s[0, FOREARM]
    assert (np.diff(visible_s) < 0.0).all()
    assert visible_s == pytest.approx(0.1 * (1.0 - (np.arange(10) + 0.5) / 10))


def test_it_is_a_running_average_and_then_fixed() -> None:
    model = AppearanceModel.initial(1, len(ENDS_M))
    grey = np.full((*EVERYWHERE.shape, 3), 80, np.uint8)
    model = learned(learned(model, grey, dt_s=0.1), grey * 2, dt_s=0.3)
    assert model.colour[0, SHIN] == pytest.approx(np.full((10, 3), 140.0), abs=0.01)
    assert not model.is_fixed
    for _ in range(30):
        model = learned(model, grey)
    assert (model.visible_s[0, SHIN] >= ENOUGH_S).all()
    before = model.colour[0, SHIN].copy()
    assert (learned(model, grey * 3).colour[0, SHIN] == before).all()


def test_one_cameras_colours_are_not_anothers() -> None:
    model = learned(AppearanceModel.initial(2, len(ENDS_M)), clothed(0))
    assert model.visible_s[0].any()
    assert not model.visible_s[1].any()


def test_reference_colours_run_from_ring_to_ring_and_over_gaps() -> None:
    model = AppearanceModel.initial(1, 1)
    model.colour[0, 0] = np.arange(10.0)[:, None]
    model.visible_s[0, 0, [2, 6]] = 0.5
    got = reference_colours(model, 20)[0, 0, :, 0]
    assert got[:4] == pytest.approx(2.0)
    assert got[-6:] == pytest.approx(6.0)
    assert (np.diff(got[5:13]) > 0.0).all()
    assert got[9] == pytest.approx(9.5 / 20 * 10 - 0.5)
