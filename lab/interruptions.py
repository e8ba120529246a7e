"""Simulate a recording in which a jacket, the dark and an unplugged camera interrupt, and write cues.md.

python -m lab.interruptions --tracker auto --out docs
"""

import json
import sys

from lab.command_line import (
    JsonOption,
    OutOption,
    TrackerOption,
    prepared_config,
    repeat,
    run,
    tell_written,
)
from lab.pages import interruptions_page as page
from lab.simulated import recorded_set
from lab.studies import cue_changes
from mocapd.app.terminal.progress import ProgressBars
from mocapd.calibration.from_origin import from_capture
from mocapd.cli.options import ConfigOption, SetOption
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cache_resources, ready_tracker


def interruptions(
    tracker: TrackerOption = None,
    as_json: JsonOption = False,
    out: OutOption = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Which cues carry the body when something interrupts, and how far joints step when they change."""
    effective = prepared_config(config, settings, tracker)
    own = effective.tracker
    session = recorded_set.interrupted()
    with ProgressBars() as progress:
        case = open_case(recorded_set.recorded([session], effective.cache_dir, progress)[0])
        known = from_capture(case.folder).assuming(own.stature_m)
        resources = cache_resources(effective.cache_dir, progress, own.tracking)
        ready = ready_tracker(own.name, known, resources)
        found = cue_changes.interruptions(case, ready, progress)
    tables = page.figures_table(found), page.changes_table(found), page.errors_table(found)
    sys.stdout.write((json.dumps(page.as_json(found)) if as_json else "\n\n".join(tables)) + "\n")
    if out is not None:
        command = repeat("lab.interruptions", "--tracker", own.name, "--out", out)
        tell_written(page.write_page(out, found, page.spans_of(session.scenario), command))


if __name__ == "__main__":
    run(interruptions)
