"""Projection and its slopes, and the room they give."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_motion import has_one_neighbour
from mocapd.calibrate.extrinsics.board_reprojection import (
    Observations,
    ReprojectionProblem,
    jacobians,
    residuals_px,
    with_steps,
)
from mocapd.calibrate.extrinsics.bundle_adjustment import BundleParams, adjust_bundle
from mocapd.calibrate.extrinsics.pose_graph import initial_scene, observations
from mocapd.calibrate.extrinsics.world_frame import (
    guess_world,
    play_area_error,
    rig_in_world,
    world_on_floor,
)
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec, corners_m
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import centre, project
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.types import Camera
from tests.calibrate.board_scenes import cameras, corners_px, floor_pose, held_poses, middle_m

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052)
BOARD_M = corners_m(SPEC)


def views_of(
    rig: tuple[Camera, ...], n: int, seen_by: Mapping[int, tuple[int, ...]], noise_px: float = 0.1
) -> dict[str, dict[int, BoardView]]:
    """Views of n positions and the floor; `seen_by[index]` limits who sees it."""
    rng = np.random.default_rng(5)
    poses = [*held_poses(n), floor_pose()]
    views: dict[str, dict[int, BoardView]] = {camera.name: {} for camera in rig}
    for c, camera in enumerate(rig):
        for i, pose in enumerate(poses):
            if c in seen_by.get(i, (0, 1, 2, 3)):
                px = corners_px(camera, BOARD_M, pose)
                px = px + noise_px * rng.standard_normal(px.shape)
                views[camera.name][i] = BoardView(i, np.arange(len(px)), px, 0.4)
    return views


def lenses_near(rig: tuple[Camera, ...]) -> dict[str, Intrinsics]:
    """The true lenses, their focal length 1 % too long."""
    return {
        c.name: Intrinsics(
            c.size_px, c.K * [[1.01], [1.01], [1]], c.dist, np.ones(5, bool), 0, 0, (), (), 0
        )
        for c in rig
    }


def random_scene(seed: int = 0) -> tuple[ReprojectionProblem, Observations]:
    rig = cameras(3)
    views = views_of(rig, 4, {})
    names = [c.name for c in rig]
    scene, indices = initial_scene(names, lenses_near(rig), views, BOARD_M)
    rng = np.random.default_rng(seed)
    scene = replace(
        scene, path=0.05 * rng.standard_normal((5, 2, 6)), delay=np.array([0.0, 0.4, -0.3])
    )
    return scene, observations(names, views, indices, BOARD_M)


def test_projection_is_that_of_the_cameras() -> None:
    scene, seen = random_scene()
    scene = replace(scene, delay=np.zeros(3))
    rig = rig_in_world(guess_world(scene, BOARD_M), scene, ["a", "b", "c"], [(640, 480)] * 3)
    world = guess_world(scene, BOARD_M)
    error = residuals_px(scene, seen)
    for n in (0, 33, 177):
        v = seen.view[n]
        at = (world @ scene.scene_from_board[v]).apply(seen.point_m[n])
        px = project(rig.cameras[seen.camera[n]], at)
        np.testing.assert_allclose(px - seen.pixels[n], error[n], atol=1e-8)


def test_slopes_are_those_of_small_steps() -> None:
    """Also of corners on the board's back, where that lies askew."""
    scene, seen = random_scene()
    seen = replace(seen, on_back=np.arange(len(seen.camera)) % 3 == 0)
    scene = replace(scene, back=scene.back.with_step(np.array([0.004, -0.003, 0.02, 0.002])))
    rng = np.random.default_rng(1)
    shapes = ((3, 9), (3, 6), (5, 6), (3,), (4,))
    at = [0.02 * rng.standard_normal(shape) for shape in shapes]
    d = [rng.standard_normal(shape) for shape in shapes]
    h = 1e-6
    ahead, behind = (
        residuals_px(with_steps(scene, *(a + s * h * b for a, b in zip(at, d, strict=True))), seen)
        for s in (1.0, -1.0)
    )
    parts = jacobians(with_steps(scene, *at), seen, at[1], at[2])
    rows = (
        d[0][seen.camera],
        d[1][seen.camera],
        d[2][seen.view],
        d[3][seen.camera, None],
        np.broadcast_to(d[4], (len(seen.camera), 4)),
    )
    slope = sum(np.einsum("nij,nj->ni", J, x) for J, x in zip(parts, rows, strict=True))
    np.testing.assert_allclose((ahead - behind) / (2 * h), slope, rtol=1e-5, atol=1e-3)


