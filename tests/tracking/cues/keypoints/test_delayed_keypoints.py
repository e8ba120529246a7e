"""Keypoints of one frame set in the next: moved as the body goes, used once, and not for long."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.cues.keypoints.delayed_keypoints import DelayedKeypoints
from mocapd.tracking.cues.keypoints.keypoint_detection import CameraKeypoints
from mocapd.types import Floats
from mocapd.vision.heatmaps.person_crop import PersonCrop
from tests.fit.term_system import BODY
from tests.fit.test_joint_term import CROSSING, FEET, seen_at
from tests.fit.test_pose_terms import ROOT, relaxed

pytestmark = pytest.mark.kernels

_NEXT_NS = nanoseconds(1 / 30)
_CROP = PersonCrop(0.5, np.array([3.0, -4.0]))
_HERE = MotionState(
    ROOT, relaxed(), np.zeros(BODY.n_pose), np.ones(BODY.n_shape), initial_information(BODY.space)
)
_THERE = replace(_HERE, root_m=ROOT + (0.10, 0.02, 0.06))


class _Seen:
    """A fitter, cameras that hold the marks of the person, and keypoints of a body 4 cm beside the fitted one."""

    def __init__(self) -> None:
        self.fitter = Fitter(BODY, shirt_labels(BODY), CROSSING, [1, 1], FitParams())
        self.marked: dict[int, PersonCrop] = {}
        each = [
            SimpleNamespace(
                mark_person=lambda _, crop, *, is_new, i=i: self.marked.update({i: crop})
            )
            for i in range(2)
        ]
        self.cameras = cast(Any, SimpleNamespace(present={0: 0.0, 1: 0.0}, each=each))
        self.true_m = self.joints_m(_HERE) + (0.0, 0.0, 0.04)
        self.keypoints = DelayedKeypoints(cast(Any, self))

    def joints_m(self, state: MotionState) -> Floats:
        return self.fitter.joints(state)[0]

    def detect(self, *args: Any) -> CameraKeypoints:
        """Stands in for `KeypointDetectors`."""
        rays = seen_at(self.true_m, 0.0, FEET, CROSSING)[args[-1]]
        return CameraKeypoints(rays, np.zeros((96, 96), np.float32), _CROP)

    def detector(self, *args: Any) -> Any:
        """Stands in for `KeypointDetectors`."""
        return lambda i: args[-1].setdefault(i, self.detect(i)).rays

    def rays(self, t_ns: int) -> list[Any]:
        take = self.keypoints.take(self.fitter, _THERE, t_ns, self.cameras)
        return [take(i) for i in self.cameras.present]


def test_keypoints_and_mask_go_on_as_the_body_does() -> None:
    seen = _Seen()
    seen.keypoints.detect(seen.fitter, _HERE, 0, seen.cameras, [0, 1])
    places_m, _ = JointTerm(BODY, seen.rays(_NEXT_NS)).crossings
    way_m = _THERE.root_m - _HERE.root_m
    assert np.abs(places_m[FEET] - seen.true_m[FEET] - way_m).max() < 0.004
    hips_px = [
        camera.K[[0, 1], [0, 1]] * there[:2] / there[2]
        for camera in CROSSING
        for there in to_camera(camera, seen.joints_m(_HERE)[[INDEX["hips"]]])
    ]
    for i, camera in enumerate(CROSSING):
        there = to_camera(camera, seen.joints_m(_THERE)[INDEX["hips"]])
        way_px = camera.K[[0, 1], [0, 1]] * there[:2] / there[2] - hips_px[i]
        moved = _CROP.corner_px - seen.marked[i].corner_px
        assert np.abs(moved / _CROP.scale - way_px).max() < 2.0


def test_each_detection_is_used_once() -> None:
    seen = _Seen()
    assert seen.rays(0) == [None, None]
    seen.keypoints.detect(seen.fitter, _HERE, 0, seen.cameras, [1])
    assert [one is None for one in seen.rays(_NEXT_NS)] == [True, False]
    assert seen.rays(_NEXT_NS) == [None, None]


def test_old_keypoints_are_left_out() -> None:
    seen = _Seen()
    seen.keypoints.detect(seen.fitter, _HERE, 0, seen.cameras, [0, 1])
    assert seen.rays(nanoseconds(0.3)) == [None, None]


def test_what_is_detected_before_the_fit_is_shared_with_the_next_frame_sets() -> None:
    """Moved from the body that was fitted to it, wherever that was predicted."""
    seen = _Seen()
    detect = seen.keypoints.detector(seen.fitter, _THERE, 0, seen.cameras)
    assert all(detect(i) is not None for i in seen.cameras.present)
    seen.keypoints.on_body(seen.fitter, _HERE, 0)
    for t_ns in (_NEXT_NS, 2 * _NEXT_NS):
        moved = seen.keypoints.moved(seen.fitter, _THERE, t_ns, seen.cameras)
        places_m, _ = JointTerm(
            BODY, [one for one in map(moved, seen.cameras.present) if one]
        ).crossings
        way_m = _THERE.root_m - _HERE.root_m
        assert np.abs(places_m[FEET] - seen.true_m[FEET] - way_m).max() < 0.004
