"""One lens from views of a board, and the sets of views that do not give it."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import solve_intrinsics
from mocapd.calibrate.intrinsics.views import choose_views, coverage, covered_share
from mocapd.calibration.board_spec import BoardKind, BoardSpec, corners_m
from mocapd.errors import ConfigError
from mocapd.types import Floats
from tests.calibrate.board_scenes import TARGET_M, cameras, corners_px, held_poses, middle_m

BOARD_M = corners_m(BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052))
(CAMERA,) = cameras(1)
SIZE_PX = CAMERA.size_px


def views_at(poses: list[tuple[Floats, Floats]], noise_px: float = 0.1) -> list[BoardView]:
    rng = np.random.default_rng(3)
    views = []
    for i, pose in enumerate(poses):
        px = corners_px(CAMERA, BOARD_M, pose)
        px = px + noise_px * rng.standard_normal(px.shape)
        views.append(BoardView(i, np.arange(len(px)), px, 0.4))
    return views


def test_the_lens_is_found_and_its_held_out_error_is_the_noise() -> None:
    lens = solve_intrinsics(views_at(held_poses(24)), BOARD_M, SIZE_PX, "cam0")
    assert abs(lens.K[0, 0] / CAMERA.K[0, 0] - 1) < 0.005
    assert abs(lens.K[1, 1] / CAMERA.K[1, 1] - 1) < 0.005
    assert 0.8 < lens.held_out_px / (0.1 * np.sqrt(2.0)) < 1.3
    assert lens.thrown_out == ()


def test_views_that_contradict_the_others_are_thrown_out() -> None:
    views = views_at(held_poses(20))
    rng = np.random.default_rng(0)
    for i in (4, 11):
        bad = views[i].corners_px + rng.normal(0, 6, views[i].corners_px.shape)
        views[i] = replace(views[i], corners_px=bad)
    lens = solve_intrinsics(views, BOARD_M, SIZE_PX, "cam0")
    assert lens.thrown_out == (4, 11)
    assert abs(lens.K[0, 0] / CAMERA.K[0, 0] - 1) < 0.005


def test_errors_may_grow_with_the_size_of_the_picture() -> None:
    larger = 6.0
    views = [
        replace(view, corners_px=larger * (view.corners_px + 0.5) - 0.5)
        for view in views_at(held_poses(20), noise_px=0.3)
    ]
    size_px = (int(larger * SIZE_PX[0]), int(larger * SIZE_PX[1]))
    lens = solve_intrinsics(views, BOARD_M, size_px, "cam0")
    assert lens.held_out_px > 2.0
    assert abs(lens.K[0, 0] / (larger * CAMERA.K[0, 0]) - 1) < 0.02


@pytest.mark.parametrize(("wrong", "noise_px"), [(0, 0.1), (0, 0.5), (1, 0.1)])
def test_parallel_views_are_refused(wrong: int, noise_px: float) -> None:
    rng = np.random.default_rng(1)
    facing = CAMERA.R.T  # the board faces the camera squarely, wherever it is
    places = TARGET_M + rng.uniform(-0.15, 0.15, (15, 3))
    views = views_at([(facing, place - facing @ middle_m()) for place in places], noise_px)
    for i in range(wrong):  # it seems tilted, until it is thrown out
        x, y = (views[i].corners_px - SIZE_PX[0] / 2).T
        bent = SIZE_PX[0] / 2 + np.column_stack([0.6 * x, y + 30.0 * np.sin(x / 60.0)])
        views[i] = replace(views[i], corners_px=bent)
    with pytest.raises(ConfigError, match="tilt") as refused:
        solve_intrinsics(views, BOARD_M, SIZE_PX, "cam0")
    assert refused.value.where == "cam0"


def test_too_few_views_and_a_bent_board_are_refused() -> None:
    with pytest.raises(ConfigError, match="usable in 4 pictures"):
        solve_intrinsics(views_at(held_poses(4)), BOARD_M, SIZE_PX, "cam0")
    bent = BOARD_M.copy()
    bent[:, 0] += 0.02 * np.sin(60.0 * bent[:, 1])
    with pytest.raises(ConfigError, match=r"fits badly|contradict"):
        solve_intrinsics(views_at(held_poses(20)), bent, SIZE_PX, "cam0")


def test_blurred_views_are_left_and_the_picture_is_filled() -> None:
    views = views_at(held_poses(60))
    soft = [replace(view, sharpness=0.1) if view.index % 3 == 0 else view for view in views]
    taken = choose_views(soft, SIZE_PX, 12)
    assert len(taken) == 12
    assert all(view.index % 3 for view in taken)
    first = [view for view in soft if view.index % 3][:12]
    assert covered_share(taken, SIZE_PX) >= covered_share(first, SIZE_PX)
    assert coverage(taken, SIZE_PX).sum() == 12 * len(BOARD_M)
    assert choose_views([], SIZE_PX, 30) == []
