"""How far a camera's picture lies from the body: nothing where all is well, the turn of a turned camera."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibrate.verification.check_measure import Measure, MeasuringTracker
from mocapd.geometry import rotations
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.world import rig_of
from mocapd.types import Rig
from tests.tracking.shirt_film import Filmed, film, tracker_of
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

TURN_RAD = np.radians(1.0)


@pytest.fixture(scope="module")
def measured(pose_database: PoseDatabase) -> tuple[Filmed, list[Measure], list[Measure]]:
    """The film, tracked on its true rig; measured against that, and against one with cam1 turned up."""
    filmed = film()
    rig = rig_of(filmed.scenario)
    first, second = rig.cameras
    up = rotations.to_matrix(rotations.exp(np.array([TURN_RAD, 0.0, 0.0])))
    turned = Rig((first, replace(second, R=up @ second.R, t_m=up @ second.t_m)))
    ready = tracker_of(filmed, pose_database)
    found = []
    for one in (rig, turned):
        ready.reset()
        into: list[Measure] = []
        measuring = MeasuringTracker(ready.tracker, one, ready.shape, into.append)
        watched = Stepping(measuring, ready.shape)
        for frames in filmed.frame_sets(filmed.pictures):
            watched.step(frames)
        found.append(into)
    return filmed, found[0], found[1]


def middle_px(measures: list[Measure], camera: str) -> np.ndarray:
    return np.asarray(np.median([m.cameras[camera].shift_px for m in measures], axis=0))


def test_a_true_rig_agrees(measured: tuple[Filmed, list[Measure], list[Measure]]) -> None:
    filmed, true, _ = measured
    assert len(true) >= 8
    for renderer in filmed.renderers:
        assert np.linalg.norm(middle_px(true, renderer.camera.name)) < 1.0
    assert np.median([m.upright_rad for m in true]) < 0.3
    assert np.all(np.abs(np.median([m.lengths for m in true], axis=0) - 1.0) < 0.15)


def test_a_turned_camera_is_off_by_its_turn(
    measured: tuple[Filmed, list[Measure], list[Measure]],
) -> None:
    filmed, true, turned = measured
    first, second = (renderer.camera for renderer in filmed.renderers)
    away = middle_px(turned, second.name) - middle_px(true, second.name)
    expected_px = float(second.K[1, 1] * np.tan(TURN_RAD))
    assert abs(away[0]) < 0.25 * expected_px
    assert abs(abs(away[1]) - expected_px) < 0.3 * expected_px
    assert np.linalg.norm(middle_px(turned, first.name) - middle_px(true, first.name)) < 0.5
    depth_m = np.median([m.cameras[second.name].shift_m for m in turned]) / np.tan(TURN_RAD)
    assert 1.0 < depth_m < 5.0
