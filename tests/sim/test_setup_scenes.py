"""What a first setup finds out from the simulated board: lenses and room as they truly are."""

from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.assets import asset_path
from mocapd.body.skeleton import INDEX
from mocapd.calibrate.board.board_detection import BoardDetector, BoardView
from mocapd.calibrate.extrinsics.bundle_adjustment import adjust_bundle
from mocapd.calibrate.extrinsics.pose_graph import initial_scene, observations
from mocapd.calibrate.extrinsics.world_frame import play_area_error, rig_in_world, world_on_floor
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, solve_intrinsics
from mocapd.calibrate.intrinsics.views import covered_share
from mocapd.calibration.board_spec import BoardKind, BoardSpec, centre_m, corners_m
from mocapd.geometry.camera_model import centre, project
from mocapd.sim.board.board_clips import board_scenes, hold_frames, load_board_clips
from mocapd.sim.clips import Clip
from mocapd.sim.scenario import Scenario, load_scenario
from mocapd.sim.setup_scenes import SETUP_BOARD, WEARER_S, SetupScene
from mocapd.sim.world import World, rig_of
from mocapd.types import Floats, Rig

SPEC = BoardSpec(
    BoardKind.CHARUCO,
    SETUP_BOARD.columns,
    SETUP_BOARD.rows,
    SETUP_BOARD.square_m,
    SETUP_BOARD.marker_m,
    SETUP_BOARD.dictionary,
)
BOARD_M = corners_m(SPEC)
Views = dict[str, dict[int, BoardView]]


@cache
def scenario() -> Scenario:
    return load_scenario(asset_path("scenarios/first_setup.toml"))


@cache
def rig() -> Rig:
    return rig_of(scenario())


@pytest.fixture(scope="module")
def clips(cache_home: Path) -> dict[SetupScene, Clip]:
    """Rendered once, and kept with what other tests keep."""
    return load_board_clips(scenario(), cache_home / "mocapd")


