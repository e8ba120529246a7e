"""What a finished setup leaves behind, as the tables of `calibration.toml`."""

from datetime import datetime
from typing import Annotated, Literal

import msgspec

from mocapd.body.shape import FACTORS
from mocapd.calibration.board_spec import BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.geometry.rig_file import camera_from_dict
from mocapd.geometry.rig_plausibility import require_plausible
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


class _Table(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A table of the file. A key that is not known is of a newer mocapd, and ignored."""


class Made(_Table, frozen=True, kw_only=True):
    """When (UTC), by whom (login name), and with which mocapd."""

    when: datetime
    by: str
    mocapd: str


class RoomFit(_Table, frozen=True, kw_only=True):
    """How the room was found and how well it fits; a figure that the method cannot tell is absent."""

    method: Literal["board", "wearer"]
    rms_px: NotNegative | None = None
    play_area_cm: NotNegative | None = None
    floor_known: bool = True


class SavedWearer(_Table, frozen=True, kw_only=True):
    """stature_m [m]; proportions: factors on the mean body, by name; personal_colours: whether the
    colours of the wearer's own shirt, from the strokes, replace the standard; has_shirt: whether there is one at all, which
    files of earlier versions do not say."""

    stature_m: Annotated[float, msgspec.Meta(ge=0.8, le=2.5)]
    proportions: dict[Literal[FACTORS], Factor] | None = None  # type: ignore[valid-type]
    personal_colours: bool = False
    has_shirt: bool = True


class LensFit(_Table, frozen=True, kw_only=True):
    """How well the lens fits; free: which of k1 k2 p1 p2 k3 were solved for; from_earlier: whether it
    was taken over from an earlier setup."""

    rms_px: NotNegative | None = None
    held_out_px: NotNegative | None = None
    views: Annotated[int, msgspec.Meta(ge=0, le=100_000)]
    focal_deviation: NotNegative | None = None
    free: tuple[bool, bool, bool, bool, bool] = (True,) * 5
    from_earlier: bool = False


class ColourFit(_Table, frozen=True, kw_only=True):
    """Files beside this one: a picture of the wearer and the strokes on it (0 none, 1..10 the colour
    id); W: model_from_camera on RGB 0..1, solved from them."""

    picture: Text
    strokes: Text
    W: Matrix3


class SavedCamera(_Table, frozen=True, kw_only=True):
    """One camera. label: what the person calls it; source: what a configuration calls it, its password
    hidden; K, dist (k1 k2 p1 p2 k3) [px]; camera_from_world R, t_m [m]; rms_px: of its part of the room;
    controls: what it is locked to."""

    id: Text
    label: str = ""
    source: Text
    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(ge=0.1, le=1000.0)] = 30.0
    K: Matrix3
    dist: Row5
    R: Matrix3
    t_m: Row3
    rms_px: NotNegative | None = None
    lens: LensFit | None = None
    controls: Controls = msgspec.field(default_factory=Controls)
    colour: ColourFit | None = None


class SavedCalibration(_Table, frozen=True, kw_only=True):
    """The whole file. `board`: what it was made with; `wearer` is None where only cameras were calibrated."""

    schema: int
    made: Made
    room: RoomFit
    wearer: SavedWearer | None = None
    board: BoardSpec | None = None
    camera: Annotated[tuple[SavedCamera, ...], msgspec.Meta(min_length=1, max_length=100)]

    def rig(self, where: str) -> Rig:
        """The calibrated cameras. Raises ConfigError naming the camera and the field; `where`: the file."""
        rig = Rig(tuple(camera_from_dict(_entry(one), where) for one in self.camera))
        require_plausible(rig, where)
        return rig


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
