"""Converts the draft to the tables of a calibration, finished or in progress, and back."""

import getpass
import math
import os
from collections.abc import Collection
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from msgspec import structs

import mocapd
from mocapd.body.shape import FACTORS
from mocapd.calibrate.board.board_detection import FEWEST_CORNERS, BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardSpec
from mocapd.calibration.calibration_file import (
    FILE_NAME,
    RECALIBRATE,
    calibration_path,
    from_saved,
    read_calibration,
)
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.calibration.saved_calibration import (
    SCHEMA,
    ColourFit,
    LensFit,
    Made,
    RoomFit,
    SavedBoardView,
    SavedCalibration,
    SavedCamera,
    SavedSetup,
    SavedWearer,
)
from mocapd.errors import ConfigError, InputError
from mocapd.shirt.colour.model_pictures import personal_model
from mocapd.types import Camera, LabelledPicture
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality
from mocapd.wizard.step_names import StepName

NOT_WRITTEN_YET = "-"  # pictures get their names at writing


def save_draft(draft: Draft, state_dir: Path) -> Path:
    """Write the draft as the calibration of `state_dir`; returns the file's path.

    Raises InputError naming a missing step, CannotCreateError for a failed write.
    """
    saved, pictures = saved_of(draft)
    path = state_dir / FILE_NAME
    write_calibration(path, saved, pictures)
    return path


def saved_of(draft: Draft) -> tuple[SavedCalibration, dict[str, LabelledPicture]]:
    """The draft as the tables of the file, and its pictures by camera. Raises InputError without a room."""
    if draft.rig is None or draft.extrinsics_quality is None:
        raise InputError("the room is not calibrated", "room", "do that step first")
    by_id = {camera.id: camera for camera in draft.cameras}
    cameras = tuple(_camera(draft, by_id[name]) for name in draft.rig.names)
    return _tables(draft, cameras, datetime.now(UTC).replace(microsecond=0), None)


def setup_of(
    draft: Draft, when: datetime, done: Collection[StepName]
) -> tuple[SavedCalibration, dict[str, LabelledPicture]]:
    """The same of a setup in progress, with the board data that it still needs."""
    cameras = tuple(_with_measurements(draft, _camera(draft, camera)) for camera in draft.cameras)
    return _tables(draft, cameras, when, SavedSetup(done=tuple(sorted(done))))


def load_draft(place: Path) -> Draft:
    """The saved calibration of a file or state directory as a draft. Raises InputError or ConfigError."""
    path = calibration_path(place)
    draft = draft_of(read_calibration(path), path)
    return replace(draft, intrinsics_saved=frozenset(draft.intrinsics))


def draft_of(saved: SavedCalibration, path: Path) -> Draft:
    """The tables of a file as a draft. Raises InputError, or ConfigError for inconsistent data."""
    calibration = from_saved(saved, path)
    shirt = calibration.shirt or ShirtColours()
    room = saved.room
    cameras = calibration.rig.cameras if calibration.rig else (None,) * len(saved.camera)
    intrinsics = {
        one.id: _intrinsics(one, camera, path)
        for one, camera in zip(saved.camera, cameras, strict=True)
        if one.lens is not None
    }
    return Draft(
        cameras=tuple(
            DraftCamera(one.id, one.source, one.size_px, one.fps_hz, one.controls, one.label)
            for one in saved.camera
        ),
        board=saved.board,
        board_views={
            camera.id: {view.index: _view(view, saved.board, path) for view in camera.board_view}
            for camera in saved.camera
            if camera.board_view
        },
        intrinsics=intrinsics,
        intrinsics_saved=frozenset(
            one.id for one in saved.camera if one.lens is not None and one.lens.from_earlier
        ),
        rig=calibration.rig,
        extrinsics_quality=None
        if room is None
        else ExtrinsicsQuality(
            room.method,
            nan_of(room.rms_px),
            {camera.id: nan_of(camera.rms_px) for camera in saved.camera},
            nan_of(room.play_area_cm),
        ),
        floor_known=room is not None and room.floor_known,
        colours={
            camera.id: DraftColours(shirt.white_balance[camera.id], np.array(camera.colour.W))
            for camera in saved.camera
            if camera.colour is not None
        },
        personal=saved.wearer is not None and saved.wearer.personal_colours,
        stature_m=calibration.wearer.stature_m,
        factors=calibration.wearer.shape_factors,
        has_shirt=calibration.wearer.has_shirt,
    )


def calibration_of(draft: Draft) -> Calibration:
    """The draft as a calibration record, equal to the saved one. Raises InputError without a room."""
    if draft.rig is None:
        raise InputError("the room is not calibrated", "room", "do that step first")
    pictures = {name: colours.picture for name, colours in draft.colours.items()}
    W = {name: colours.W for name, colours in draft.colours.items()}
    return Calibration(
        draft.rig,
        Wearer(draft.stature_m, draft.factors, draft.has_shirt),
        ShirtColours(personal_model(pictures, W) if draft.personal else (), pictures),
    )


