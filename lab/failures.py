"""Simulate scenes that are known to be hard, score them, and write failures.md.

python -m lab.failures --tracker markerless --joints full --out docs
"""

import json
import sys
from typing import Any

from lab.command_line import (
    JointsOption,
    JsonOption,
    OutOption,
    TrackerOption,
    prepared_config,
    repeat,
    run,
    tell_written,
)
from lab.pages import failures_page as page
from lab.simulated import recorded_set
from mocapd.app.terminal.progress import ProgressBars
from mocapd.cli.eval import Joints
from mocapd.cli.options import ConfigOption, SetOption
from mocapd.evaluate import report, runs
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cache_resources, ready_tracker


def failures(
    tracker: TrackerOption = None,
    joints: JointsOption = Joints.UPPER,
    as_json: JsonOption = False,
    out: OutOption = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Somebody seen from the side, legs that cross, a jacket: how soon each is right again."""
    effective = prepared_config(config, settings, tracker)
    name = effective.tracker.name
    sessions = recorded_set.failures()
    with ProgressBars() as progress:
        made = recorded_set.recorded(sessions, effective.cache_dir, progress)
        recorded_set.check_suits(name, sessions, made)
        resources = cache_resources(effective.cache_dir, progress)
        setting = runs.EvaluationSettings(
            lambda known: ready_tracker(name, known, resources),
            effective.tracker.stature_m,
            joints.value,
            progress,
        )
        results = runs.run([open_case(folder) for folder in made], setting)
    scenes = page.outcomes(sessions, results, joints.value)
    if as_json:
        scores: dict[str, Any] = {"tracker": name, "joints": joints.value}
        scores |= report.score_json(results) | {"failures": page.as_json(scenes)}
        text = json.dumps(scores)
    else:
        text = f"{report.score_table(results)}\n\n{page.outcomes_table(scenes)}"
    sys.stdout.write(text + "\n")
    if out is not None:
        words = ["--tracker", name]
        words += ["--joints", joints.value] if joints is not Joints.UPPER else []
        command = repeat("lab.failures", *words, "--out", out)
        tell_written(page.write_page(out, scenes, name, joints.value, command))


if __name__ == "__main__":
    run(failures)
