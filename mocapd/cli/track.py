"""`mocapd track`"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, effective_config


class Variant(StrEnum):
    """How the colour tracker works."""

    FULL = "full"
    PAPER = "paper"


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("track")(track)


def track(
    capture: Annotated[Path, typer.Argument(help="A folder in the capture format.")],
    out: Annotated[Path, typer.Option("--out", help="The track to write (.npz).")],
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: that of the config]")
    ] = None,
    variant: Annotated[
        Variant, typer.Option(help="The full method, or the paper's own.")
    ] = Variant.FULL,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track a recorded capture offline, every frame.

    Writes joints and rotations. Twice the same input gives the same file.

    Example: mocapd track captures/office --out office.npz --tracker colour
    """
    from mocapd.cli.libraries import prepare_libraries

    effective = effective_config(config, settings, tracker__name=tracker).config
    prepare_libraries(effective.cache_dir)

    from mocapd.capture.folder import frame_sets, load_folder
    from mocapd.cli.progress import ProgressBars
    from mocapd.offline import check_writable, track_all, write_track
    from mocapd.tracker_setup import build_tracker, inputs_of_capture

    check_writable(out)
    folder = load_folder(capture)
    frames = max(camera.frames for camera in folder.cameras)
    inputs = inputs_of_capture(folder, effective.tracker.stature_m, variant.value)
    with ProgressBars() as progress:
        result = track_all(
            build_tracker(effective.tracker.name, inputs),
            frame_sets(folder),
            lambda done: progress(f"tracking {capture.name}", done, frames),
        )
    write_track(out, result)
    typer.echo(f"{out}: {len(result.times_s)} of {frames} frames with a person", err=True)
