"""Score captures and simulated sessions, also against the methods that a tracker is measured by; write evaluation.md.

python -m lab.evaluation CAPTURE... --tracker shirt --compare --out docs
"""

import json
import sys
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

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
from lab.compared.compared_runs import EvaluationResults, compare
from lab.compared.comparison_report import comparison_tables, roc_json, roc_table
from lab.compared.rivals import RIVALS, ready_rival
from lab.pages.evaluation_page import write_page
from lab.simulated.recorded_set import check_suits, planned, recorded
from mocapd.app.terminal.progress import ProgressBars
from mocapd.cli.eval import Joints
from mocapd.cli.options import ConfigOption, SetOption
from mocapd.errors import ConfigError
from mocapd.evaluate import report, runs
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cache_resources, ready_tracker


class Worn(StrEnum):
    """What the people of simulated sessions wear."""

    SHIRT = "shirt"
    PLAIN = "plain"


def evaluation(
    captures: Annotated[
        list[Path] | None, typer.Argument(help="Folders in the capture format with a truth.npz.")
    ] = None,
    tracker: TrackerOption = None,
    compare_with_rivals: Annotated[
        bool,
        typer.Option(
            "--compare",
            help="Run beside the tracker those it is measured by: as published, or without a step.",
        ),
    ] = False,
    simulated: Annotated[
        Path | None,
        typer.Option(
            help="A folder of clips of real motion (.npz): sessions of them are simulated, kept in the cache and scored."
        ),
    ] = None,
    clothes: Annotated[
        Worn,
        typer.Option(help="What the people of --simulated wear: the shirt, or plain clothes."),
    ] = Worn.SHIRT,
    joints: JointsOption = Joints.UPPER,
    as_json: JsonOption = False,
    out: OutOption = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track captures and simulated sessions offline and score them against their ground truth."""
    effective = prepared_config(config, settings, tracker)
    name = effective.tracker.name
    rivals = RIVALS.get(name, {})
    if compare_with_rivals and not rivals:
        raise ConfigError(
            f"the tracker {name!r} has no baseline",
            "--compare",
            f"add --tracker {' or '.join(RIVALS)}",
        )
    folders = list(captures or ())
    if not folders and simulated is None:
        raise ConfigError("no capture is given", "lab.evaluation", "name one, or add --simulated")
    with ProgressBars() as progress:
        if simulated is not None:
            sessions = planned(simulated, "plain" if clothes is Worn.PLAIN else "shirt")
            made = recorded(sessions, effective.cache_dir, progress)
            check_suits(name, sessions, made)
            folders += made
        given = set(captures or ())
        cases = [open_case(folder, compare=folder in given) for folder in folders]
        resources = cache_resources(effective.cache_dir, progress)
        setting = runs.EvaluationSettings(
            lambda known: ready_tracker(name, known, resources),
            effective.tracker.stature_m,
            joints.value,
            progress,
        )
        if compare_with_rivals:
            builds = {
                label: partial(ready_rival, build, resources) for label, build in rivals.items()
            }
            findings = compare(cases, name, builds, setting)
        else:
            results = runs.run(cases, setting)
            findings = EvaluationResults(name, joints.value, results, {}, ())
    sys.stdout.write((_as_json(findings) if as_json else _as_tables(findings)) + "\n")
    if out is not None:
        words: list[str | Path] = [*(captures or ())]
        if simulated is not None:
            words += ["--simulated", simulated]
            words += ["--clothes", clothes.value] if clothes is Worn.PLAIN else []
        words += ["--tracker", name]
        words += ["--joints", joints.value] if joints is not Joints.UPPER else []
        words += ["--compare"] if compare_with_rivals else []
        tell_written(write_page(out, findings, repeat("lab.evaluation", *words, "--out", out)))


def _as_json(findings: EvaluationResults) -> str:
    scores: dict[str, Any] = {"tracker": findings.tracker, "joints": findings.joints}
    scores |= report.score_json(findings.results)
    if findings.comparison:
        scores["comparison"] = {
            method: report.score_json(results) for method, results in findings.comparison.items()
        }
    if findings.rocs:
        scores["roc"] = roc_json(findings.roc)
    return json.dumps(scores)


def _as_tables(findings: EvaluationResults) -> str:
    tables = [report.score_table(findings.results)]
    if findings.comparison:
        tables += comparison_tables(findings.comparison)
    if findings.rocs:
        tables.append(roc_table(findings.roc))
    return "\n\n".join(tables)


if __name__ == "__main__":
    run(evaluation)
