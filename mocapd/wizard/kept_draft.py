"""A draft as it is kept in a file: its parts as tables of plain values, and both ways between them."""

import math
from collections.abc import Mapping
from typing import Annotated, Literal

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import msgspec
import numpy as np

from mocapd.body.shape import N_FACTORS
from mocapd.body.shirt_patches import N_COLOURS
from mocapd.boundary.pictures import MOST_DRAWN_PIXELS, decode_picture
from mocapd.boundary.urls import without_password
from mocapd.calibrate.board.board_detection import FEWEST_CORNERS, BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.errors import MalformedError
from mocapd.geometry.rig_file import camera_from_dict, camera_to_dict
from mocapd.types import Bytes, LabelledPicture, Rig
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality

_PNG = (cv2.IMWRITE_PNG_COMPRESSION, 1)  # lossless at any level; this one is quick

Finite = Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]  # NaN is in no range
NotNegative = Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
Pixels = Annotated[int, msgspec.Meta(ge=16, le=100_000)]
Index = Annotated[int, msgspec.Meta(ge=-1, le=1 << 40)]
Text = Annotated[str, msgspec.Meta(max_length=10_000)]
Row3 = tuple[Finite, Finite, Finite]
Matrix3 = tuple[Row3, Row3, Row3]
Row5 = tuple[Finite, Finite, Finite, Finite, Finite]


class Table(msgspec.Struct, frozen=True, kw_only=True):
    """A part of the file. Figures that are not known (NaN) are None."""


class _Camera(Table, frozen=True):
    id: Text
    source: Text  # without its password
    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]
    controls: Controls
    label: Text


class _View(Table, frozen=True):
    index: Index
    ids: tuple[Annotated[int, msgspec.Meta(ge=0, le=10_000)], ...]
    corners_px: tuple[tuple[Finite, Finite], ...]
    sharpness: Finite
    back: bool = False


class _Intrinsics(Table, frozen=True):
    size_px: tuple[Pixels, Pixels]
    K: Matrix3
    dist: Row5
    free: tuple[bool, bool, bool, bool, bool]
    rms_px: NotNegative | None
    held_out_px: NotNegative | None
    views: tuple[Index, ...]
    thrown_out: tuple[Index, ...]
    focal_deviation: NotNegative | None


class _Place(Table, frozen=True):
    name: Text
    size: tuple[Pixels, Pixels]
    K: Matrix3
    dist: Row5
    R: Matrix3
    t: Row3


class _Quality(Table, frozen=True):
    method: Literal["board", "wearer"]
    rms_px: NotNegative | None
    camera_rms_px: dict[Text, NotNegative | None]
    play_area_cm: NotNegative | None


class _Colours(Table, frozen=True):
    picture: bytes
    strokes: bytes
    W: Matrix3


class KeptDraft(Table, frozen=True):
    """All of a draft."""

    cameras: Annotated[tuple[_Camera, ...], msgspec.Meta(min_length=1, max_length=64)]
    board: BoardSpec | None
    board_views: dict[Text, tuple[_View, ...]]
    intrinsics: dict[Text, _Intrinsics] = msgspec.field(name="lenses")
    intrinsics_saved: frozenset[Text] = msgspec.field(name="lens_saved")
    rig: tuple[_Place, ...] | None
    extrinsics_quality: _Quality | None = msgspec.field(name="room")
    floor_known: bool
    colours: dict[Text, _Colours]
    personal: bool
    stature_m: Annotated[float, msgspec.Meta(ge=0.8, le=2.5)] | None
    factors: tuple[Annotated[float, msgspec.Meta(gt=0.3, lt=3.0)], ...] | None
    has_shirt: bool = True  # files of before do not say


def kept_draft(draft: Draft) -> KeptDraft:
    """What the file is to hold."""
    return KeptDraft(
        cameras=tuple(
            _Camera(
                id=one.id,
                source=without_password(one.source),
                size_px=one.size_px,
                fps_hz=one.fps_hz,
                controls=one.controls,
                label=one.label,
            )
            for one in draft.cameras
        ),
        board=draft.board,
        board_views={
            name: tuple(
                _View(
                    index=view.index,
                    ids=view.ids.tolist(),
                    corners_px=view.corners_px.tolist(),
                    sharpness=view.sharpness,
                    back=view.back,
                )
                for view in own.values()
            )
            for name, own in draft.board_views.items()
        },
        intrinsics={
            name: _kept_intrinsics(intrinsics) for name, intrinsics in draft.intrinsics.items()
        },
        intrinsics_saved=draft.intrinsics_saved,
        rig=None
        if draft.rig is None
        else tuple(_Place(**camera_to_dict(one)) for one in draft.rig.cameras),
        extrinsics_quality=None
        if draft.extrinsics_quality is None
        else _kept_quality(draft.extrinsics_quality),
        floor_known=draft.floor_known,
        colours={
            name: _Colours(
                picture=_png(one.picture.pixels),
                strokes=_png(one.picture.labels),
                W=one.W.tolist(),
            )
            for name, one in draft.colours.items()
        },
        personal=draft.personal,
        has_shirt=draft.has_shirt,
        stature_m=draft.stature_m,
        factors=None if draft.factors is None else tuple(draft.factors.tolist()),
    )


