"""`mocapd eval`"""

import json
import os
import shlex
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapd.cli.options import (
    ConfigOption,
    SetOption,
    VariantOption,
    effective_config,
    refuse_variant,
)
from mocapd.errors import ConfigError

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.evaluate.capture_eval import BuildTracker, Case
    from mocapd.evaluate.pages.failures_page import FailureOutcome
    from mocapd.evaluate.runs import EvaluationResults
    from mocapd.session.tracker_setup import Progress, ReadyTracker


class Joints(StrEnum):
    """Which joints are scored."""

    UPPER = "upper"
    FULL = "full"
    ARMS = "arms"
    LEGS = "legs"


class Worn(StrEnum):
    """What the people of simulated sessions wear."""

    SHIRT = "shirt"
    PLAIN = "plain"


class Compare(StrEnum):
    """With what the full method is compared."""

    BASELINE = "baseline"


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("eval")(evaluate_captures)


def evaluate_captures(
    captures: Annotated[
        list[Path] | None, typer.Argument(help="Folders in the capture format with a truth.npz.")
    ] = None,
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: that of the config]")
    ] = None,
    variant: VariantOption = None,
    compare: Annotated[
        Compare | None,
        typer.Option(
            help="Run the tracker, and beside it those it is measured by: as published, or without a step."
        ),
    ] = None,
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
    failures: Annotated[
        bool,
        typer.Option(
            "--failures",
            help="Simulate and score scenes that are known to be hard: seen from the side, legs that cross, a jacket.",
        ),
    ] = False,
    interruptions: Annotated[
        bool,
        typer.Option(
            "--interruptions",
            help="Simulate the last of those scenes alone, and tell who spoke when a jacket, the dark, ... interrupt.",
        ),
    ] = False,
    prediction: Annotated[
        bool,
        typer.Option("--prediction", help="Score poses predicted for the time of display instead."),
    ] = False,
    joints: Annotated[Joints, typer.Option(help="Which joints are scored.")] = Joints.UPPER,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="Write evaluation.md here, with plots when comparing; failures.md for --failures.",
        ),
    ] = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track recorded captures offline and score them against their ground truth.

    Example: mocapd eval captures/office captures/gym --compare baseline --out docs
    """
    from mocapd.app.libraries import prepare_libraries
    from mocapd.trackers.registry import TRACKERS, entry

    refuse_variant(variant)
    effective = effective_config(config, settings, tracker__name=tracker).config
    name, sections = effective.tracker.name, effective.tracker.sections
    rivals = entry(name).compared_with
    if compare is not None and not rivals:
        comparable = (known for known, one in TRACKERS.items() if one.compared_with)
        raise ConfigError(
            f"the tracker {name!r} has no baseline",
            "--compare baseline",
            f"add --tracker {' or '.join(comparable)}",
        )
    prepare_libraries(effective.cache_dir)

    from mocapd.app.progress import ProgressBars
    from mocapd.calibration.record import Calibration
    from mocapd.evaluate import runs
    from mocapd.evaluate.capture_eval import open_case
    from mocapd.evaluate.compare import FULL
    from mocapd.evaluate.pages import failures_page
    from mocapd.evaluate.pages.evaluation_page import write_page
    from mocapd.evaluate.pages.failures_page import outcomes
    from mocapd.evaluate.simulated import recorded_set
    from mocapd.session.tracker_setup import ReadyTracker, cached, ready_tracker

    folders = list(captures or ())
    if interruptions:
        if folders or simulated is not None or failures or prediction or compare is not None:
            raise ConfigError(
                "that recording is scored alone", "--interruptions", "leave the others out"
            )
        with ProgressBars() as progress:
            _interruptions(effective, as_json, out, progress)
        return
    if not folders and simulated is None and not failures:
        raise ConfigError(
            "no capture is given", "mocapd eval", "name one, or add --simulated CLIPS or --failures"
        )
    with ProgressBars() as progress:
        sessions = []
        if simulated is not None:
            sessions += recorded_set.planned(simulated, plain=clothes is Worn.PLAIN)
        hard = recorded_set.failures() if failures else []
        sessions += hard
        made = recorded_set.recorded(sessions, effective.cache_dir, progress)
        recorded_set.check_suits(name, sessions, made)
        folders += made
        given = set(captures or ())
        cases = [open_case(folder, compare=folder in given) for folder in folders]

        def build(known: Calibration, method: str) -> ReadyTracker:
            tracker, section = (name, sections[name]) if method == FULL else rivals[method]
            chosen = {**sections, tracker: section}
            resources = cached(effective.cache_dir, progress, sections=chosen)
            return ready_tracker(tracker, known, resources)

        if prediction:
            typer.echo(_prediction(cases, effective, build))
            return
        setting = runs.EvaluationSettings(
            build, effective.tracker.stature_m, joints.value, progress
        )
        if compare is None:
            results = runs.run(cases, FULL, setting)
            findings = runs.EvaluationResults(name, joints.value, results, {}, ())
        else:
            findings = runs.compare(cases, name, rivals, setting)
    scenes = outcomes(hard, findings.results[len(findings.results) - len(hard) :], joints.value)
    _print(findings, scenes, as_json)
    if out is not None:
        words = _command(captures or [], simulated, name, compare, joints, out)
        words[2:2] = ["--clothes", clothes.value] if simulated and clothes is Worn.PLAIN else []
        words[2:2] = ["--failures"] if failures else []
        command, written = shlex.join(words), []
        if len(findings.results) > len(hard):
            written += write_page(out, findings, command)
        if scenes:
            written += failures_page.write_page(out, scenes, name, joints.value, command)
        for path in written:
            typer.echo(f"{path}: written", err=True)


def _interruptions(config: "Config", as_json: bool, out: Path | None, progress: "Progress") -> None:
    from mocapd.calibration.from_origin import from_capture
    from mocapd.evaluate.capture_eval import open_case
    from mocapd.evaluate.interruptions import interruptions
    from mocapd.evaluate.pages import interruptions_page as page
    from mocapd.evaluate.simulated import recorded_set
    from mocapd.session.tracker_setup import cached, ready_tracker

    own = config.tracker
    session = recorded_set.interrupted()
    case = open_case(recorded_set.recorded([session], config.cache_dir, progress)[0])
    known = from_capture(case.folder).assuming(own.stature_m)
    resources = cached(config.cache_dir, progress, own, own.sections)
    found = interruptions(case, ready_tracker(own.name, known, resources), progress)
    tables = page.figures_table(found), page.switches_table(found), page.errors_table(found)
    typer.echo(json.dumps(page.as_json(found)) if as_json else "\n\n".join(tables))
    if out is not None:
        words = ["mocapd", "eval", "--interruptions", "--tracker", own.name]
        words += ["--out", os.path.relpath(out)]
        spans = page.spans_of(session.scenario)
        for path in page.write_page(out, found, spans, shlex.join(words)):
            typer.echo(f"{path}: written", err=True)


def _prediction(cases: "list[Case]", config: "Config", build: "BuildTracker") -> str:
    from mocapd.calibration.from_origin import from_capture
    from mocapd.evaluate.compare import FULL
    from mocapd.evaluate.prediction_error import prediction_table

    def built(case: "Case") -> "ReadyTracker":
        known = from_capture(case.folder).assuming(config.tracker.stature_m)
        return build(known, FULL)

    return prediction_table(cases, built, config.smoothing.preset)


def _print(findings: "EvaluationResults", scenes: "list[FailureOutcome]", as_json: bool) -> None:
    from mocapd.evaluate import report
    from mocapd.evaluate.pages import failures_page

    if as_json:
        told: dict[str, Any] = {"tracker": findings.tracker, "joints": findings.joints}
        told |= report.score_json(findings.results)
        if findings.comparison:
            told["comparison"] = {
                method: report.score_json(results)
                for method, results in findings.comparison.items()
            }
        if findings.rocs:
            told["roc"] = report.roc_json(findings.roc)
        if scenes:
            told["failures"] = failures_page.as_json(scenes)
        typer.echo(json.dumps(told))
        return
    tables = [report.score_table(findings.results)]
    if findings.comparison:
        tables += report.comparison_tables(findings.comparison)
    if findings.rocs:
        tables.append(report.roc_table(findings.roc))
    if scenes:
        tables.append(failures_page.outcomes_table(scenes))
    typer.echo("\n\n".join(tables))


def _command(
    captures: list[Path],
    simulated: Path | None,
    name: str,
    compare: Compare | None,
    joints: Joints,
    out: Path,
) -> list[str]:
    """The command that repeats this run from the same folder."""
    words = ["mocapd", "eval", *(os.path.relpath(capture) for capture in captures)]
    words += ["--simulated", os.path.relpath(simulated)] if simulated else []
    words += ["--tracker", name]
    words += ["--joints", joints.value] if joints is not Joints.UPPER else []
    words += ["--compare", compare.value] if compare else []
    return [*words, "--out", os.path.relpath(out)]