def still_frames(scene: SetupScene) -> list[int]:
    """A frame of the scene for every place, in which the board is held still."""
    held, moved = hold_frames(scenario().fps_hz)
    return [k * (held + moved) + held // 2 for k in range(len(board_scenes(rig().cameras)[scene]))]


def views_of(clips: dict[SetupScene, Clip], scene: SetupScene, first: int = 0) -> Views:
    detector = BoardDetector(SPEC)
    out: Views = {name: {} for name in rig().names}
    for i, frame in enumerate(still_frames(scene), start=first):
        for name in out:
            jpeg = np.frombuffer(clips[scene].jpeg(name, frame), np.uint8)
            pixels = np.asarray(cv2.imdecode(jpeg, cv2.IMREAD_COLOR), np.uint8)
            view = detector.find(pixels, i)
            if view is not None:
                out[name][i] = view
    return out


@pytest.fixture(scope="module")
def lens_views(clips: dict[SetupScene, Clip]) -> Views:
    return views_of(clips, SetupScene.LENS)


@pytest.fixture(scope="module")
def lenses(lens_views: Views) -> dict[str, Intrinsics]:
    return {
        name: solve_intrinsics(list(views.values()), BOARD_M, (640, 480), name)
        for name, views in lens_views.items()
    }


def test_the_board_is_found_where_it_is_in_each_cameras_own_places(lens_views: Views) -> None:
    places = board_scenes(rig().cameras)[SetupScene.LENS]
    each = len(places) // len(rig().cameras)
    for c, camera in enumerate(rig().cameras):
        own = range(c * each, (c + 1) * each)
        seen = [lens_views[camera.name].get(i) for i in own]
        assert np.mean([view is not None for view in seen]) >= 0.9
        errors_px = []
        for view in seen:
            if view is None:
                continue
            place = places[view.index]
            assert place is not None
            R, t_m = place.pose(SETUP_BOARD)
            truth = project(camera, BOARD_M[view.ids] @ R.T + t_m)
            errors_px.append(np.linalg.norm(view.corners_px - truth, axis=1))
        all_px = np.concatenate(errors_px)
        assert np.percentile(all_px, 95) < 0.3
        assert np.median(all_px) < 0.15
    shared = set(lens_views["cam0"]) & set(lens_views["cam1"])
    assert len(shared) >= 10


def test_the_lens_places_fill_the_pictures_and_give_the_lenses(
    lens_views: Views, lenses: dict[str, Intrinsics]
) -> None:
    for camera in rig().cameras:
        lens = lenses[camera.name]
        assert covered_share(list(lens_views[camera.name].values()), camera.size_px) > 0.9
        for i in (0, 1):
            assert lens.K[i, i] == pytest.approx(camera.K[i, i], rel=0.005)
            assert lens.K[i, 2] == pytest.approx(camera.K[i, 2], abs=4.0)


def test_the_room_places_and_the_floor_give_the_room(
    clips: dict[SetupScene, Clip], lenses: dict[str, Intrinsics]
) -> None:
    views = views_of(clips, SetupScene.ROOM)
    n = len(board_scenes(rig().cameras)[SetupScene.ROOM])
    floor = views_of(clips, SetupScene.FLOOR, first=n)
    for name in rig().names:
        assert len(views[name]) == n
        assert len(floor[name]) == 1
        views[name] |= floor[name]
    scene, indices = initial_scene(rig().names, lenses, views, BOARD_M)
    seen = observations(rig().names, views, indices, BOARD_M)
    bundle = adjust_bundle(scene, indices, seen, np.array([[640.0, 480.0]] * 2))
    world = world_on_floor(bundle.scene, indices.index(n), centre_m(SPEC), "the floor")
    found = rig_in_world(world, bundle.scene, rig().names, [(640, 480)] * 2)
    # +Z of the world that is found points to the middle of the directions to the cameras
    true_m, found_m = (np.stack([centre(c) for c in one.cameras]) for one in (rig(), found))
    level = true_m[:, [0, 2]] / np.linalg.norm(true_m[:, [0, 2]], axis=1, keepdims=True)
    heading = np.arctan2(*level.mean(axis=0))
    c, s = np.cos(heading), np.sin(heading)
    turned_m = found_m @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T
    assert np.linalg.norm(turned_m - true_m, axis=1).max() < 0.01
    for a, b in zip(rig().cameras, found.cameras, strict=True):
        assert b.K[0, 0] == pytest.approx(a.K[0, 0], rel=0.005)
    area = play_area_error(found, seen.of(bundle.used))
    assert area is not None
    assert area.median_cm < 0.5


def test_the_empty_room_and_what_stands_still_are_as_noisy_as_with_a_webcam(
    clips: dict[SetupScene, Clip],
) -> None:
    for scene in (SetupScene.EMPTY, SetupScene.FLOOR, SetupScene.LENS):
        one, other = (clips[scene].jpeg("cam0", frame) for frame in (4, 5))
        assert one != other


def test_the_wearer_does_in_each_scene_what_it_is_named_for() -> None:
    world = World(scenario())

    def joints(scene: SetupScene) -> Floats:
        start, end = WEARER_S[scene]
        return np.array([world.at(t).joints_m for t in np.arange(start, end - 0.01, 0.1)])

    still, bends, moving = (
        joints(s) for s in (SetupScene.T_POSE, SetupScene.ARM_BENDS, SetupScene.MOVING)
    )
    hand, elbow, hips = INDEX["rightHand"], INDEX["rightLowerArm"], INDEX["hips"]
    assert np.ptp(still, axis=0).max() < 0.06
    assert np.ptp(bends[:, elbow], axis=0).max() < 0.08
    assert (np.ptp(bends[:, hand], axis=0)[1:] > 0.15).all()
    assert (np.ptp(moving[:, hips], axis=0)[[0, 2]] > 0.4).all()
    assert np.abs(moving[:, hips][:, [0, 2]]).max() < 0.5
