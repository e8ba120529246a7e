"""The commands: report, view, live, accuracy."""

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.errors import MocapdError, UnavailableError, UsageError

if TYPE_CHECKING:  # numpy, scipy and matplotlib: `--help` needs none of them
    from mocapd_analysis.measures import Measures

app = typer.Typer(
    name="mocapd-analysis",
    help="What a session of mocapd says about how somebody moved.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

FilesArgument = Annotated[
    list[Path],
    typer.Argument(
        help="One session, or two to compare: FILE.mcap of `mocapd record`, FILE.npz of `mocapd track`.",
        metavar="FILE...",
    ),
]
PersonOption = Annotated[int, typer.Option(help="Which person of a recording.", min=0)]


@app.command()
def report(
    files: FilesArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="The report to write [default: beside the first FILE, .html]"),
    ] = None,
    person: PersonOption = 0,
    name: Annotated[str, typer.Option("--name", help="Who was recorded, for its head.")] = "",
    date: Annotated[
        str, typer.Option("--date", help="When, for its head [default: as the recordings say]")
    ] = "",
    notes: Annotated[str, typer.Option("--notes", help="What you note, for its head.")] = "",
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write the report: FILE.html with its plots inside, FILE_measures.csv of all measures, FILE_frames.csv of every frame.

    Example: mocapd-analysis report monday.mcap friday.mcap --out week.html
    """
    from mocapd_analysis.csv_tables import frames_csv, measures_csv
    from mocapd_analysis.report import report_html
    from mocapd_analysis.report_files import FRAMES_CSV, MEASURES_CSV, REPORT_HTML, write_all
    from mocapd_analysis.report_head import ReportHead

    sessions = _measured(files, person)
    path = out if out is not None else files[0].with_suffix(".html")
    texts = [
        (path, REPORT_HTML, report_html(sessions, ReportHead(name, date, notes))),
        (path.with_name(f"{path.stem}_measures.csv"), MEASURES_CSV, measures_csv(sessions)),
    ]
    for number, found in enumerate(sessions):
        letter = f"_{'ab'[number]}" if len(sessions) > 1 else ""
        frames = path.with_name(f"{path.stem}{letter}_frames.csv")
        texts.append((frames, FRAMES_CSV, frames_csv(found)))
        _say_of(found.session.name, found.session.notes)
    write_all(texts, files, force)
    typer.echo("\n".join(str(one) for one, _, _ in texts))


PortOption = Annotated[
    int, typer.Option(help="Of the page; 0: any that is free.", min=0, max=65535)
]


@app.command()
def view(files: FilesArgument, person: PersonOption = 0, port: PortOption = 8765) -> None:
    """Replay one session in the browser, or two side by side: any viewpoint, slow motion, trails, speeds.

    Example: mocapd-analysis view monday.mcap friday.mcap
    """
    sessions = tuple(_measured(files, person))
    for found in sessions:
        _say_of(found.session.name, found.session.notes)
    from mocapd_analysis.viewer.moment import Moment

    viewer, moment = _viewer(), Moment(sessions)
    page = viewer.ViewerPage(port, " and ".join(found.session.name for found in sessions))
    typer.echo(f"{page.url} (Ctrl-C ends)")
    try:
        viewer.run(page, lambda: moment, lambda: False)
    finally:
        page.stop()


@app.command()
def live(
    endpoint: Annotated[str, typer.Option(help="Where mocapd publishes.")] = "tcp/127.0.0.1:7447",
    person: PersonOption = 0,
    port: PortOption = 8765,
) -> None:
    """Watch a running mocapd in the browser, with the last minute to go back to; waits for a daemon.

    Example: mocapd-analysis live
    """
    viewer = _viewer()
    from mocapd_analysis.live.feed import LiveFeed

    feed = LiveFeed(endpoint, person)
    page = viewer.ViewerPage(port, f"live: {endpoint}")
    typer.echo(f"{page.url} (Ctrl-C ends)")
    feed.start()
    try:
        viewer.run(page, feed.moment, lambda: False)
    finally:
        feed.stop()
        page.stop()


@app.command()
def accuracy(
    clips: Annotated[
        Path,
        typer.Argument(
            help="A folder of clips of real motion (.npz: fps, names, parents, rest_offsets, "
            "global_quats, hips_pos)."
        ),
    ],
    seeds: Annotated[int, typer.Option(help="How often noise is drawn.", min=1, max=20)] = 2,
) -> None:
    """How right the speeds are: peak speeds of wrists against the truth of many clips, by every method tried.

    Takes some minutes.

    Example: mocapd-analysis accuracy ../shared/motion/clips
    """
    from mocapd_analysis.accuracy.table import accuracy_tables

    for line in accuracy_tables(clips, seeds):
        typer.echo(line)


def _viewer() -> ModuleType:
    """The viewer, which needs viser."""
    try:
        from mocapd_analysis.viewer import page
    except ModuleNotFoundError as error:
        raise UnavailableError(
            f"the viewer needs {error.name}", fix=f"{sys.executable} -m pip install 'viser>=1.1,<2'"
        ) from None
    return page


def _measured(files: list[Path], person: int) -> "list[Measures]":
    from mocapd_analysis.measures import measure
    from mocapd_analysis.session_files import read_session

    if len(files) > 2:
        raise UsageError(f"{len(files)} sessions are too many", fix="give one, or two to compare")
    return [measure(read_session(path, person)) for path in files]


def _say_of(name: str, notes: tuple[str, ...]) -> None:
    for note in notes:
        typer.echo(f"{name}: {note}", err=True)


def main() -> None:
    """Run one command. An expected trouble is one line on stderr; its code is the exit code."""
    try:
        app(prog_name="mocapd-analysis")
    except MocapdError as error:
        typer.echo(f"mocapd-analysis: {error}", err=True)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
