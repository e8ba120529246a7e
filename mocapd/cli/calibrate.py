"""`mocapd calibrate`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.app.setup.folder_calibration_run import FolderOptions, calibrate_folder
from mocapd.cli.options import CameraOption, ConfigOption, ForceOption, SetOption, effective_config
from mocapd.errors import UsageError


def calibrate(
    step: Annotated[
        str | None,
        typer.Option(
            help="Do this step only, and keep the rest of the saved calibration: cameras, lens, "
            "room, colour, body or check."
        ),
    ] = None,
    demo: Annotated[
        bool,
        typer.Option(
            "--demo", help="Try it on simulated cameras with a simulated board and person."
        ),
    ] = False,
    cameras: CameraOption = None,
    state_dir: Annotated[
        Path | None,
        typer.Option(help="Where the calibration is saved [default: that of the config]."),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Open no browser: print the URL only.")
    ] = False,
    *,
    from_folder: FolderOptions,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Calibrate cameras, room, colours and wearer, on a page in the browser.

    Attaches to the running daemon, else opens the cameras itself; prints the page's URL, and opens
    the browser when there is a desktop. The saved calibration stays until you save a new one.

    Example: mocapd calibrate

    From recordings, without a page: mocapd calibrate --from-folder boards --out rig.json
    --board-size 4x5 --square 0.054 --marker 0.0405 --inverted --floor-frame 12
    """
    effective = effective_config(
        config, settings, cameras, state_dir=None if state_dir is None else str(state_dir)
    )
    if from_folder.folder is not None:
        calibrate_folder(from_folder.folder, from_folder, effective.config, force=force)
        return
    if from_folder.needs_folder or force:
        raise UsageError(
            "--out, --strokes, --floor-frame, --force and --json are for --from-folder",
            "command line",
            "leave them out, or add --from-folder DIR",
        )
    from mocapd.app.setup.setup_run import PageOptions, calibrate_page

    wanted = PageOptions(step, demo, own_place=state_dir is not None, browser=not no_browser)
    raise typer.Exit(calibrate_page(wanted, effective))
