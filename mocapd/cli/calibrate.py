"""`mocapd calibrate`"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, effective_config

if TYPE_CHECKING:
    from mocapd.calibrate.folder import Calibration


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("calibrate")(calibrate)


def calibrate(
    from_folder: Annotated[
        Path,
        typer.Option(
            help="Recordings of the board: a video or a folder of pictures per camera, named as "
            "the camera. Frames of one index belong together.",
            metavar="DIR",
        ),
    ],
    out: Annotated[Path, typer.Option(help="The rig to write (.json).", metavar="RIG")],
    size: Annotated[
        str,
        typer.Option("--board-size", help="Columns x rows of squares, as 4x5.", metavar="CxR"),
    ],
    square: Annotated[float, typer.Option(help="Side of a square [m].")],
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
    floor_frame: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Index of a frame in which the board lies on the floor, printed side up: there "
            "the world's origin is. Without it, up and floor are guessed.",
        ),
    ] = None,
    no_browser: Annotated[  # noqa: ARG001  what scripts say; files are the way without a browser
        bool, typer.Option("--no-browser", help="Open no browser; from files none is opened.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object of how well it fits.")
    ] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
) -> None:
    """Calibrate lenses and room from recordings of a board.

    Finds the board, solves each lens and all cameras jointly, and writes the rig. What is there already
    stays as it is when anything is refused.

    Example: mocapd calibrate --from-folder boards --out rig.json --board-size 4x5 --square 0.054
    --marker 0.0405 --inverted --floor-frame 12
    """
    from mocapd.calibrate.board import BoardKind, BoardSpec, board_size
    from mocapd.cli.libraries import prepare_libraries
    from mocapd.cli.logs import set_up_logs
    from mocapd.errors import ConfigError

    if board not in tuple(BoardKind):
        raise ConfigError(f"--board {board}", "command line", "charuco or chessboard")
    columns, rows = board_size(size)
    spec = BoardSpec(BoardKind(board), columns, rows, square, marker, dictionary, inverted, legacy)
    effective = effective_config(config, settings).config
    set_up_logs(effective.log_level)
    prepare_libraries(effective.cache_dir)

    from mocapd.calibrate.folder import calibrate_folder
    from mocapd.calibrate.rig_writing import write_rig
    from mocapd.cli.progress import ProgressBars
    from mocapd.offline import check_writable

    check_writable(out)
    with ProgressBars() as progress:
        found = calibrate_folder(from_folder, spec, progress, floor_frame)
    write_rig(out, found.rig)
    for note in found.notes:
        typer.echo(f"mocapd: {note}", err=True)
    if as_json:
        print(json.dumps(_as_dict(found)))
    else:
        print(_as_text(found, out))


def _as_dict(found: "Calibration") -> dict[str, object]:
    area = found.play_area
    return {
        "rms_px": round(found.rms_px, 4),
        "play_area_cm": None
        if area is None
        else {"median": round(area.median_cm, 3), "p95": round(area.p95_cm, 3)},
        "positions": found.positions,
        "cameras": {
            name: {
                "rms_px": round(one.rms_px, 4),
                "held_out_px": round(one.held_out_px, 4),
                "views": one.views,
                "pictures": one.pictures,
                "covered": round(one.covered, 3),
                "delay_frames": round(one.delay_frames, 3),
                "focal_deviation": round(one.focal_deviation, 5),
            }
            for name, one in found.cameras.items()
        },
        "refused": {
            name: {
                "no_board": one.pictures - one.views - len(one.refused_views),
                "views": list(one.refused_views),
                "corners": one.refused_corners,
            }
            for name, one in found.cameras.items()
        },
        "board": {"inverted": found.board.inverted, "legacy": found.board.legacy},
        "notes": list(found.notes),
    }


def _as_text(found: "Calibration", out: Path) -> str:
    area = found.play_area
    cm = "" if area is None else f", {area.median_cm:.2f} cm in the play area"
    lines = [f"{out}: {found.rms_px:.2f} px{cm}, {found.positions} positions of the board"]
    lines += [
        f"{name}  {one.rms_px:.2f} px, {one.held_out_px:.2f} px held out, "
        f"{one.views} of {one.pictures} pictures"
        for name, one in found.cameras.items()
    ]
    return "\n    ".join(lines)
