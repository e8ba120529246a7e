"""What the wizard has found out so far: the calibration in the making."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.types import Floats, LabelledPicture, Rig


@dataclass(frozen=True, slots=True)
class DraftCamera:
    """A camera that takes part.

    id: its name in the rig; source: what a configuration calls it (`usb:...`, `/dev/video0`, a file,
    `sim:...`); controls: what it was locked to, to be set again whenever the daemon opens it; label:
    what the person calls it, empty for its id.
    """

    id: str
    source: str
    size_px: tuple[int, int]
    fps_hz: float = 30.0
    controls: Controls = field(default_factory=Controls)
    label: str = ""


@dataclass(frozen=True, slots=True)
class ExtrinsicsQuality:
    """How well the extrinsics fit: `method` is "board" or "wearer"; NaN where a method cannot tell.

    rms_px: over all cameras; camera_rms_px: by camera; play_area_cm: median error in the play area.
    """

    method: str
    rms_px: float
    camera_rms_px: Mapping[str, float]
    play_area_cm: float


@dataclass(frozen=True, slots=True, eq=False)
class DraftColours:
    """One camera's frozen picture with the strokes that were accepted, and W (3,3), model_from_camera on
    RGB 0..1, solved from them."""

    picture: LabelledPicture
    W: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """Everything found so far; None or empty where a step has not been done yet.

    board_views: by camera id the pictures of the board that intrinsics and extrinsics are solved from, by the index
    of their sighting: views of one index are of one instant. intrinsics, colours: by camera id; intrinsics_saved:
    ids whose intrinsics were taken over from an earlier setup; floor_known: whether floor and up were
    measured, not guessed; personal: whether the wearer's own colours (from the strokes) replace the
    shirt's standard; factors: the wearer's proportions, the N_SHAPE factors of `body.shape`; has_shirt: whether there
    is a shirt to be tracked by.
    """

    cameras: tuple[DraftCamera, ...] = ()
    board: BoardSpec | None = None
    board_views: Mapping[str, Mapping[int, BoardView]] = field(default_factory=dict)
    intrinsics: Mapping[str, Intrinsics] = field(default_factory=dict)
    intrinsics_saved: frozenset[str] = frozenset()
    rig: Rig | None = None
    extrinsics_quality: ExtrinsicsQuality | None = None
    floor_known: bool = False
    colours: Mapping[str, DraftColours] = field(default_factory=dict)
    personal: bool = False
    stature_m: float | None = None
    factors: Floats | None = None
    has_shirt: bool = True
