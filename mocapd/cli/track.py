"""`mocapd track`"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import (
    ConfigOption,
    ForceOption,
    SetOption,
    effective_config,
)


class RoomSeen(StrEnum):
    """The part of a recording for learning the empty room."""

    EMPTY = "empty"
    WHOLE = "whole"


def track(
    capture: Annotated[
        Path,
        typer.Argument(
            help="A folder in the capture format, or a recording with pictures (FILE.mcap).",
            metavar="CAPTURE",
        ),
    ],
    out: Annotated[Path, typer.Option("--out", help="The track to write (.npz).")],
    tracker: Annotated[
        str | None, typer.Option(help="Which tracker [default: that of the config]")
    ] = None,
    calibration: Annotated[
        Path | None,
        typer.Option(
            help="A calibration saved by `mocapd calibrate` (its file or folder), in place of the "
            "capture's own rig, wearer and colours.",
            metavar="PLACE",
        ),
    ] = None,
    room: Annotated[
        RoomSeen,
        typer.Option(
            help="Where a tracker without the shirt learns the empty room: from the frames before a person comes, or "
            "from the whole recording, if it has a person from the first frame on.",
        ),
    ] = RoomSeen.EMPTY,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Track a recorded capture offline, every frame.

    Writes joints and rotations. Twice the same input gives the same file.

    Example: mocapd track captures/office --out office.npz --tracker shirt
    """
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs

    effective = effective_config(config, settings, tracker__name=tracker).config
    set_up_logs(effective.log_level)
    prepare_libraries(effective.cache_dir)

    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.calibration.calibration_file import (
        calibration_of_recording,
        calibration_path,
        load_calibration,
    )
    from mocapd.calibration.from_origin import from_origin
    from mocapd.capture.kinds.source_kinds import open_origin
    from mocapd.session.capture_checks import check_capture
    from mocapd.session.offline import (
        learn_room,
        track_all,
        track_file,
        why_missing,
        write_track,
    )
    from mocapd.session.tracker_setup import cache_resources, ready_tracker

    read = (capture,) if calibration is None else (capture, calibration)
    target = track_file(out, force, inputs=read)
    target.check()
    own = effective.tracker
    with ProgressBars() as progress:
        origin = open_origin(str(capture), effective.cache_dir, progress)
        if calibration is None:
            setup = from_origin(origin)
        else:
            saved = load_calibration(calibration_path(calibration))
            setup = calibration_of_recording(saved, origin)
        checked = check_capture(origin, setup.rig, setup.wearer.stature_m)
        ready = ready_tracker(
            own.name,
            setup.assuming(own.stature_m),
            cache_resources(effective.cache_dir, progress, own.tracking),
        )
        if room is RoomSeen.WHOLE:
            learn_room(ready.tracker, checked.frame_sets(), origin.count)
        result = track_all(
            ready.tracker,
            ready.shape,
            checked.frame_sets(),
            lambda done: progress(f"tracking {capture.name}", done, origin.count),
            checked.result.off_m,
        )
    write_track(target, result)
    typer.echo(f"{out}: {len(result.times_s)} of {origin.count} frames with a person", err=True)
    why = why_missing(result, origin.count)
    if why:
        typer.echo(f"mocapd: {why}", err=True)