def _tables(
    draft: Draft, cameras: tuple[SavedCamera, ...], when: datetime, setup: SavedSetup | None
) -> tuple[SavedCalibration, dict[str, LabelledPicture]]:
    quality = draft.extrinsics_quality
    return SavedCalibration(
        schema=SCHEMA,
        made=Made(when=when, by=_login_name(), mocapd=mocapd.__version__),
        room=None
        if quality is None or draft.rig is None
        else RoomFit(
            method="wearer" if quality.method == "wearer" else "board",
            rms_px=figure(quality.rms_px),
            play_area_cm=figure(quality.play_area_cm),
            floor_known=draft.floor_known,
        ),
        wearer=_wearer(draft),
        board=draft.board,
        setup=setup,
        camera=cameras,
    ), {name: colours.picture for name, colours in draft.colours.items()}


def _camera(draft: Draft, camera: DraftCamera) -> SavedCamera:
    placed = (
        None if draft.rig is None else next(c for c in draft.rig.cameras if c.name == camera.id)
    )
    lens = draft.intrinsics.get(camera.id)
    colours = draft.colours.get(camera.id)
    quality = draft.extrinsics_quality
    return SavedCamera(
        id=camera.id,
        label=camera.label,
        source=camera.source,
        size_px=camera.size_px if placed is None else placed.size_px,
        fps_hz=camera.fps_hz,
        K=None if placed is None else placed.K.tolist(),
        dist=None if placed is None else placed.dist.tolist(),
        R=None if placed is None else placed.R.tolist(),
        t_m=None if placed is None else placed.t_m.tolist(),
        rms_px=None if quality is None else figure(quality.camera_rms_px.get(camera.id, math.nan)),
        lens=None if lens is None else _lens_fit(lens, camera.id in draft.intrinsics_saved),
        controls=camera.controls,
        colour=None
        if colours is None
        else ColourFit(picture=NOT_WRITTEN_YET, strokes=NOT_WRITTEN_YET, W=colours.W.tolist()),
    )


def _with_measurements(draft: Draft, camera: SavedCamera) -> SavedCamera:
    """Adds this camera's data for later steps: its separate intrinsics, and the board's corners."""
    lens, fit = draft.intrinsics.get(camera.id), camera.lens
    if lens is not None and fit is not None:
        fit = structs.replace(
            fit,
            K=lens.K.tolist(),
            dist=lens.dist.tolist(),
            used=lens.views,
            thrown_out=lens.thrown_out,
        )
    views = tuple(
        SavedBoardView(
            index=view.index,
            ids=tuple(view.ids.tolist()),
            corners_px=tuple(map(tuple, view.corners_px.round(3).tolist())),
            sharpness=view.sharpness,
            back=view.back,
        )
        for view in draft.board_views.get(camera.id, {}).values()
    )
    return structs.replace(camera, lens=fit, board_view=views)


def _wearer(draft: Draft) -> SavedWearer | None:
    if draft.stature_m is None and draft.has_shirt and not draft.personal:
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


def _intrinsics(saved: SavedCamera, placed: Camera | None, path: Path) -> Intrinsics:
    """Raises ConfigError."""
    fit = saved.lens
    assert fit is not None
    K = fit.K if placed is None or fit.K is not None else placed.K
    dist = fit.dist if placed is None or fit.dist is not None else placed.dist
    if K is None or dist is None:
        raise ConfigError("a lens without K and dist", f"{path}, camera {saved.id!r}", RECALIBRATE)
    return Intrinsics(
        saved.size_px,
        np.array(K),
        np.array(dist),
        np.array(fit.free),
        nan_of(fit.rms_px),
        nan_of(fit.held_out_px),
        fit.used or tuple(range(fit.views)),
        fit.thrown_out,
        nan_of(fit.focal_deviation),
    )


def _view(saved: SavedBoardView, board: BoardSpec | None, path: Path) -> BoardView:
    """Raises ConfigError."""
    columns, rows = (0, 0) if board is None else board.grid
    ids = np.array(saved.ids, np.int64)
    if (
        len(ids) != len(saved.corners_px)
        or len(ids) < FEWEST_CORNERS
        or ids[-1] >= columns * rows
        or (np.diff(ids) <= 0).any()
    ):
        raise ConfigError("has a picture of another board", str(path), RECALIBRATE)
    return BoardView(saved.index, ids, np.array(saved.corners_px), saved.sharpness, saved.back)


def figure(value: float) -> float | None:
    """Rounded for readability; None for NaN."""
    return None if not math.isfinite(value) else round(value, 4)


def nan_of(figure: float | None) -> float:
    """NaN for a missing figure."""
    return math.nan if figure is None else figure


def _login_name() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a service's user may have no name
        return f"uid {os.getuid()}"
