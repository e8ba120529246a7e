"""`mocapd replay`"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, VrmOption, effective_config, vrm_flags
from mocapd.errors import ConfigError, UsageError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mocapd.app.recordings.replay_run import ReplayPlace
    from mocapd.outputs.base import Sink
    from mocapd.outputs.output_table import OutputSection

SHOW_EVERY_S = 0.25


def replay(
    file: Annotated[Path, typer.Argument(help="A recording of `mocapd record`.")],
    speed: Annotated[
        float, typer.Option(help="2: twice as fast, 0.5: half.", min=0.01, max=100.0)
    ] = 1.0,
    loop: Annotated[bool, typer.Option("--loop", help="Over and over, until Ctrl-C.")] = False,
    from_s: Annotated[
        float, typer.Option("--from", help="Begin so far into it [s].", min=0.0)
    ] = 0.0,
    outputs: Annotated[
        list[str] | None,
        typer.Option("--output", help="Only this output; repeat it [default: all configured]"),
    ] = None,
    instance: Annotated[str | None, typer.Option(help="This daemon's name in the keys.")] = None,
    config: ConfigOption = None,
    settings: SetOption = None,
    vrm: VrmOption = None,
) -> None:
    """Play a recording through every configured output in real time.

    No camera is needed, and none is opened. Frames are stamped as if they were made now.

    Example: mocapd replay training.mcap --loop --from 12.5
    """
    from contextlib import ExitStack

    from mocapd.app.daemon.main_loop import Signals
    from mocapd.app.recordings.replay_run import Replay, ReplayParams
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.app.terminal.status_line import StatusLine
    from mocapd.outputs.instance import instance_name
    from mocapd.outputs.mcap.recording_reader import RecordingReader
    from mocapd.outputs.output_table import build_sinks

    flags = {"instance": instance, **vrm_flags(vrm)}
    effective = effective_config(config, settings, None, None, **flags).config
    set_up_logs(effective.log_level)
    name = instance_name(effective.instance)
    sinks = build_sinks(
        _selected_outputs(effective.outputs, outputs or ()), name, effective.prediction
    )
    if not sinks:
        raise ConfigError("no output is enabled", "outputs", "enable one, or name it by --output")
    signals = Signals()
    with ExitStack() as opened, StatusLine() as line:
        for sink in sinks:
            opened.callback(sink.close)
            sink.open()
        playing = Replay(RecordingReader(file), sinks, name, ReplayParams(speed, loop, from_s))
        signals.ends(playing)
        playing.start()
        while not playing.wait(SHOW_EVERY_S):
            line.say(lambda: _text(file, playing.place, sinks))
    typer.echo(f"{file}: {playing.place.frames} frames sent", err=True)
    raise typer.Exit(signals.exit_code)


def _selected_outputs(
    sections: "Mapping[str, OutputSection]", names: "Sequence[str]"
) -> "Mapping[str, OutputSection]":
    """The named outputs, enabled; without names all as configured. Raises UsageError."""
    from dataclasses import replace
    from typing import Any, cast

    for name in names:
        if name not in sections:
            raise UsageError(
                f"there is no output {name!r}", "--output", f"one of: {', '.join(sections)}"
            )
    if not names:
        return sections
    return {name: replace(cast(Any, sections[name]), enabled=True) for name in names}


def _text(file: Path, place: "ReplayPlace", sinks: "Sequence[Sink]") -> str:
    from mocapd.app.recordings.recording_run import duration

    parts = [f"replaying {file}", duration(place.at_s), f"{place.frames} frames"]
    if place.rounds:
        parts.append(f"round {place.rounds + 1}")
    for sink in sinks:
        status = sink.status()
        parts.append(f"{sink.name}: {'nobody listens' if not status.listeners else status.detail}")
    return " | ".join(parts)
