"""The tables of `calibration.toml`, of a finished setup or one in progress."""

from datetime import datetime
from typing import Annotated, Literal

import msgspec
import numpy as np

from mocapd.body.shape import FACTORS
from mocapd.calibration.board_spec import BoardSpec
from mocapd.calibration.calibration_record import Wearer
from mocapd.capture.webcam.controls import Controls
from mocapd.geometry.rig_file import camera_from_dict, require_plausible
from mocapd.types import Rig

SCHEMA = 1

Pixels = Annotated[int, msgspec.Meta(ge=16, le=16_384)]
NotNegative = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
Number = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
Text = Annotated[str, msgspec.Meta(min_length=1, max_length=4096)]
Factor = Annotated[float, msgspec.Meta(gt=0.3, lt=3.0)]
Row3 = tuple[Number, Number, Number]
Matrix3 = tuple[Row3, Row3, Row3]
Row5 = tuple[Number, Number, Number, Number, Number]
Index = Annotated[int, msgspec.Meta(ge=-1, le=1 << 40)]
_MOST_CORNERS = msgspec.Meta(max_length=10_000)


class _Table(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A table of the file. Unknown keys come from a newer mocapd, and are ignored."""


class Made(_Table, frozen=True, kw_only=True):
    """Time (UTC), login name, and version of mocapd."""

    when: datetime
    by: str
    mocapd: str


class RoomFit(_Table, frozen=True, kw_only=True):
    """The method of the extrinsics, and their fit. A figure that the method cannot give is absent."""

    method: Literal["board", "wearer"]
    rms_px: NotNegative | None = None
    play_area_cm: NotNegative | None = None
    floor_known: bool = True


class SavedWearer(_Table, frozen=True, kw_only=True):
    """stature_m [m]; proportions: factors on the mean body, by name; personal_colours: whether the colours of
    the wearer's own shirt, from the strokes, replace the standard; has_shirt: whether the wearer has a shirt. Files of
    earlier versions lack `has_shirt`."""

    stature_m: Annotated[float, msgspec.Meta(ge=0.8, le=2.5)] | None = None
    proportions: dict[Literal[FACTORS], Factor] | None = None  # type: ignore[valid-type]
    personal_colours: bool = False
    has_shirt: bool = True


class LensFit(_Table, frozen=True, kw_only=True):
    """How well the lens fits; free: which of k1 k2 p1 p2 k3 were solved for; from_earlier: whether an earlier
    setup gave it. A setup in progress adds K and dist of this camera alone, and the indices of the pictures that the
    solver used and rejected."""

    rms_px: NotNegative | None = None
    held_out_px: NotNegative | None = None
    views: Annotated[int, msgspec.Meta(ge=0, le=100_000)]
    focal_deviation: NotNegative | None = None
    free: tuple[bool, bool, bool, bool, bool] = (True,) * 5
    from_earlier: bool = False
    K: Matrix3 | None = None
    dist: Row5 | None = None
    used: tuple[Index, ...] = ()
    thrown_out: tuple[Index, ...] = ()


class ColourFit(_Table, frozen=True, kw_only=True):
    """Files in the same folder: a picture of the wearer and the strokes on it (0 none, 1..10 the colour id); W:
    model_from_camera on RGB 0..1, solved from them."""

    picture: Text
    strokes: Text
    W: Matrix3


class SavedBoardView(_Table, frozen=True, kw_only=True):
    """The board in one picture of a setup in progress, see BoardView: pictures of one index are of one instant."""

    index: Index
    ids: Annotated[tuple[Annotated[int, msgspec.Meta(ge=0, le=10_000)], ...], _MOST_CORNERS]
    corners_px: Annotated[tuple[tuple[Number, Number], ...], _MOST_CORNERS]
    sharpness: Number
    back: bool = False


class SavedCamera(_Table, frozen=True, kw_only=True):
    """One camera. label: the user's name for it; source: its address in a configuration, password masked; K, dist
    (k1 k2 p1 p2 k3) [px]; camera_from_world R, t_m [m], absent before the extrinsics are solved; rms_px: reprojection
    error of the extrinsics; controls: locked webcam controls; board_view: only of a setup in progress."""

    id: Text
    label: str = ""
    source: Text
    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(ge=0.1, le=1000.0)] = 30.0
    K: Matrix3 | None = None
    dist: Row5 | None = None
    R: Matrix3 | None = None
    t_m: Row3 | None = None
    rms_px: NotNegative | None = None
    lens: LensFit | None = None
    controls: Controls = msgspec.field(default_factory=Controls)
    colour: ColourFit | None = None
    board_view: Annotated[tuple[SavedBoardView, ...], msgspec.Meta(max_length=2000)] = ()


class SavedSetup(_Table, frozen=True, kw_only=True):
    """Of a setup in progress; done: the steps whose result is in the file."""

    done: tuple[Text, ...] = ()


class SavedCalibration(_Table, frozen=True, kw_only=True):
    """The whole file. `board`: the calibration board; `wearer`: None where only cameras were calibrated; `setup`: only of
    a setup in progress, which may lack the room and the cameras' extrinsics."""

    schema: int
    made: Made
    room: RoomFit | None = None
    wearer: SavedWearer | None = None
    board: BoardSpec | None = None
    setup: SavedSetup | None = None
    camera: Annotated[tuple[SavedCamera, ...], msgspec.Meta(min_length=1, max_length=100)]

    @property
    def is_placed(self) -> bool:
        """Whether the file contains the extrinsics of all cameras."""
        return self.room is not None and all(
            None not in (camera.K, camera.dist, camera.R, camera.t_m) for camera in self.camera
        )

    def rig(self, where: str) -> Rig:
        """The rig; needs `is_placed`. Raises ConfigError naming camera and field; `where`: the file."""
        rig = Rig(tuple(camera_from_dict(_entry(camera), where) for camera in self.camera))
        require_plausible(rig, where)
        return rig

    def wearer_record(self) -> Wearer:
        """The wearer's record; proportions that the file lacks are those of the mean body."""
        saved = self.wearer
        if saved is None:
            return Wearer()
        if saved.proportions is None:
            return Wearer(saved.stature_m, has_shirt=saved.has_shirt)
        factors = np.array([saved.proportions.get(name, 1.0) for name in FACTORS])
        return Wearer(saved.stature_m, factors, saved.has_shirt)


def _entry(camera: SavedCamera) -> dict[str, object]:
    """The camera as a rig file has it."""
    return {
        "name": camera.id,
        "size": camera.size_px,
        "K": camera.K,
        "dist": camera.dist,
        "R": camera.R,
        "t": camera.t_m,
    }
