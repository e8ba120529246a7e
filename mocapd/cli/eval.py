"""`mocapd eval`"""

import json
import os
import shlex
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import (
    ConfigOption,
    ForceOption,
    SetOption,
    effective_config,
)
from mocapd.errors import UsageError
from mocapd.extras import require_extra


class Joints(StrEnum):
    """Which joints are scored."""

    UPPER = "upper"
    FULL = "full"
    ARMS = "arms"
    LEGS = "legs"


def evaluate_captures(
    captures: Annotated[
        list[Path] | None, typer.Argument(help="Folders in the capture format with a truth.npz.")
    ] = None,
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: that of the config]")
    ] = None,
    joints: Annotated[Joints, typer.Option(help="Which joints are scored.")] = Joints.UPPER,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Write evaluation.md here, with a plot.")
    ] = None,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track recorded captures offline and score them against their ground truth.

    Example: mocapd eval captures/office captures/gym --out scores
    """
    if not captures:
        raise UsageError("no capture is given", "mocapd eval", "name a folder that has a truth.npz")
    if out is not None:
        require_extra("plots", "mocapd eval --out")
    effective = effective_config(config, settings, tracker__name=tracker).config

    from mocapd.app.libraries import prepare_libraries

    name = effective.tracker.name
    prepare_libraries(effective.cache_dir)

    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.evaluate import runs, score_page
    from mocapd.evaluate.capture_eval import open_case
    from mocapd.evaluate.report import score_json, score_table
    from mocapd.session.tracker_setup import cache_resources, ready_tracker

    if out is not None:
        score_page.check_page(out, force)
    with ProgressBars() as progress:
        cases = [open_case(folder, compare=True) for folder in captures]
        resources = cache_resources(effective.cache_dir, progress)
        setting = runs.EvaluationSettings(
            lambda calibration: ready_tracker(name, calibration, resources),
            effective.tracker.stature_m,
            joints.value,
            progress,
        )
        results = runs.run(cases, setting)
    if as_json:
        scores = {"tracker": name, "joints": joints.value, **score_json(results)}
        typer.echo(json.dumps(scores))
    else:
        typer.echo(score_table(results))
    if out is not None:
        words = ["mocapd", "eval", *map(os.path.relpath, captures), "--tracker", name]
        words += ["--joints", joints.value] if joints is not Joints.UPPER else []
        words += ["--config", os.path.relpath(config)] if config else []
        # other settings change no score, and may hold a password
        for key in settings or ():
            words += ["--set", key] if key.startswith("tracker.") else []
        command = shlex.join([*words, "--out", os.path.relpath(out)])
        for path in score_page.write_page(out, results, name, joints.value, command, force):
            typer.echo(f"{path}: written", err=True)
