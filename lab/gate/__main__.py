"""Track every set of recordings, and compare the figures with those of another commit.

python -m lab.gate CLIPS --captures CAPTURES --against OLD.json --out NEW.json
"""

import sys
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from lab.command_line import TrackerOption, prepared_config, run
from lab.gate.gate_file import GateRow, new_file, read_gate, write_gate
from lab.gate.measuring import measure
from lab.gate.report import report
from lab.gate.sets import SETS, cases_of
from lab.gate.verdict import failures
from mocapd.app.terminal.progress import ProgressBars
from mocapd.cli.options import ConfigOption, SetOption
from mocapd.errors import InputError
from mocapd.session.tracker_setup import Progress, cache_resources, ready_tracker

ROOT = Path(__file__).resolve().parents[2]
_NOT_PASSED = 1


def _tell(progress: Progress, name: str, runs: int, done: int) -> None:
    progress(name, done, runs)


def gate(
    clips: Annotated[Path, typer.Argument(help="A folder of clips of real motion (.npz).")],
    captures: Annotated[
        Path, typer.Option(help="A folder of captures with their truth, for the set dev.")
    ],
    tracker: TrackerOption = None,
    sets: Annotated[
        str, typer.Option(help=f"Some of {','.join(SETS)}, with commas between.")
    ] = ",".join(SETS),
    only: Annotated[str, typer.Option(help="Only recordings whose name holds this text.")] = "",
    runs: Annotated[
        int, typer.Option(min=1, help="How often a recording is tracked where chance decides.")
    ] = 3,
    against: Annotated[Path | None, typer.Option(help="The figures to compare with.")] = None,
    measured: Annotated[
        Path | None, typer.Option(help="Compare this file, and track nothing.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Keep the figures in this file.")
    ] = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Exit code 1 where something is worse by more than chance."""
    old = None if against is None else read_gate(against)
    if measured is not None:
        new = read_gate(measured)
    else:
        effective = prepared_config(config, settings, tracker)
        name = effective.tracker.name
        rows: list[GateRow] = []
        with ProgressBars() as progress:
            resources = cache_resources(effective.cache_dir, progress)
            for one in cases_of(
                tuple(sets.split(",")), clips, captures, effective.cache_dir, progress
            ):
                if only not in one.name:
                    continue
                rows.append(
                    measure(
                        one,
                        lambda known: ready_tracker(name, known, resources),
                        runs,
                        effective.tracker.stature_m,
                        partial(_tell, progress, one.name, runs),
                    )
                )
                if out is not None:  # a run that is ended keeps what it has
                    write_gate(out, new_file(name, rows, ROOT))
        if not rows:
            raise InputError("no recording is chosen", "--only", "choose another text")
        new = new_file(name, rows, ROOT)
    sys.stdout.write(report(old, new) + "\n")
    if old is not None and failures(old, new):
        raise typer.Exit(_NOT_PASSED)


if __name__ == "__main__":
    run(gate)
