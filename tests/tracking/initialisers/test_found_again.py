"""Somebody is found again where the light on the floor changed while nobody was tracked."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import seconds
from mocapd.evaluate.capture_eval import open_case
from mocapd.tracking.build import build_body_tracker
from mocapd.tracking.tracker_inputs import wearer_shape

SHOWN_S = 1.8  # then no pictures come
GAP_S = 1.2  # so that no pose is predicted; somebody walks past the lamp meanwhile
SEARCHED = 30  # frame sets


def test_after_a_gap_in_which_a_lamp_was_covered(dev_captures: Callable[[str], Path]) -> None:
    case = open_case(dev_captures("ring4_plain_kick"))
    known = from_capture(case.folder)
    tracker = build_body_tracker("markerless", known, None, clothes=True)
    shape, after, off_m = wearer_shape(known), 0, np.inf
    for frames in frame_sets(case.folder):
        t_s = seconds(frames.t_ns)
        if SHOWN_S < t_s < SHOWN_S + GAP_S:
            continue
        track = tracker.step(frames, shape)
        shape = track.shape
        after += t_s > SHOWN_S
        if after and track.body.joints_m is not None:
            truth = case.truth
            now = int(np.argmin(np.abs(truth.times_s - t_s)))
            shown = [name for name in truth.names if name in NAMES]
            there = truth.joints_m[now][[truth.names.index(name) for name in shown]]
            found = track.body.joints_m[[NAMES.index(name) for name in shown]]
            off_m = float(np.sqrt(np.mean(np.sum((found - there) ** 2, axis=1))))
        if after == SEARCHED:
            break
    assert off_m < 0.15
