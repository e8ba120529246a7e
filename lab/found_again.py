"""How soon, and how well, somebody is found again after pictures stopped for a moment, as on a machine that was busy.

python -m lab.found_again CLIPS --captures CAPTURES --sets dev,rings --only ring
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from lab.command_line import TrackerOption, prepared_config, run
from lab.gate.sets import cases_of
from mocapd.app.terminal.progress import ProgressBars
from mocapd.body.bones import NAMES
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import seconds
from mocapd.errors import InputError
from mocapd.evaluate.capture_eval import Case
from mocapd.evaluate.truth import Truth
from mocapd.session.tracker_setup import ReadyTracker, cache_resources, ready_tracker
from mocapd.types import Floats

_GAP_S = 1.2  # no pose is predicted over a second
_LATER_S = 0.3
_WRONG_M = 0.2


@dataclass(slots=True)
class Gap:
    """Found again after found_s [s]; off_m, later_m: root mean square distance of the joints then, and a moment later [m];
    NaN where it did not come to that."""

    found_s: float = np.nan
    off_m: float = np.nan
    later_m: float = np.nan


def gaps_of(case: Case, ready: ReadyTracker, every_s: float) -> Iterator[Gap]:
    """A gap after each `every_s` of tracking [s]."""
    shape, tracked_s, since_s = ready.shape, 0.0, np.nan
    gap: Gap | None = None
    left_out_until_s = last_s = -np.inf
    for frames in frame_sets(case.folder):
        t_s = seconds(frames.t_ns)
        if t_s < left_out_until_s:
            continue
        track = ready.tracker.step(frames, shape)
        shape = track.shape
        step_s, last_s = t_s - last_s, t_s
        if track.body.joints_m is None:
            continue
        off_m = _off_m(case.truth, track.body.joints_m, t_s)
        if gap is not None and np.isnan(gap.found_s):
            gap.found_s, gap.off_m, since_s, tracked_s = t_s - left_out_until_s, off_m, t_s, 0.0
        elif gap is not None and np.isnan(gap.later_m) and t_s - since_s >= _LATER_S:
            gap.later_m = off_m
        tracked_s += min(step_s, _LATER_S)
        if tracked_s >= every_s:
            if gap is not None:
                yield gap
            gap, left_out_until_s, tracked_s = Gap(), t_s + _GAP_S, 0.0
    if gap is not None and last_s - left_out_until_s >= _LATER_S:
        yield gap


def _off_m(truth: Truth, joints_m: Floats, t_s: float) -> float:
    now = int(np.argmin(np.abs(truth.times_s - t_s)))
    shown = [name for name in truth.names if name in NAMES]
    there = truth.joints_m[now][[truth.names.index(name) for name in shown]]
    off = joints_m[[NAMES.index(name) for name in shown]] - there
    return float(np.sqrt(np.mean(np.sum(off**2, axis=1))))


def _row(name: str, gaps: list[Gap]) -> str:
    found_s, off_m, later_m = np.array([(g.found_s, g.off_m, g.later_m) for g in gaps]).T
    missing = int(np.count_nonzero(np.isnan(found_s)))
    cells = ["", "", "", ""]
    if missing < len(gaps):
        cells[0] = f"{np.nanmedian(found_s):.2f}, {np.nanmax(found_s):.2f}"
        cells[1] = f"{100.0 * np.nanmean(off_m):.1f}"
    if np.isfinite(later_m).any():
        cells[2] = f"{100.0 * np.nanmean(later_m):.1f}"
        cells[3] = str(np.count_nonzero(later_m > _WRONG_M))
    return f"| {name} | {len(gaps)} | {missing} | " + " | ".join(cells) + " |"


def found_again(
    clips: Annotated[Path, typer.Argument(help="A folder of clips of real motion (.npz).")],
    captures: Annotated[Path, typer.Option(help="A folder of captures with their truth.")],
    tracker: TrackerOption = None,
    sets: Annotated[str, typer.Option(help="Some of the gate's sets.")] = "dev,rings",
    only: Annotated[str, typer.Option(help="Only recordings whose name holds this text.")] = "",
    every_s: Annotated[float, typer.Option(help="Tracked between two gaps [s].")] = 1.0,
) -> None:
    """A row for each recording, and one for all."""
    config = prepared_config(None, None, tracker)
    rows, everything = [], []
    with ProgressBars() as progress:
        resources = cache_resources(config.cache_dir, progress)
        for one in cases_of(tuple(sets.split(",")), clips, captures, config.cache_dir, progress):
            if only not in one.name:
                continue
            known = from_capture(one.case.folder).assuming(config.tracker.stature_m)
            ready = ready_tracker(config.tracker.name, known, resources)
            gaps = list(gaps_of(one.case, ready, every_s))
            progress(one.name, 1, 1)
            if gaps:
                rows.append(_row(one.name, gaps))
                everything += gaps
    if not everything:
        raise InputError("no recording is chosen", "--only", "choose another text")
    head = "| recording | gaps | not found | found after, at most [s] | off then [cm] | off 0.3 s later [cm] | wrong then |"
    sys.stdout.write("\n".join([head, "|---" * 7 + "|", *rows, _row("all", everything)]) + "\n")


if __name__ == "__main__":
    run(found_again)
