"""Score a tracker before cameras all around: simulated sessions, and captures of which each camera is left out in turn.

python -m lab.rings CLIPS [CAPTURE...] --tracker auto --out docs
"""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from lab.command_line import OutOption, TrackerOption, prepared_config, repeat, run, tell_written
from lab.pages import rings_page as page
from lab.simulated import recorded_set
from lab.studies.ring_scores import ring_score
from mocapd.app.terminal.progress import ProgressBars
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import load_folder
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cache_resources, ready_tracker


def rings(
    clips: Annotated[Path, typer.Argument(help="A folder of clips of real motion (.npz).")],
    captures: Annotated[
        list[Path] | None, typer.Argument(help="Folders of captures of three cameras or more.")
    ] = None,
    tracker: TrackerOption = None,
    out: OutOption = None,
) -> None:
    """A row for each recording, and means by the number of cameras."""
    config = prepared_config(None, None, tracker)
    name, stature_m = config.tracker.name, config.tracker.stature_m
    with ProgressBars() as progress:
        resources = cache_resources(config.cache_dir, progress)
        sessions = recorded_set.planned(clips, "rings")
        folders = recorded_set.recorded(sessions, config.cache_dir, progress)
        runs = [*((folder, "") for folder in folders), *_each_left_out(captures or ())]
        scores = []
        for folder, left_out in runs:
            case = open_case(folder)
            scores.append(
                ring_score(case, left_out, lambda known: ready_tracker(name, known, resources), stature_m)
            )  # fmt: skip
            progress("tracking", len(scores), len(runs))
    simulated, captured = scores[: len(folders)], scores[len(folders) :]
    sys.stdout.write(f"{page.sessions_table(simulated)}\n\n{page.left_out_table(captured)}\n")
    if out is not None:
        command = repeat("lab.rings", clips, *(captures or ()), "--tracker", name, "--out", out)
        tell_written(page.write_page(out, simulated, captured, name, command))


def _each_left_out(captures: Iterable[Path]) -> Iterator[tuple[Path, str]]:
    for folder in captures:
        rig = from_capture(load_folder(folder)).rig
        assert rig is not None  # of a capture
        yield from ((folder, left_out) for left_out in ("", *rig.names))


if __name__ == "__main__":
    run(rings)
