"""Score poses predicted for the time of display, beside the last pose held until then.

python -m lab.prediction CAPTURE...
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from lab.command_line import TrackerOption, prepared_config, run
from lab.studies.prediction_error import prediction_table
from mocapd.app.terminal.progress import ProgressBars
from mocapd.calibration.from_origin import from_capture
from mocapd.cli.options import ConfigOption, SetOption
from mocapd.evaluate.capture_eval import Case, open_case
from mocapd.session.tracker_setup import ReadyTracker, cache_resources, ready_tracker


def prediction(
    captures: Annotated[
        list[Path], typer.Argument(help="Folders in the capture format with a truth.npz.")
    ],
    tracker: TrackerOption = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """How far off the hands are, held and predicted, on recorded captures."""
    effective = prepared_config(config, settings, tracker)
    own = effective.tracker
    with ProgressBars() as progress:
        resources = cache_resources(effective.cache_dir, progress)

        def build(case: Case) -> ReadyTracker:
            known = from_capture(case.folder).assuming(own.stature_m)
            return ready_tracker(own.name, known, resources)

        cases = [open_case(capture) for capture in captures]
        text = prediction_table(cases, build, effective.smoothing.preset)
    sys.stdout.write(text + "\n")


if __name__ == "__main__":
    run(prediction)
