"""Keypoints of a frame set before, moved on to this one.

The network takes a third of a frame set's time. Below a trunk that the shirt carries it runs after the body is published,
about that body, and what it finds is used in the next frame set. Without the shirt keypoints a frame set old are worse than
none, if they are all there is: the network runs before the fit in every second frame set. Before three cameras and more its
keypoints are used again in the others: a body that has them in every second one alone is pulled there and let go, at half
the frame rate.

A keypoint is moved as its joint is predicted to move, so what it says is by how far the fit before was off; the person's mask
is moved as the body's middle. docs/decisions/tracking-speed.md has figures.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays
from mocapd.geometry.camera_model import to_camera
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.keypoints.keypoint_detection import (
    CameraKeypoints,
    KeypointDetectors,
    no_detection,
)
from mocapd.types import Floats
from mocapd.vision.heatmaps.person_crop import PersonCrop, middle_of

_LAST_S = 0.15  # older keypoints say nothing of where a limb is
_NEAREST_M = 0.2  # of a joint that moves in a picture
_HIPS, _NECK = INDEX["hips"], INDEX["neck"]


@dataclass(frozen=True, slots=True, eq=False)
class _Detection:
    """At t_ns, about a body with joints at joints_m (J,3), by camera."""

    t_ns: int
    joints_m: Floats
    found: dict[int, CameraKeypoints]


class DelayedKeypoints:
    """Keeps the newest detection for later frame sets."""

    def __init__(self, detectors: KeypointDetectors) -> None:
        self._detectors = detectors
        self.reset()

    def reset(self) -> None:
        """Forgets it."""
        self._newest: _Detection | None = None

    def detect(
        self,
        fitter: Fitter,
        body: MotionState,
        t_ns: int,
        cameras: CameraViews,
        detecting: Collection[int],
    ) -> None:
        """Detects a body's keypoints in the pictures of t_ns, of these cameras."""
        joints = fitter.joints(body)
        each = fitter.each(
            lambda i: self._detectors.detect(fitter, body, joints, cameras, i), detecting
        )
        found = {i: one for i, one in zip(detecting, each, strict=True) if one is not None}
        self._newest = _Detection(t_ns, joints[0], found)

    def detector(
        self, fitter: Fitter, predicted: MotionState, t_ns: int, cameras: CameraViews
    ) -> Callable[[int], JointRays | None]:
        """See `KeypointDetectors.detector`; keeps what is detected, at t_ns."""
        found: dict[int, CameraKeypoints] = {}
        self._newest = _Detection(t_ns, fitter.joints(predicted)[0], found)
        return self._detectors.detector(fitter, predicted, cameras, found)

    def on_body(self, fitter: Fitter, body: MotionState, t_ns: int) -> None:
        """The body that was fitted to the frame set at t_ns: a detection of it is about that body."""
        if self._newest is not None and self._newest.t_ns == t_ns:
            self._newest = replace(self._newest, joints_m=fitter.joints(body)[0])

    def take(
        self, fitter: Fitter, predicted: MotionState, t_ns: int, cameras: CameraViews
    ) -> Callable[[int], JointRays | None]:
        """As `moved`; each detection is taken once."""
        moved = self.moved(fitter, predicted, t_ns, cameras)
        self.reset()
        return moved

    def moved(
        self, fitter: Fitter, predicted: MotionState, t_ns: int, cameras: CameraViews
    ) -> Callable[[int], JointRays | None]:
        """A function that gives the keypoints of the camera of an index, moved on to the predicted body at t_ns, and marks
        the person in its picture."""
        newest = self._newest
        if newest is None or t_ns - newest.t_ns > nanoseconds(_LAST_S):
            return no_detection
        joints_m, _ = fitter.joints(predicted)

        def move(i: int) -> JointRays | None:
            found = newest.found.get(i)
            if found is None or i not in cameras.present:
                return None
            before, now = (to_camera(found.rays.camera, one) for one in (newest.joints_m, joints_m))
            crop = _moved_crop(found, before, now, fitter.drawings[i].image_scale)
            cameras.each[i].mark_person(found.odds, crop, is_new=False)
            return _moved_rays(found.rays, before, now)

        return move


def _moved_rays(rays: JointRays, before: Floats, now: Floats) -> JointRays:
    """As their joints go in the camera's frame [m], from before (J,3) to now (J,3)."""
    deeper_m = (now[:, 2] - now[_HIPS, 2]) - (before[:, 2] - before[_HIPS, 2])
    is_before = np.minimum(before[:, 2], now[:, 2]) > _NEAREST_M
    z, z_now = (np.where(is_before, one[:, 2], 1.0)[:, None] for one in (before, now))
    way = np.where(is_before[:, None], now[:, :2] / z_now - before[:, :2] / z, 0.0)
    j = rays.joints
    return replace(rays, xy=rays.xy + way[j], farther_m=rays.farther_m + deeper_m[j])


def _moved_crop(found: CameraKeypoints, before: Floats, now: Floats, smaller: float) -> PersonCrop:
    """As the middle of a body goes whose joints do, see `_moved_rays`, in a picture that is `smaller` times smaller than the
    camera's."""
    focal = found.rays.camera.K[[0, 1], [0, 1]] / smaller
    then, here = (middle_of(joints[_HIPS], joints[_NECK]) for joints in (before, now))
    if min(then[2], here[2]) < _NEAREST_M:
        return found.crop
    return found.crop.moved(focal * (here[:2] / here[2] - then[:2] / then[2]))
