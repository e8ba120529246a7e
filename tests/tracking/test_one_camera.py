"""The shirt before one camera, to which patches hardly say how far away an arm is."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.setup import setup_of
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Floats, Rig
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import auto_tracker
from tests.tracking.shirt_film import film
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

HANDS = [INDEX["leftHand"], INDEX["rightHand"]]
COUNT, LAST = 30, 15  # frames


def test_hands_are_about_as_far_away_as_they_look(pose_database: PoseDatabase) -> None:
    """Without their keypoints they are 0.11 m off."""
    filmed = film(stands=True, count=COUNT)
    known = calibration_of_setup(setup_of(filmed.scenario, filmed.renderers))
    assert known.rig is not None
    camera = known.rig.cameras[0]
    known = replace(known, rig=Rig((camera,)))
    tracker = Stepping(auto_tracker(known, pose_database), wearer_shape(known))

    def farther_m(joints_m: Floats) -> Floats:
        deep_m = to_camera(camera, joints_m)[:, 2]
        return np.asarray(deep_m[HANDS] - deep_m[INDEX["hips"]])

    off_m = []
    for one, true_m in zip(filmed.frame_sets(filmed.pictures), filmed.joints_m, strict=True):
        seen = replace(one, frames={camera.name: one.frames[camera.name]})
        found_m = tracker.step(seen).body.joints_m
        if found_m is not None:
            off_m.append(np.abs(farther_m(found_m) - farther_m(true_m)).mean())
    assert len(off_m) > LAST
    assert np.mean(off_m[-LAST:]) < 0.09
