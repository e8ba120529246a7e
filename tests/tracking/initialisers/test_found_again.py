"""Somebody is found again where the light on the floor changed while nobody was tracked."""

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import seconds
from mocapd.evaluate.capture_eval import open_case
from mocapd.evaluate.recovery import frame_errors_m
from mocapd.session.offline import track_all
from mocapd.tracking.build import build_body_tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import FrameSet

SHOWN_S = 1.8  # then no pictures come
GAP_S = 1.2  # so that no pose is predicted; somebody walks past the lamp meanwhile
SEARCHED = 30  # frame sets


def test_after_a_gap_in_which_a_lamp_was_covered(dev_captures: Callable[[str], Path]) -> None:
    case = open_case(dev_captures("ring4_plain_kick"))
    known = from_capture(case.folder)
    tracker = build_body_tracker("markerless", known, None, clothes=True)
    times_s: list[float] = []

    def shown() -> Iterator[FrameSet]:
        for frames in frame_sets(case.folder):
            t_s = seconds(frames.t_ns)
            if not SHOWN_S < t_s < SHOWN_S + GAP_S:
                times_s.append(t_s)
                yield frames

    before = int(SHOWN_S * 30) + SEARCHED
    track = track_all(tracker, wearer_shape(known), islice(shown(), before), lambda _: None)
    off_m = frame_errors_m(case.truth, track, "full")
    assert off_m[np.argmin(np.abs(case.truth.times_s - times_s[-1]))] < 0.15
