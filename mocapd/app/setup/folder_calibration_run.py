"""Implementation of `mocapd calibrate --from-folder`: calibrates from recordings of a board, without a page."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.errors import UsageError, usage_errors

if TYPE_CHECKING:
    from mocapd.calibrate.extrinsics.folder_calibration import FolderCalibration
    from mocapd.calibration.board_spec import BoardSpec
    from mocapd.config.sections import Config


_WORTH_SAYING = 0.1  # frames that a camera exposes later than the first


@dataclass(frozen=True)
class FolderOptions:
    """Options of the command line; None when not given."""

    folder: Annotated[
        Path | None,
        typer.Option(
            "--from-folder",
            help="No page: calibrate from recordings of the board, a video or a folder of pictures "
            "per camera, named as the camera. Frames of one index belong together.",
            metavar="DIR",
        ),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(
            help="From a folder: the rig to write (.json), or a calibration (.toml).",
            metavar="FILE",
        ),
    ] = None
    size: Annotated[
        str | None,
        typer.Option("--board-size", help="Columns x rows of squares, as 4x5.", metavar="CxR"),
    ] = None
    square_m: Annotated[float | None, typer.Option("--square", help="Side of a square [m].")] = None
    board: Annotated[str, typer.Option(help="charuco or chessboard.")] = "charuco"
    marker_m: Annotated[
        float, typer.Option("--marker", help="Side of a marker [m]; ChArUco only.")
    ] = 0.0
    dictionary: Annotated[str, typer.Option(help="The markers' dictionary; ChArUco only.")] = (
        "DICT_4X4_1000"
    )
    inverted: Annotated[
        bool, typer.Option("--inverted", help="White where other boards are black.")
    ] = False
    legacy: Annotated[bool, typer.Option("--legacy", help="The layout of OpenCV before 4.6.")] = (
        False
    )
    two_sided: Annotated[
        bool,
        typer.Option(
            "--two-sided", help="The board has the mirror image on its back; ChArUco only."
        ),
    ] = False
    floor_frame: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Index of a frame in which the board lies on the floor, printed side (of two: FRONT) up: "
            "there the world's origin is. Without it, up and floor are guessed.",
        ),
    ] = None
    strokes: Annotated[
        Path | None,
        typer.Option(
            help="From a folder, into a .toml: pictures of the shirt, NAME.png of each camera with "
            "NAME_strokes.png (0 none, 1..10 the colour id).",
            metavar="DIR",
        ),
    ] = None
    as_json: Annotated[
        bool,
        typer.Option("--json", help="From a folder: print one JSON object of how well it fits."),
    ] = False

    @property
    def needs_folder(self) -> bool:
        """True if an option is given that only --from-folder has a use for."""
        paths = self.out is not None or self.strokes is not None
        return paths or self.floor_frame is not None or self.as_json


def calibrate_folder(
    folder: Path, options: FolderOptions, config: "Config", *, force: bool
) -> None:
    """Detects the board, solves, writes the file. Raises MocapdError and then changes no file."""
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs

    out, spec = _complete(options)
    set_up_logs(config.log_level)
    prepare_libraries(config.cache_dir)

    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.calibrate.extrinsics.folder_calibration import calibrate_folder as solve
    from mocapd.calibrate.extrinsics.rig_writing import RIG, write_rig
    from mocapd.calibration.calibration_writing import CALIBRATION_KIND
    from mocapd.output_file import OutputFile

    read = (folder,) if options.strokes is None else (folder, options.strokes)
    kind = CALIBRATION_KIND if out.suffix == ".toml" else RIG
    target = OutputFile(out, kind, force, inputs=read)
    target.check()
    with ProgressBars() as progress:
        result = solve(folder, spec, progress, options.floor_frame)
    result = _with_notes(
        result, _missing_recordings(result.rig.names, [c.id for c in config.camera])
    )
    if out.suffix == ".toml":
        from mocapd.app.setup.saving_from_folder import save_from_folder, stroked_pictures

        strokes = options.strokes
        pictures = stroked_pictures(strokes, result.rig) if strokes is not None else {}
        if strokes is not None:
            result = _with_notes(result, _missing_strokes(set(result.rig.names) - set(pictures)))
        floor_known = options.floor_frame is not None
        save_from_folder(out, result, folder, floor_known, pictures, config.camera)
    else:
        write_rig(target, result.rig)
    for note in result.notes:
        typer.echo(f"mocapd: {note}", err=True)
    if options.as_json:
        print(json.dumps(_as_dict(result)))
    else:
        print(_as_text(result, out))


def _with_notes(result: "FolderCalibration", notes: tuple[str, ...]) -> "FolderCalibration":
    return replace(result, notes=(*result.notes, *notes))


def _missing_recordings(recorded: Sequence[str], configured: Sequence[str]) -> tuple[str, ...]:
    """A note that names configured cameras without a recording, if other configured cameras have one."""
    missing = [name for name in configured if name not in recorded]
    if not missing or len(missing) == len(configured):
        return ()
    names = ", ".join(missing)
    return (
        f"no recording of {names}, which the configuration names too: put it into the folder, named as the camera",
    )


def _missing_strokes(names: set[str]) -> tuple[str, ...]:
    """A note that names cameras without stroke pictures."""
    files = ", ".join(f"{name}.png" for name in sorted(names))
    note = (
        f"--strokes lacks {files}: those cameras see the shirt's colours as in neutral light"
        " until the colours are painted in the setup"
    )
    return (note,) if names else ()


def _complete(options: FolderOptions) -> tuple[Path, "BoardSpec"]:
    """The output file and the board. Raises UsageError that names all missing options."""
    from mocapd.calibration.board_spec import BoardKind, BoardSpec, board_size

    wanted = {"--out": options.out, "--board-size": options.size, "--square": options.square_m}
    missing = [name for name, value in wanted.items() if value is None]
    if options.out is None or options.size is None or options.square_m is None:
        raise UsageError(
            f"--from-folder needs {' and '.join(missing)} too",
            "command line",
            "add what is missing",
        )
    if options.board not in tuple(BoardKind):
        raise UsageError(f"--board {options.board}", "command line", "charuco or chessboard")
    if options.strokes is not None and options.out.suffix != ".toml":
        raise UsageError(
            "--strokes with a rig file", "command line", "colours go into --out NAME.toml only"
        )
    with usage_errors():
        columns, rows = board_size(options.size)
        spec = BoardSpec(
            BoardKind(options.board), columns, rows, options.square_m, options.marker_m,
            options.dictionary, options.inverted, options.legacy, options.two_sided,
        )  # fmt: skip
    return options.out, spec


def _as_dict(result: "FolderCalibration") -> dict[str, object]:
    area = result.play_area
    return {
        "rms_px": round(result.rms_px, 4),
        "play_area_cm": None
        if area is None
        else {"median": round(area.median_cm, 3), "p95": round(area.p95_cm, 3)},
        "positions": result.positions,
        "cameras": {
            name: {
                "rms_px": round(report.fit.rms_px, 4),
                "held_out_px": round(report.held_out_px, 4),
                "views": report.fit.views,
                "backs": report.backs,
                "pictures": report.pictures,
                "covered": round(report.covered, 3),
                "delay_frames": round(report.delay_frames, 3),
                "focal_deviation": round(report.fit.focal_deviation, 5),
                "place_cm": round(report.fit.place_cm, 3),
            }
            for name, report in result.cameras.items()
        },
        "refused": {
            name: {
                "no_board": report.no_board,
                "views": list(report.refused_views),
                "corners": report.fit.refused_corners,
            }
            for name, report in result.cameras.items()
        },
        "board": {
            "inverted": result.board.inverted,
            "legacy": result.board.legacy,
            "two_sided": result.board.two_sided,
        },
        "back": None
        if result.gluing is None
        else {name: round(value, 2) for name, value in asdict(result.gluing).items()},
        "notes": list(result.notes),
    }


def _as_text(result: "FolderCalibration", out: Path) -> str:
    area = result.play_area
    cm = "" if area is None else f", {area.median_cm:.2f} cm in the play area"
    lines = [f"{out}: {result.rms_px:.2f} px{cm}, {result.positions} positions of the board"]
    lines += [
        f"{name}  {report.fit.rms_px:.2f} px, {report.held_out_px:.2f} px held out, "
        f"{report.fit.views} of {report.pictures} pictures"
        + (
            f", {report.delay_frames:+.2f} frames late"
            if abs(report.delay_frames) >= _WORTH_SAYING
            else ""
        )
        + (f", {report.backs} of the board's back" if report.backs else "")
        for name, report in result.cameras.items()
    ]
    lines += [] if result.gluing is None else [f"the back of the board lies {result.gluing}"]
    return "\n    ".join(lines)