# no position is seen by all four: 0 and 1, 1 and 2, 2 and 3 share some each
CHAIN = {i: ((0, 1), (1, 2), (2, 3))[i % 3] for i in range(24)} | {24: (0, 1)}


def test_a_chain_of_cameras_is_solved_on_the_floor() -> None:
    rig = cameras(4)
    names = [c.name for c in rig]
    views = views_of(rig, 24, CHAIN)
    scene, indices = initial_scene(names, lenses_near(rig), views, BOARD_M)
    seen = observations(names, views, indices, BOARD_M)
    spoilt = seen.pixels.copy()
    spoilt[::97] += 40.0  # outliers
    seen = replace(seen, pixels=spoilt)
    bundle = adjust_bundle(scene, indices, seen, np.array([[640.0, 480.0]] * 4))
    assert not bundle.used[::97].any()
    world = world_on_floor(bundle.scene, indices.index(24), middle_m(), "the floor")
    found = rig_in_world(world, bundle.scene, names, [c.size_px for c in rig])
    for a, b in zip(rig, found.cameras, strict=True):
        assert abs(b.K[0, 0] / a.K[0, 0] - 1.0) < 0.005
        # the heading is that of the cameras' middle, not that of the simulated room
        assert abs(centre(a)[1] - centre(b)[1]) < 0.01
        assert abs(np.linalg.norm(centre(a)) - np.linalg.norm(centre(b))) < 0.01
    area = play_area_error(found, seen.of(bundle.used))
    assert area is not None
    assert area.median_cm < 0.1


def test_a_view_that_is_off_as_a_whole_is_left_out_as_a_whole() -> None:
    """A picture of another moment: its corners are off by less than single ones may be."""
    rig = cameras(3)
    names = [c.name for c in rig]
    views = views_of(rig, 20, {})
    scene, indices = initial_scene(names, lenses_near(rig), views, BOARD_M)
    seen = observations(names, views, indices, BOARD_M)
    spoilt = (seen.camera == 1) & (seen.view == 7)
    seen = replace(seen, pixels=seen.pixels + 1.2 * spoilt[:, None])
    params = BundleParams(longest_gap=2.6)
    apart = [9 * index for index in indices]
    bundle = adjust_bundle(scene, apart, seen, np.array([[640.0, 480.0]] * 3), params)
    assert not bundle.used[spoilt].any()
    assert bundle.used[~spoilt].mean() > 0.99


def test_motion_followed_from_one_side_is_that_of_the_ends() -> None:
    one_sided = has_one_neighbour([4, 0, 1, 2, 9, 3], 1.5)
    np.testing.assert_array_equal(one_sided, [True, True, False, False, True, False])


def test_cameras_that_share_no_position_are_named() -> None:
    rig = cameras(3)
    views = views_of(rig, 12, {i: ((0, 1), (2,))[i % 2] for i in range(13)})
    with pytest.raises(ConfigError, match="cam2 never sees the board at the same moment"):
        initial_scene([c.name for c in rig], lenses_near(rig), views, BOARD_M)


def test_a_floor_above_the_cameras_is_refused() -> None:
    scene, _ = random_scene()
    turned = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
    upside_down = replace(scene, scene_from_board=scene.scene_from_board @ turned)
    with pytest.raises(ConfigError, match="under it"):
        world_on_floor(upside_down, 4, middle_m(), "frame 4")
