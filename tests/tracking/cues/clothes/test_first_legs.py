"""The first legs of a wearer of the shirt who is in view from the start, and has not moved."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.geometry.camera_model import centre, project
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.setup import setup_of
from mocapd.tracking.cues.keypoints.keypoint_detection import CameraKeypoints, KeypointDetectors
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import BodyState, FrameSet, Rig
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import auto_tracker
from tests.tracking.shirt_film import Filmed, film
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

COUNT, AT_ONCE = 30, 15  # frames: a second, and half of it
LEGS = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerLeg", "Foot")]


@pytest.fixture(scope="module")
def filmed() -> Filmed:
    return film(stands=True, count=COUNT)


def bodies(
    filmed: Filmed, database: PoseDatabase, sets: list[FrameSet], cameras: int = 2
) -> list[BodyState]:
    known = calibration_of_setup(setup_of(filmed.scenario, filmed.renderers))
    assert known.rig is not None
    known = replace(known, rig=Rig(known.rig.cameras[:cameras]))
    tracker = Stepping(auto_tracker(known, database), wearer_shape(known))
    return [tracker.step(one).body for one in sets]


def test_they_are_found_at_once(filmed: Filmed, pose_database: PoseDatabase) -> None:
    found = bodies(filmed, pose_database, [*filmed.frame_sets(filmed.pictures)][:AT_ONCE])
    assert found[-1].tracker == "shirt+clothes"
    assert found[-1].joints_m is not None
    off_m = np.linalg.norm(found[-1].joints_m - filmed.joints_m[AT_ONCE - 1], axis=1)[LEGS]
    assert off_m.max() < 0.12


def test_keypoints_are_detected_of_new_ones_at_once_in_a_known_room_too(
    filmed: Filmed, pose_database: PoseDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    # silhouettes find those; who walks in has often crossed legs, which keypoints alone tell apart
    cameras: list[int] = []
    detect = KeypointDetectors.detect

    def counted(detectors: KeypointDetectors, *args: Any) -> CameraKeypoints | None:
        cameras.append(args[-1])
        return detect(detectors, *args)

    monkeypatch.setattr(KeypointDetectors, "detect", counted)
    sets = filmed.frame_sets([*filmed.empty, *filmed.pictures[:AT_ONCE]])
    carriers = [body.tracker for body in bodies(filmed, pose_database, sets)]
    seen = carriers.count("shirt+clothes")
    assert seen >= AT_ONCE // 2
    assert min(map(cameras.count, (0, 1))) >= (seen - 1) // 3


@pytest.mark.parametrize("calibrated", [1, 2])
def test_one_camera_finds_them_across_its_view(
    filmed: Filmed, pose_database: PoseDatabase, calibrated: int
) -> None:
    """The only one, or the one that is left."""
    camera = filmed.renderers[0].camera
    sets = [
        replace(one, frames={camera.name: one.frames[camera.name]})
        for one in filmed.frame_sets(filmed.pictures)
    ]
    found = bodies(filmed, pose_database, sets, cameras=calibrated)
    assert found[-1].tracker == "shirt+clothes"
    assert found[-1].joints_m is not None
    here_px, there_px = (
        project(camera, joints_m[LEGS]) for joints_m in (found[-1].joints_m, filmed.joints_m[-1])
    )
    distance_m = np.linalg.norm(filmed.joints_m[-1][LEGS] - centre(camera), axis=1)
    across_m = np.linalg.norm(here_px - there_px, axis=1) * distance_m / camera.K[0, 0]
    assert across_m.max() < 0.12


def test_behind_a_table_nobody_claims_them(filmed: Filmed, pose_database: PoseDatabase) -> None:
    def hidden(one: FrameSet) -> FrameSet:
        frames = {}
        for renderer in filmed.renderers:
            name = renderer.camera.name
            pixels = one.frames[name].pixels.copy()
            pixels[tops[name] :] = (60, 90, 130)
            frames[name] = replace(one.frames[name], picture=pixels)
        return replace(one, frames=frames)

    knees_m = filmed.joints_m[0][LEGS[::2]]
    tops = {
        r.camera.name: int(project(r.camera, knees_m)[:, 1].min()) - 15 for r in filmed.renderers
    }
    sets = [*map(hidden, filmed.frame_sets(filmed.pictures))][:AT_ONCE]
    found = bodies(filmed, pose_database, sets)
    assert {body.tracker for body in found[5:]} == {"shirt"}
    assert not found[-1].confidence[LEGS].any()
