"""`mocapd eval`"""

import json
import os
import shlex
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapd.cli.options import ConfigOption, SetOption, effective_config
from mocapd.errors import ConfigError

if TYPE_CHECKING:
    from mocapd.evaluate.runs import EvaluationResults

_COMPARABLE = "colour"


class Variant(StrEnum):
    """How the colour tracker works."""

    FULL = "full"
    PAPER = "paper"
    BASELINE = "baseline"


class Joints(StrEnum):
    """Which joints are scored."""

    UPPER = "upper"
    FULL = "full"
    ARMS = "arms"
    LEGS = "legs"


class Compare(StrEnum):
    """With what the full method is compared."""

    BASELINE = "baseline"


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("eval")(evaluate_captures)


def evaluate_captures(
    captures: Annotated[
        list[Path], typer.Argument(help="Folders in the capture format with a truth.npz.")
    ],
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: that of the config]")
    ] = None,
    variant: Annotated[
        Variant, typer.Option(help="The full method, the paper's own, or the paper's baseline.")
    ] = Variant.FULL,
    compare: Annotated[
        Compare | None,
        typer.Option(help="Run the full method, the paper's and the baseline, and compare them."),
    ] = None,
    joints: Annotated[Joints, typer.Option(help="Which joints are scored.")] = Joints.UPPER,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Write evaluation.md here, with plots when comparing."),
    ] = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track recorded captures offline and score them against their ground truth.

    Example: mocapd eval captures/office captures/gym --compare baseline --out docs
    """
    from mocapd.app.libraries import prepare_libraries

    effective = effective_config(config, settings, tracker__name=tracker).config
    name = effective.tracker.name
    if compare is not None and name != _COMPARABLE:
        raise ConfigError(
            f"the tracker {name!r} has no baseline",
            "--compare baseline",
            f"add --tracker {_COMPARABLE}",
        )
    prepare_libraries(effective.cache_dir)

    from mocapd.app.progress import ProgressBars
    from mocapd.calibration.record import Calibration
    from mocapd.evaluate import runs
    from mocapd.evaluate.capture_eval import open_case
    from mocapd.evaluate.page import write_page
    from mocapd.session.tracker_setup import cached, ready_tracker
    from mocapd.trackers.base import Tracker

    cases = [open_case(capture) for capture in captures]
    with ProgressBars() as progress:

        def build(known: Calibration, variant: str) -> Tracker:
            return ready_tracker(name, known, cached(effective.cache_dir, progress), variant)

        setting = runs.EvaluationSettings(
            build, effective.tracker.stature_m, joints.value, progress
        )
        if compare is None:
            results = runs.run(cases, variant.value, setting)
            title = name if name != _COMPARABLE else f"{name}, variant {variant.value}"
            findings = runs.EvaluationResults(title, joints.value, results, {}, ())
        else:
            findings = runs.compare(cases, name, setting)
    _print(findings, as_json)
    if out is not None:
        words = _command(captures, name, variant, compare, joints, out)
        for path in write_page(out, findings, shlex.join(words)):
            typer.echo(f"{path}: written", err=True)


def _print(findings: "EvaluationResults", as_json: bool) -> None:
    from mocapd.evaluate import report

    if as_json:
        told: dict[str, Any] = {"tracker": findings.tracker, "joints": findings.joints}
        told |= report.score_json(findings.results)
        if findings.comparison:
            told["comparison"] = {
                variant: report.score_json(results)
                for variant, results in findings.comparison.items()
            }
        if findings.rocs:
            told["roc"] = report.roc_json(findings.roc)
        typer.echo(json.dumps(told))
        return
    tables = [report.score_table(findings.results)]
    if findings.comparison:
        tables += report.comparison_tables(findings.comparison)
    if findings.rocs:
        tables.append(report.roc_table(findings.roc))
    typer.echo("\n\n".join(tables))


def _command(
    captures: list[Path],
    name: str,
    variant: Variant,
    compare: Compare | None,
    joints: Joints,
    out: Path,
) -> list[str]:
    """The command that repeats this run from the same folder."""
    words = ["mocapd", "eval", *(os.path.relpath(capture) for capture in captures)]
    words += ["--tracker", name]
    words += ["--joints", joints.value] if joints is not Joints.UPPER else []
    words += ["--compare", compare.value] if compare else ["--variant", variant.value]
    return [*words, "--out", os.path.relpath(out)]
