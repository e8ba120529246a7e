"""`mocapd export`"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ConfigOption, ForceOption, SetOption, config_to_look_after

ExportTo = StrEnum("ExportTo", ["bvh", "glb", "vrma", "csv", "trc", "c3d"])
Up = StrEnum("Up", ["y", "z"])
Feet = StrEnum("Feet", ["tracked", "floor"])
Legs = StrEnum("Legs", ["seen", "all"])


def export(
    file: Annotated[Path, typer.Argument(help="A recording of `mocapd record`.")],
    to: Annotated[ExportTo, typer.Option("--to", help="The format.")],
    out: Annotated[
        Path | None, typer.Option("--out", help="The file to write [default: in FILE's folder]")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            "--rate",
            "--fps",
            help="Frames per second [Hz]; give that of a program which plays every file at its own rate "
            "[default: as recorded]",
            min=1.0,
            max=1000.0,
        ),
    ] = None,
    up: Annotated[
        Up, typer.Option(help="The axis that points up; glb and vrma have y by their format.")
    ] = Up["y"],
    feet: Annotated[
        Feet,
        typer.Option(help="floor: move the body up or down to put its feet on the floor."),
    ] = Feet["tracked"],
    legs: Annotated[
        Legs, typer.Option(help="seen: leave out a leg that no camera saw; all: export the guess.")
    ] = Legs["seen"],
    person: Annotated[int, typer.Option(help="Which person.", min=0)] = 0,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Export a recording's motion for other programs.

    bvh [cm], glb [m], vrma (avatars) [m], csv [m], trc [mm] or c3d [mm], at a constant rate; see docs/recording.md.

    Example: mocapd export training.mcap --to glb
    """
    from mocapd.app.recordings.exporting import motion_of
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.exports.export_options import ExportOptions, check_options, prepared_motion
    from mocapd.exports.formats import export_file, write_export
    from mocapd.outputs.mcap.recording_reader import RecordingReader

    options = ExportOptions(up.value == "z", legs.value == "all", feet.value == "floor")
    check_options(to, options)
    effective, error = config_to_look_after(config, settings)  # for the level of the log alone
    if error is not None:
        typer.echo(f"mocapd: the configuration is left out: {error}", err=True)
    set_up_logs(effective.config.log_level)
    path = out if out is not None else file.parent / f"{file.stem}.{to}"
    target = export_file(to, path, force, inputs=(file,))
    target.check()
    recorded = motion_of(RecordingReader(file), person, rate)
    motion, note = prepared_motion(recorded.motion, to, options)
    write_export(motion, to, target)
    gaps = f", {int(motion.gap.sum())} of them in gaps" if motion.gap.any() else ""
    lost = f"; frames without a person: {recorded.lost}" if recorded.lost else ""
    others = (
        f"; left out, frames of another skeleton: {recorded.other_skeleton}"
        if recorded.other_skeleton
        else ""
    )
    guessed = f"; {note}" if note else ""
    typer.echo(
        f"{path}: {len(motion.joints_m)} frames at {motion.rate_hz:g} Hz{gaps}{lost}{others}{guessed}",
        err=True,
    )
