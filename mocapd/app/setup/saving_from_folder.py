"""Saves a calibration from recordings as the daemon's calibration file, with colours from stroke images."""

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import mocapd
from mocapd.boundary.files import is_file
from mocapd.calibrate.board.board_recordings import find_recordings
from mocapd.calibrate.colours.stroke_check import require_good_strokes
from mocapd.calibrate.extrinsics.folder_calibration import CameraReport, FolderCalibration
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.calibration.saved_calibration import (
    SCHEMA,
    ColourFit,
    LensFit,
    Made,
    RoomFit,
    SavedCalibration,
    SavedCamera,
)
from mocapd.config.sections import CameraSection
from mocapd.errors import InputError
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.colour.strokes import read_labelled, require_pictures, strokes_path
from mocapd.types import Camera, Floats, LabelledPicture, Rig
from mocapd.wizard.saving import NOT_WRITTEN_YET, figure, login_name


def stroked_pictures(strokes: Path, rig: Rig) -> dict[str, LabelledPicture]:
    """Reads NAME.png with NAME_strokes.png of each camera that has them. Raises InputError when none has, or for bad
    strokes."""
    require_pictures(strokes)
    model = colour_model(())
    pictures = {}
    for camera in rig.cameras:
        image = strokes / f"{camera.name}.png"
        if not is_file(image):
            continue
        picture = read_labelled(image)
        require_good_strokes(picture.pixels, picture.labels, model, str(strokes_path(image)))
        pictures[camera.name] = picture
    if not pictures:
        names = ", ".join(f"{name}.png" for name in rig.names)
        raise InputError("holds no picture of a camera", str(strokes), f"put {names} there")
    return pictures


def save_from_folder(
    out: Path,
    result: FolderCalibration,
    recordings: Path,
    floor_known: bool,
    pictures: Mapping[str, LabelledPicture],
    cameras: tuple[CameraSection, ...],
) -> None:
    """Writes the file. cameras: of the configuration; a camera's source is the configured one of the same id, else its
    recording. Raises CannotCreateError."""
    sources = {r.name: str(r.path.absolute()) for r in find_recordings(recordings)}
    sources |= {camera.id: camera.source for camera in cameras}
    area = result.play_area
    W = white_balances(pictures, colour_model(()))
    saved = SavedCalibration(
        schema=SCHEMA,
        made=Made(
            when=datetime.now(UTC).replace(microsecond=0),
            by=login_name(),
            mocapd=mocapd.__version__,
        ),
        room=RoomFit(
            method="board",
            rms_px=figure(result.rms_px),
            play_area_cm=None if area is None else figure(area.median_cm),
            floor_known=floor_known,
        ),
        board=result.board,
        camera=tuple(
            _camera(camera, sources[camera.name], result.cameras[camera.name], W.get(camera.name))
            for camera in result.rig.cameras
        ),
    )
    write_calibration(out, saved, pictures, own_folder=False)


def _camera(camera: Camera, source: str, report: CameraReport, W: Floats | None) -> SavedCamera:
    colour = None
    if W is not None:
        colour = ColourFit(picture=NOT_WRITTEN_YET, strokes=NOT_WRITTEN_YET, W=W.tolist())
    return SavedCamera(
        id=camera.name,
        source=source,
        size_px=camera.size_px,
        K=camera.K.tolist(),
        dist=camera.dist.tolist(),
        R=camera.R.tolist(),
        t_m=camera.t_m.tolist(),
        rms_px=figure(report.rms_px),
        lens=LensFit(
            rms_px=figure(report.rms_px),
            held_out_px=figure(report.held_out_px),
            views=report.views,
            focal_deviation=figure(report.focal_deviation),
        ),
        colour=colour,
    )
