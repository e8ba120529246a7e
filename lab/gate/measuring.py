"""Track a recording of the gate several times, each from a stature that differs by a tenth of a millimetre."""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import islice

import numpy as np

from lab.gate.figures import NAMES, Figures, as_row, rest_figures, track_figures
from lab.gate.gate_file import GateRow
from lab.gate.sets import GateCase
from lab.studies.fewer_cameras import calibration_of, frame_sets_for
from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_record import Calibration
from mocapd.evaluate.capture_eval import BuildTracker
from mocapd.evaluate.recovery import recovery
from mocapd.session.offline import RecordedTrack, track_all
from mocapd.tracking.base import Probe, Track, Tracker, no_probe
from mocapd.types import BodyState, FrameSet

STEP_M = 1e-4  # between the statures of two runs


def measure(
    one: GateCase,
    build: BuildTracker,
    runs: int,
    stature_m: float,
    on_run: Callable[[int], None],
) -> GateRow:
    """`stature_m`: for recordings that do not say [m]; `on_run`: is given how many runs are done."""
    known = calibration_of(one.case, stature_m, lambda i, _: one.camera is None or i == one.camera)
    found: dict[str, list[float]] = {}
    for run in range(runs if one.by_chance else 1):
        figures = _figures(one, build, _nudged(known, run))
        for name, value in as_row(figures).items():
            found.setdefault(name, []).append(round(value, 4))
        on_run(run + 1)
    ordered = {name: found[name] for name in NAMES if name in found}
    return GateRow(set_name=one.set_name, name=one.name, joints=one.joints, runs=ordered)


def _nudged(known: Calibration, run: int) -> Calibration:
    """The same of somebody who is 0, 0.1, -0.1, 0.2 ... mm taller: where chance decides, another run."""
    steps = (run + 1) // 2 * (1 if run % 2 else -1)
    taller_m = (known.wearer.stature_m or 0.0) + STEP_M * steps
    return replace(known, wearer=replace(known.wearer, stature_m=taller_m))


class _Timed:
    """A tracker with stopwatches for the clock and for the processor."""

    def __init__(self, tracker: Tracker) -> None:
        self.name = tracker.name
        self.probe: Probe = no_probe
        self._tracker = tracker
        self.step_ms: list[float] = []
        self.cpu_ms: list[float] = []

    def reset(self, near: BodyState | None = None) -> None:
        self._tracker.reset(near)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        start_s, cpu_s = time.perf_counter(), time.process_time()
        track = self._tracker.step(frames, shape)
        self.step_ms.append(1000.0 * (time.perf_counter() - start_s))
        self.cpu_ms.append(1000.0 * (time.process_time() - cpu_s))
        return track


def _figures(one: GateCase, build: BuildTracker, known: Calibration) -> Figures:
    ready = build(known)
    timed = _Timed(ready.tracker)
    frame_sets = islice(frame_sets_for(one.case, known), 0, None, one.every)
    track = track_all(timed, ready.shape, frame_sets, lambda _: None)
    return replace(
        _scored(one, track),
        step_ms=float(np.median(timed.step_ms)),
        cpu_ms=float(np.mean(timed.cpu_ms)),
    )


def _scored(one: GateCase, track: RecordedTrack) -> Figures:
    figures = track_figures(one.case.truth, track, one.joints)
    frames = recovery(one.case.truth, track, one.joints)
    if frames is not None:
        figures = replace(figures, recovery_frames=min(frames, 1e4))
    if one.still_from_s is not None:
        rest = rest_figures(track, one.still_from_s)
        figures = replace(figures, tremble_mm=rest.tremble_mm, drift_mm=rest.drift_mm)
    return figures
