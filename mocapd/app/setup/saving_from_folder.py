"""Saves a calibration from recordings as the daemon's calibration file, with colours from stroke images."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mocapd.boundary.files import is_file
from mocapd.calibrate.board.board_recordings import find_recordings
from mocapd.calibrate.colours.stroke_check import require_good_strokes
from mocapd.calibrate.extrinsics.folder_calibration import CameraReport, FolderCalibration
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.config.sections import CameraSection
from mocapd.errors import InputError
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.colour.strokes import read_labelled, require_pictures, strokes_path
from mocapd.types import Camera, LabelledPicture, Rig
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality
from mocapd.wizard.saving import saved_of


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
    """Writes the file. cameras: of the configuration; a camera's source and rate are the configured ones of the same id, else
    those of its recording. Raises CannotCreateError."""
    sources = {r.name: str(r.path.absolute()) for r in find_recordings(recordings)}
    sources |= {camera.id: camera.source for camera in cameras}
    rates_hz = {name: round(report.rate_hz, 3) for name, report in result.cameras.items()}
    rates_hz |= {camera.id: camera.fps_hz for camera in cameras if camera.fps_hz is not None}
    area = result.play_area
    W = white_balances(pictures, colour_model(()))
    draft = Draft(
        cameras=tuple(
            DraftCamera(c.name, sources[c.name], c.size_px, rates_hz[c.name])
            for c in result.rig.cameras
        ),
        board=result.board,
        intrinsics={c.name: _lens(c, result.cameras[c.name]) for c in result.rig.cameras},
        rig=result.rig,
        extrinsics_quality=ExtrinsicsQuality(
            "board",
            result.rms_px,
            {name: report.fit.rms_px for name, report in result.cameras.items()},
            math.nan if area is None else area.median_cm,
        ),
        floor_known=floor_known,
        colours={name: DraftColours(picture, W[name]) for name, picture in pictures.items()},
    )
    write_calibration(out, *saved_of(draft), own_folder=False)


def _lens(camera: Camera, report: CameraReport) -> Intrinsics:
    """The camera's lens in the joint solution, with the figures of its report."""
    return Intrinsics(
        camera.size_px,
        camera.K,
        camera.dist,
        np.ones(len(camera.dist), bool),
        report.fit.rms_px,
        report.held_out_px,
        tuple(range(report.fit.views)),
        (),
        report.fit.focal_deviation,
    )
