"""`mocapd record`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ConfigOption, ForceOption, SetOption, effective_config
from mocapd.errors import UnavailableError


def record(
    file: Annotated[
        Path | None,
        typer.Argument(help="The recording to make [default: mocapd-DATE-TIME.mcap here]"),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="How long [s]; else until Ctrl-C.", min=0.1)
    ] = None,
    pictures: Annotated[
        bool,
        typer.Option(
            "--pictures", help="The cameras' pictures too, as delivered; `mocapd track` reads it."
        ),
    ] = False,
    exact: Annotated[
        bool,
        typer.Option("--exact", help="Frames bit by bit as published: seven times the size."),
    ] = False,
    foxglove_hz: Annotated[
        float, typer.Option(help="Rate of bone transforms for Foxglove [Hz]; 0: none.", min=0.0)
    ] = 10.0,
    endpoint: Annotated[
        str | None,
        typer.Option(help="Zenoh endpoint of the daemon [default: that of the config]"),
    ] = None,
    instance: Annotated[str, typer.Option(help="Name of the daemon; *: the only one.")] = "*",
    timeout_s: Annotated[
        float, typer.Option("--timeout", min=0.0, help="How long to look for a daemon [s].")
    ] = 5.0,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Record the frames of a running daemon in an MCAP file.

    Includes the rest skeleton and the calibration; with --pictures also the cameras' pictures, from the daemon's
    page, and then only you can read the file. The daemon is not affected. After a crash at most the last second
    is lost. Ctrl-C ends the recording. If no frame came, the exit code is 69.

    Example: mocapd record training.mcap --seconds 60
    """
    from contextlib import ExitStack

    from mocapd.app.daemon.daemon_pictures import DaemonPictures
    from mocapd.app.daemon.main_loop import Signals
    from mocapd.app.recordings.published import PublishedStream
    from mocapd.app.recordings.recording_run import Recorder, default_path, duration
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.app.terminal.status_line import StatusLine
    from mocapd.cli.watch import link_of
    from mocapd.clock import monotonic_ns
    from mocapd.clock import seconds as in_seconds
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
    from mocapd.outputs.output_table import zenoh_section

    effective = effective_config(config, settings).config
    set_up_logs(effective.log_level)
    link = link_of(zenoh_section(effective.outputs), endpoint, instance, timeout_s)
    signals = Signals()
    path = file if file is not None else default_path()
    params = RecordingParams(exact, foxglove_hz, private=pictures, force=force)
    with ExitStack() as opened:
        stream = opened.enter_context(PublishedStream(link))
        page = None
        if pictures:
            folder = runtime_folder(effective.state_dir)
            page = opened.enter_context(DaemonPictures(folder, stream.instance))
        began_ns = monotonic_ns()
        writer = opened.enter_context(RecordingWriter(path, params, began_ns))
        recorder = Recorder(stream, writer, page, seconds)
        signals.ends(recorder)
        with StatusLine() as line:
            recorder.run(line)
    took_s = in_seconds(monotonic_ns() - began_ns)
    typer.echo(
        f"{path}: {duration(took_s)}, {writer.frames} frames ({recorder.missed} missed), "
        f"{f'{writer.pictures} pictures, ' if pictures else ''}"
        f"{writer.bytes / 1e6:.1f} MB",
        err=True,
    )
    if not (writer.frames or writer.pictures):
        raise UnavailableError(
            "no frame came, so nothing is recorded", str(path), "see `mocapd status`"
        )
