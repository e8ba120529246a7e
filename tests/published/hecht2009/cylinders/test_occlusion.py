"""Who hides whom: against brute force over random bodies, and as one expects of a body."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.geometry.camera_model import project, to_camera
from mocapd.published.hecht2009.cylinders.occlusion import (
    allocate_occlusion,
    fill_occlusion,
)
from mocapd.published.hecht2009.cylinders.occlusion_kernels import is_hidden
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from tests.published.hecht2009.cylinders.naive import ENDS_M, RADII_M, WORK_PX, camera, naive_hidden

MARGIN_M = 0.05


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([3.0, 8.0, 50.0]), st.integers(0, 10))
def test_samples_are_hidden_as_by_brute_force(seed: int, cell_px: float, own: int) -> None:
    rng = np.random.default_rng(seed)
    ends = ENDS_M + rng.normal(0.0, 0.15, ENDS_M.shape)
    model = allocate_occlusion(len(ends), WORK_PX, cell_px)
    quads, depths = fill_occlusion(model, work_camera(camera(), WORK_PX), ends, RADII_M)
    samples = np.column_stack(
        [rng.uniform(100.0, 220.0, 80), rng.uniform(20.0, 220.0, 80), rng.uniform(2.3, 3.1, 80)]
    )
    got = np.array(
        [is_hidden(model, ~(1 << own), x, y, depth_m, MARGIN_M) for x, y, depth_m in samples]
    )
    expected = [naive_hidden(quads, depths, {own}, s[:2], s[2], MARGIN_M) for s in samples]
    assert (got == expected).all()
    assert 0 < np.count_nonzero(got) < 80


def hand_hidden(hand_m: tuple[float, float, float]) -> bool:
    of = camera()
    model = allocate_occlusion(len(ENDS_M), WORK_PX, 8.0)
    fill_occlusion(model, work_camera(of, WORK_PX), ENDS_M, RADII_M)
    x, y = (project(of, np.array(hand_m)) + 0.5) * 0.5 - 0.5
    depth_m = to_camera(of, np.array(hand_m))[2]
    return bool(is_hidden(model, ~(3 << 3), x, y, depth_m, MARGIN_M))


def test_a_hand_behind_the_back_is_hidden_and_one_before_the_belly_or_beside_is_not() -> None:
    assert hand_hidden((0.0, 1.1, -0.2))
    assert not hand_hidden((0.0, 1.1, 0.2))
    assert not hand_hidden((0.5, 1.1, -0.2))


def test_a_joint_at_the_trunks_own_depth_is_not_hidden_by_it() -> None:
    assert not hand_hidden((0.1, 1.35, 0.0))


def test_a_body_before_the_last_ones_place_is_forgotten() -> None:
    model = allocate_occlusion(len(ENDS_M), WORK_PX, 8.0)
    work = work_camera(camera(), WORK_PX)
    fill_occlusion(model, work, ENDS_M, RADII_M)
    fill_occlusion(model, work, ENDS_M + [0.0, 0.0, 9.0], RADII_M)  # behind the camera
    assert not is_hidden(model, -1, 160.0, 120.0, 9.0, MARGIN_M)


def test_more_parts_than_bits_are_refused() -> None:
    with pytest.raises(ValueError, match="63 parts"):
        allocate_occlusion(63, WORK_PX, 8.0)