def _kept_intrinsics(intrinsics: Intrinsics) -> _Intrinsics:
    return _Intrinsics(
        size_px=intrinsics.size_px,
        K=intrinsics.K.tolist(),
        dist=intrinsics.dist.tolist(),
        free=intrinsics.free.tolist(),
        rms_px=_figure(intrinsics.rms_px),
        held_out_px=_figure(intrinsics.held_out_px),
        views=intrinsics.views,
        thrown_out=intrinsics.thrown_out,
        focal_deviation=_figure(intrinsics.focal_deviation),
    )


def _kept_quality(quality: ExtrinsicsQuality) -> _Quality:
    return _Quality(
        method="wearer" if quality.method == "wearer" else "board",
        rms_px=_figure(quality.rms_px),
        camera_rms_px={name: _figure(px) for name, px in quality.camera_rms_px.items()},
        play_area_cm=_figure(quality.play_area_cm),
    )


def _figure(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _png(pixels: Bytes) -> bytes:
    done, data = cv2.imencode(".png", pixels, _PNG)
    assert done, "cv2 cannot write PNG"
    return data.tobytes()


def check_kept(draft: KeptDraft) -> None:
    """What belongs to each other. Raises MalformedError."""
    sizes = {one.id: one.size_px for one in draft.cameras}
    named = (draft.intrinsics, draft.colours)
    placed = None if draft.rig is None else {one.name: one.size for one in draft.rig}
    if (
        len(sizes) < len(draft.cameras)
        or any(not sizes.keys() >= of_camera.keys() for of_camera in named)
        or any(intrinsics.size_px != sizes[name] for name, intrinsics in draft.intrinsics.items())
        or placed not in (None, sizes)
    ):
        raise MalformedError("its cameras do not belong together")
    if draft.factors is not None and len(draft.factors) != N_FACTORS:
        raise MalformedError(f"has {len(draft.factors)} proportions, wanted {N_FACTORS}")
    columns, rows = (0, 0) if draft.board is None else draft.board.grid
    for view in (view for own in draft.board_views.values() for view in own):
        if (
            len(view.ids) != len(view.corners_px)
            or len(view.ids) < FEWEST_CORNERS
            or any(a >= b for a, b in zip(view.ids, (*view.ids[1:], columns * rows), strict=True))
        ):
            raise MalformedError("has a picture of another board")


def draft_of(kept: KeptDraft, where: str) -> Draft:
    """Raises ConfigError or MalformedError."""
    return Draft(
        cameras=tuple(
            DraftCamera(one.id, one.source, one.size_px, one.fps_hz, one.controls, one.label)
            for one in kept.cameras
        ),
        board=kept.board,
        board_views={
            name: {view.index: _view(view) for view in own}
            for name, own in kept.board_views.items()
        },
        intrinsics={
            name: _read_intrinsics(intrinsics) for name, intrinsics in kept.intrinsics.items()
        },
        intrinsics_saved=kept.intrinsics_saved,
        rig=None
        if kept.rig is None
        else Rig(tuple(camera_from_dict(msgspec.structs.asdict(one), where) for one in kept.rig)),
        extrinsics_quality=None
        if kept.extrinsics_quality is None
        else _read_quality(kept.extrinsics_quality),
        floor_known=kept.floor_known,
        colours=_colours(kept.colours),
        personal=kept.personal,
        stature_m=kept.stature_m,
        factors=None if kept.factors is None else np.array(kept.factors),
        has_shirt=kept.has_shirt,
    )


def _view(told: _View) -> BoardView:
    ids = np.array(told.ids, np.int64)
    return BoardView(told.index, ids, np.array(told.corners_px), told.sharpness, told.back)


def _read_intrinsics(told: _Intrinsics) -> Intrinsics:
    return Intrinsics(
        told.size_px,
        np.array(told.K),
        np.array(told.dist),
        np.array(told.free),
        _nan(told.rms_px),
        _nan(told.held_out_px),
        told.views,
        told.thrown_out,
        _nan(told.focal_deviation),
    )


def _read_quality(told: _Quality) -> ExtrinsicsQuality:
    by_camera = {name: _nan(px) for name, px in told.camera_rms_px.items()}
    return ExtrinsicsQuality(told.method, _nan(told.rms_px), by_camera, _nan(told.play_area_cm))


def _colours(told: Mapping[str, _Colours]) -> dict[str, DraftColours]:
    """Raises MalformedError."""
    found = {}
    for name, one in told.items():
        pixels = decode_picture(one.picture, cv2.IMREAD_COLOR, most_pixels=MOST_DRAWN_PIXELS)
        height, width = pixels.shape[:2]
        strokes = decode_picture(one.strokes, cv2.IMREAD_GRAYSCALE, (width, height))
        if strokes.max() > N_COLOURS:
            raise MalformedError(f"has strokes of a colour {strokes.max()}")
        found[name] = DraftColours(LabelledPicture(pixels, strokes), np.array(one.W))
    return found


def _nan(figure: float | None) -> float:
    return math.nan if figure is None else figure
