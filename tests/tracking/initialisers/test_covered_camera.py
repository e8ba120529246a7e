"""Somebody else's head fills one of four pictures while a person is looked for."""

from collections.abc import Callable
from itertools import islice
from pathlib import Path

from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.evaluate.capture_eval import open_case
from mocapd.tracking.build import build_body_tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Tracking

FRAMES = 30  # the person is in view from the 21st


def test_the_person_is_found_by_the_other_cameras(dev_captures: Callable[[str], Path]) -> None:
    case = open_case(dev_captures("ring4_striped_throw"))
    known = from_capture(case.folder)
    tracker = build_body_tracker("markerless", known, None, clothes=True)
    shape, states = wearer_shape(known), []
    for frames in islice(frame_sets(case.folder), FRAMES):
        track = tracker.step(frames, shape)
        shape = track.shape
        states.append(track.body.tracking)
    assert states[-1] is Tracking.LIVE
