"""The draft as a saved calibration, and a saved calibration as a draft to go on with."""

import getpass
import math
import os
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

import mocapd
from mocapd.body.shape import FACTORS
from mocapd.boundary.numbers import brief
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.calibration_file import (
    FILE_NAME,
    calibration_path,
    read_calibration,
    write_calibration,
)
from mocapd.calibration.from_saved import from_saved
from mocapd.calibration.record import Calibration, ShirtColours, Wearer
from mocapd.calibration.saved_calibration import (
    SCHEMA,
    ColourFit,
    LensFit,
    Made,
    RoomFit,
    SavedCalibration,
    SavedCamera,
    SavedWearer,
)
from mocapd.calibration.shirt_pictures import personal_model
from mocapd.errors import ConfigError, InputError
from mocapd.types import Camera, LabelledPicture
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality

_MOST_VIEWS = 10**6  # of one lens

NOT_WRITTEN_YET = "-"  # pictures get their names when they are written


def save_draft(draft: Draft, state_dir: Path) -> Path:
    """Write the draft as the calibration of `state_dir`; the file's path.

    Raises InputError naming the step that was left out, CannotCreateError when it cannot be written.
    """
    saved, pictures = saved_of(draft)
    path = state_dir / FILE_NAME
    write_calibration(path, saved, pictures)
    return path


def saved_of(draft: Draft) -> tuple[SavedCalibration, dict[str, LabelledPicture]]:
    """The draft as the tables of the file, and its pictures by camera."""
    if draft.rig is None or draft.extrinsics_quality is None:
        raise InputError("the room is not calibrated", "room", "do that step first")
    by_id = {camera.id: camera for camera in draft.cameras}
    cameras = tuple(_camera(draft, by_id[one.name], one) for one in draft.rig.cameras)
    return SavedCalibration(
        schema=SCHEMA,
        made=Made(
            when=datetime.now(UTC).replace(microsecond=0),
            by=login_name(),
            mocapd=mocapd.__version__,
        ),
        room=RoomFit(
            method="wearer" if draft.extrinsics_quality.method == "wearer" else "board",
            rms_px=figure(draft.extrinsics_quality.rms_px),
            play_area_cm=figure(draft.extrinsics_quality.play_area_cm),
            floor_known=draft.floor_known,
        ),
        wearer=_wearer(draft),
        board=draft.board,
        camera=cameras,
    ), {name: one.picture for name, one in draft.colours.items()}


def load_draft(place: Path) -> Draft:
    """The saved calibration of a file or state directory as a draft. Raises InputError or ConfigError."""
    path = calibration_path(place)
    saved = read_calibration(path)
    known = from_saved(saved, path)
    assert known.rig is not None
    shirt = known.shirt or ShirtColours()
    room = saved.room
    for one in saved.camera:
        if one.lens is not None and one.lens.views > _MOST_VIEWS:
            raise ConfigError(
                f"a lens of {brief(one.lens.views)} pictures",
                f"{path}, camera {one.id!r}",
                "calibrate again (`mocapd calibrate`), or restore the file",
            )
    return Draft(
        cameras=tuple(
            DraftCamera(one.id, one.source, one.size_px, one.fps_hz, one.controls, one.label)
            for one in saved.camera
        ),
        board=saved.board,
        intrinsics={
            one.id: _lens(one.lens, camera)
            for one, camera in zip(saved.camera, known.rig.cameras, strict=True)
            if one.lens is not None
        },
        intrinsics_saved=frozenset(one.id for one in saved.camera if one.lens is not None),
        rig=known.rig,
        extrinsics_quality=ExtrinsicsQuality(
            room.method,
            math.nan if room.rms_px is None else room.rms_px,
            {one.id: math.nan if one.rms_px is None else one.rms_px for one in saved.camera},
            math.nan if room.play_area_cm is None else room.play_area_cm,
        ),
        floor_known=room.floor_known,
        colours={
            one.id: DraftColours(shirt.white_balance[one.id], np.array(one.colour.W))
            for one in saved.camera
            if one.colour is not None
        },
        personal=saved.wearer is not None and saved.wearer.personal_colours,
        stature_m=known.wearer.stature_m,
        factors=known.wearer.shape_factors,
        has_shirt=known.wearer.has_shirt,
    )


def calibration_of(draft: Draft) -> Calibration:
    """What the draft knows, as the saved calibration will. Raises InputError without a room."""
    if draft.rig is None:
        raise InputError("the room is not calibrated", "room", "do that step first")
    pictures = {name: one.picture for name, one in draft.colours.items()}
    W = {name: one.W for name, one in draft.colours.items()}
    return Calibration(
        draft.rig,
        Wearer(draft.stature_m, draft.factors, draft.has_shirt),
        ShirtColours(personal_model(pictures, W) if draft.personal else (), pictures),
    )


def _camera(draft: Draft, camera: DraftCamera, calibrated: Camera) -> SavedCamera:
    lens = draft.intrinsics.get(camera.id)
    colours = draft.colours.get(camera.id)
    rms_px = (
        draft.extrinsics_quality.camera_rms_px.get(camera.id, math.nan)
        if draft.extrinsics_quality
        else math.nan
    )
    return SavedCamera(
        id=camera.id,
        label=camera.label,
        source=camera.source,
        size_px=calibrated.size_px,
        fps_hz=camera.fps_hz,
        K=calibrated.K.tolist(),
        dist=calibrated.dist.tolist(),
        R=calibrated.R.tolist(),
        t_m=calibrated.t_m.tolist(),
        rms_px=figure(rms_px),
        lens=None if lens is None else _lens_fit(lens, camera.id in draft.intrinsics_saved),
        controls=camera.controls,
        colour=None
        if colours is None
        else ColourFit(picture=NOT_WRITTEN_YET, strokes=NOT_WRITTEN_YET, W=colours.W.tolist()),
    )


def _wearer(draft: Draft) -> SavedWearer | None:
    if draft.stature_m is None:
        return None
    proportions = None
    if draft.factors is not None:
        proportions = dict(zip(FACTORS, draft.factors.round(4).tolist(), strict=True))
    return SavedWearer(
        stature_m=draft.stature_m,
        proportions=proportions,
        personal_colours=draft.personal,
        has_shirt=draft.has_shirt,
    )


def _lens_fit(lens: Intrinsics, from_earlier: bool) -> LensFit:
    return LensFit(
        rms_px=figure(lens.rms_px),
        held_out_px=figure(lens.held_out_px),
        views=len(lens.views),
        focal_deviation=figure(lens.focal_deviation),
        free=tuple(lens.free.tolist()),
        from_earlier=from_earlier,
    )


def _lens(fit: LensFit, camera: Camera) -> Intrinsics:
    return Intrinsics(
        camera.size_px,
        camera.K,
        camera.dist,
        np.array(fit.free),
        math.nan if fit.rms_px is None else fit.rms_px,
        math.nan if fit.held_out_px is None else fit.held_out_px,
        tuple(range(fit.views)),
        (),
        math.nan if fit.focal_deviation is None else fit.focal_deviation,
    )


def figure(value: float) -> float | None:
    """Rounded for readers; None for NaN."""
    return None if not math.isfinite(value) else round(value, 4)


def login_name() -> str:
    """Of who runs this."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a service's user may have no name
        return f"uid {os.getuid()}"
