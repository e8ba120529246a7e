"""`mocapd export`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ConfigOption, ForceOption, SetOption, effective_config
from mocapd.errors import UsageError


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("export")(export)


def export(
    file: Annotated[Path, typer.Argument(help="A recording of `mocapd record`.")],
    to: Annotated[str, typer.Option("--to", help="bvh, glb, csv, trc or c3d.")],
    out: Annotated[
        Path | None, typer.Option("--out", help="The file to write [default: beside FILE]")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            "--rate", help="Frames per second [Hz] [default: as recorded]", min=1.0, max=1000.0
        ),
    ] = None,
    person: Annotated[int, typer.Option(help="Which person.", min=0)] = 0,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Export a recording's motion for other programs.

    bvh [cm], glb [m], csv [m], trc [mm] or c3d [mm], at a constant rate; see docs/recording.md.

    Example: mocapd export training.mcap --to glb
    """
    from mocapd.app.recordings.exporting import motion_of
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.exports.formats import FORMATS, export_file, write_export
    from mocapd.outputs.mcap.recording_reader import RecordingReader

    if to not in FORMATS:
        raise UsageError(f"there is no format {to[:40]!r}", "--to", f"one of: {', '.join(FORMATS)}")
    set_up_logs(effective_config(config, settings).config.log_level)
    path = out if out is not None else file.with_suffix(f".{to}")
    target = export_file(to, path, force, inputs=(file,))
    target.check()
    found = motion_of(RecordingReader(file), person, rate)
    write_export(found.motion, to, target)
    motion = found.motion
    gaps = f", {int(motion.gap.sum())} of them in gaps" if motion.gap.any() else ""
    lost = f"; {found.lost} frames were without a person" if found.lost else ""
    others = (
        f"; {found.other_skeleton} frames of another skeleton were left out"
        if found.other_skeleton
        else ""
    )
    typer.echo(
        f"{path}: {len(motion.joints_m)} frames at {motion.rate_hz:g} Hz{gaps}{lost}{others}",
        err=True,
    )
