"""`mocapd calibrate`"""

from pathlib import Path
from typing import Annotated

import typer

from mocapd.cli.options import CameraOption, ConfigOption, ForceOption, SetOption, effective_config


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("calibrate")(calibrate)


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
    from_folder: Annotated[
        Path | None,
        typer.Option(
            help="No page: calibrate from recordings of the board, a video or a folder of pictures "
            "per camera, named as the camera. Frames of one index belong together.",
            metavar="DIR",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="From a folder: the rig to write (.json), or a calibration (.toml).",
            metavar="FILE",
        ),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--board-size", help="Columns x rows of squares, as 4x5.", metavar="CxR"),
    ] = None,
    square: Annotated[float | None, typer.Option(help="Side of a square [m].")] = None,
    board: Annotated[str, typer.Option(help="charuco or chessboard.")] = "charuco",
    marker: Annotated[float, typer.Option(help="Side of a marker [m]; ChArUco only.")] = 0.0,
    dictionary: Annotated[
        str, typer.Option(help="The markers' dictionary; ChArUco only.")
    ] = "DICT_4X4_1000",
    inverted: Annotated[
        bool, typer.Option("--inverted", help="White where other boards are black.")
    ] = False,
    legacy: Annotated[
        bool, typer.Option("--legacy", help="The layout of OpenCV before 4.6.")
    ] = False,
    two_sided: Annotated[
        bool,
        typer.Option("--two-sided", help="The back bears the mirror image; ChArUco only."),
    ] = False,
    floor_frame: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Index of a frame in which the board lies on the floor, printed side (of two: FRONT) up: "
            "there the world's origin is. Without it, up and floor are guessed.",
        ),
    ] = None,
    strokes: Annotated[
        Path | None,
        typer.Option(
            help="From a folder, into a .toml: pictures of the shirt, NAME.png of each camera with "
            "NAME_strokes.png (0 none, 1..10 the colour id).",
            metavar="DIR",
        ),
    ] = None,
    as_json: Annotated[
        bool,
        typer.Option("--json", help="From a folder: print one JSON object of how well it fits."),
    ] = False,
    force: ForceOption = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Calibrate cameras, room, colours and wearer, on a page in the browser.

    Attaches to the running daemon, else opens the cameras itself; prints the page's URL, and opens
    the browser when there is a desktop. What was saved before stays until the new one is saved.

    Example: mocapd calibrate

    From recordings, without a page: mocapd calibrate --from-folder boards --out rig.json
    --board-size 4x5 --square 0.054 --marker 0.0405 --inverted --floor-frame 12
    """
    effective = effective_config(
        config, settings, cameras, state_dir=None if state_dir is None else str(state_dir)
    ).config
    if from_folder is not None:
        from mocapd.app.setup.folder_calibration_run import FolderOptions, calibrate_folder

        options = FolderOptions(
            from_folder, out, size, square, board, marker, dictionary, inverted, legacy, two_sided,
            floor_frame, strokes, as_json, force,
        )  # fmt: skip
        calibrate_folder(options, effective)
        return
    from mocapd.app.setup.setup_run import PageOptions, calibrate_page

    if out is not None or strokes is not None or floor_frame is not None or as_json or force:
        from mocapd.errors import UsageError

        raise UsageError(
            "--out, --strokes, --floor-frame, --force and --json are for --from-folder",
            "command line",
            "leave them out, or add --from-folder DIR",
        )
    wanted = PageOptions(step, demo, own_place=state_dir is not None, browser=not no_browser)
    raise typer.Exit(calibrate_page(wanted, effective))
