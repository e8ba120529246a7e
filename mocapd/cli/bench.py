"""`mocapd bench`"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.child_process import child_command
from mocapd.cli.options import (
    ConfigOption,
    SetOption,
    effective_config,
)
from mocapd.errors import ConfigError, UsageError

if TYPE_CHECKING:
    from mocapd.evaluate.bench.bench_live import Watching

_DEFAULT = "sim:living_room"


def bench_command(
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: all that can track this input]")
    ] = None,
    capture: Annotated[
        str, typer.Option(help="A capture folder, or sim:SCENARIO.", metavar="FOLDER")
    ] = _DEFAULT,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    live: Annotated[
        bool, typer.Option("--live", help="Time the real daemon on simulated webcams instead.")
    ] = False,
    watched: Annotated[
        bool, typer.Option("--watched", help="With --live: a client has the daemon's page open.")
    ] = False,
    seconds: Annotated[
        float, typer.Option(help="How long --live runs [s].", min=1.0, max=86_400.0)
    ] = 60.0,
    endurance: Annotated[
        float | None,
        typer.Option(
            help="Repeat the input as fast as possible for this long [min].",
            metavar="MIN",
            min=0.0,
            max=10_000.0,
        ),
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option(
            help="Print the disk space of an hour of this motion, and the loss after a kill.",
            metavar="FILE",
        ),
    ] = None,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Time each stage of the trackers on decoded frames, the whole daemon, or recording.

    Example: mocapd bench --tracker shirt --json
    """
    from mocapd.app.libraries import prepare_libraries
    from mocapd.capture.kinds.source_kinds import is_simulated
    from mocapd.outputs.output_table import zenoh_section

    if recording is not None:
        _recording(recording)
        return
    effective = effective_config(config, settings, tracker__name=tracker).config
    if live and not is_simulated(capture):
        raise UsageError(f"--live with {capture}", "command line", "give sim:SCENARIO")
    if watched and not live:
        raise UsageError("--watched without --live", "command line", "add --live")
    if live and not zenoh_section(effective.outputs).enabled:
        raise ConfigError("--live without Zenoh", "zenoh.enabled", "the subscriber needs it")
    prepare_libraries(effective.cache_dir)

    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.evaluate.bench import bench_report
    from mocapd.evaluate.bench.bench_input import open_input
    from mocapd.evaluate.bench.bench_run import Bench

    own = effective.tracker
    with ProgressBars() as progress:
        played = open_input(capture, effective.cache_dir, own.stature_m, progress)
        bench = Bench(
            played, own.name if tracker else None, effective.cache_dir, own.tracking, progress
        )
        if live:
            command = _daemon_command(capture, config, settings)
            found = bench.live(command, seconds, _watching() if watched else None)
        elif endurance is not None:
            found = bench.endurance(endurance)
        else:
            found = bench.steps()
    for name, why in found.skipped.items():
        typer.echo(f"mocapd: {name} is left out: {why}", err=True)
    print(json.dumps(bench_report.as_json(found)) if as_json else bench_report.as_text(found))


def _recording(file: Path) -> None:
    from mocapd.evaluate.bench.bench_recording import as_lines, recording_cost

    for line in as_lines(recording_cost(file, hours=1.0)):
        print(line)


def _watching() -> "Watching":
    from mocapd.web.watcher import watching

    return watching


def _daemon_command(capture: str, config: Path | None, settings: list[str] | None) -> list[str]:
    """`mocapd run` as this command was called."""
    words = ["run", "--capture", capture]
    words += ["--config", str(config)] if config else []
    for setting in settings or ():
        words += ["--set", setting]
    return child_command("from mocapd.cli.main import main; main()", *words)
