"""A first pose from keypoints before four cameras, of which some show the person badly or never without the person."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.joint_term import JointRays, JointTerm
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.keypoints.keypoint_detection import CameraKeypoints
from mocapd.tracking.initialisers.keypoint_initialiser import (
    KeypointCandidate,
    KeypointInitialiser,
)
from mocapd.tracking.initialisers.standing_initialiser import PersonCandidate, blob_within
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, UNKNOWN
from tests.tracking.initialisers.test_first_pose_all_around import CAMERAS, FITTER
from tests.tracking.initialisers.test_keypoint_pose import seen_by
from tests.tracking.initialisers.test_standing_initialiser import BODY, turned

pytestmark = pytest.mark.kernels

STATE = turned(0.7)
BLURRED_M = 0.25


def drawn(camera: int) -> Bytes:
    """The person's outline in a camera's picture."""
    foreground, drawing = np.zeros((240, 320), np.uint8), FITTER.drawings[camera]
    roi = drawing.region(STATE, 0.0, 10)
    assert roi is not None
    x0, y0, x1, y1 = roi
    foreground[y0:y1, x0:x1] = np.where(drawing.render(STATE, 0.0, roi) > 0, BEFORE, BACKGROUND)
    return foreground


class Network:
    """The true keypoints; in some cameras they are blurred and beside the person."""

    def __init__(self, blurred: Iterable[int]) -> None:
        self._blurred = set(blurred)

    def detector(self, *args: object) -> Callable[[int], JointRays]:
        found: Any = args[-1]

        def detect(i: int) -> JointRays:
            rays = seen_by(CAMERAS[i], FITTER.joints(STATE)[0])
            if i in self._blurred:
                n = len(rays.joints)
                blur = np.tile([1.0 / BLURRED_M**2, 0.0, 1.0 / BLURRED_M**2], (n, 1))
                rays = replace(rays, xy=rays.xy + 0.2, information=blur)
            nothing: Any = None
            found[i] = CameraKeypoints(rays, np.zeros(0, np.float32), nothing)
            return rays

        return detect

    def term(self, _: object, rays: Iterable[JointRays]) -> tuple[JointTerm, ...]:
        kept = list(rays)
        return (JointTerm(BODY, kept),) if kept else ()


def attempt(
    blurred: Iterable[int], unknown: Iterable[int] = ()
) -> tuple[KeypointInitialiser, KeypointCandidate | None]:
    """unknown: cameras that know the background about the head alone; the network shows the person."""
    views, blobs = [], {}
    for i in range(4):
        truth = drawn(i)
        foreground = truth.copy()
        if i in unknown:
            rows = np.flatnonzero(truth.any(axis=1))
            foreground[rows[0] + 15 : rows[-1] + 10] = UNKNOWN
        blob = blob_within(foreground, np.ones_like(foreground))
        assert blob is not None
        x0, y0, w, h = cv2.boundingRect(truth)
        roi = (x0 - 20) & ~1, (y0 - 20) & ~1, (x0 + w + 20) & ~1, (y0 + h + 20) & ~1
        here = np.s_[roi[1] : roi[3], roi[0] : roi[2]]
        blobs[i] = replace(
            blob, mask=(foreground == BEFORE)[here].astype(np.uint8),
            has_background=(foreground != UNKNOWN)[here], roi=roi,
        )  # fmt: skip
        views.append(SimpleNamespace(person_in=lambda *_, truth=truth: truth > 0))
    shown: Any = SimpleNamespace(each=views, present=dict.fromkeys(range(4), 0.0))
    network: Any = Network(blurred)
    p = ClothesParams()
    looks = KeypointInitialiser(
        FITTER, FloorTerm(BODY), network, shown, CAMERAS, p.start, p.keypoint_start
    )
    person = PersonCandidate(STATE.root_m * (1.0, 0.0, 1.0), blobs, 0.0)
    middle_m = STATE.root_m + np.array([0.1, 0.1, -0.1])
    return looks, looks.attempt(middle_m, person, False, STATE.factors, STATE.information)


@pytest.mark.parametrize("unknown", [(), (0, 1, 2)], ids=["known", "unknown"])
@pytest.mark.parametrize("blurred", [(), (3,)], ids=["sharp", "one blurred"])
def test_a_person_is_found(blurred: tuple[int, ...], unknown: tuple[int, ...]) -> None:
    looks, found = attempt(blurred, unknown)
    assert found is not None
    assert looks.is_person(found)
    assert set(found.person.blobs) == {0, 1, 2, 3} - set(blurred)
    off_m = FITTER.joints(found.fit.state)[0] - FITTER.joints(STATE)[0]
    assert np.linalg.norm(off_m, axis=1).mean() < 0.04
    assert found.fit.explained > 0.85


def test_nobody_is_found_by_half_of_the_cameras() -> None:
    assert attempt((1, 2))[1] is None
