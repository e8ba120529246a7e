"""The calibration in progress: the results of the wizard's steps."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.types import Floats, LabelledPicture, Rig


@dataclass(frozen=True, slots=True)
class DraftCamera:
    """A camera of the setup.

    id: its name in the rig; source: its address in a configuration (`usb:...`, `/dev/video0`, a file, `sim:...`);
    controls: its locked controls, which the daemon sets at every opening; label: the user's name for it, empty for its
    id.
    """

    id: str
    source: str
    size_px: tuple[int, int]
    fps_hz: float = 30.0
    controls: Controls = field(default_factory=Controls)
    label: str = ""


@dataclass(frozen=True, slots=True)
class ExtrinsicsQuality:
    """Fit of the extrinsics: `method` is "board" or "wearer"; NaN for figures that a method does not give.

    rms_px: over all cameras; camera_rms_px: by camera; play_area_cm: median error in the play area.
    """

    method: str
    rms_px: float
    camera_rms_px: Mapping[str, float]
    play_area_cm: float


@dataclass(frozen=True, slots=True, eq=False)
class DraftColours:
    """One camera's frozen picture with the accepted strokes, and W (3,3), model_from_camera on RGB 0..1, solved from
    them."""

    picture: LabelledPicture
    W: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """All results so far; None or empty for unfinished steps.

    board_views: by camera id the pictures of the board for intrinsics and extrinsics, by the index of their sighting: views
    of one index are simultaneous. intrinsics, colours: by camera id; intrinsics_saved: ids with intrinsics of an earlier
    setup; floor_known: whether floor and up were measured, not guessed; personal: whether the wearer's own colours (from
    the strokes) replace the shirt's standard; factors: the wearer's proportions, the N_SHAPE factors of `body.shape`;
    has_shirt: whether the wearer has a shirt for the tracker.
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


def with_cameras(draft: Draft, cameras: tuple[DraftCamera, ...]) -> Draft:
    """The draft with these cameras, without the data of others: the lens of a camera with another size, colours of
    one that left or has other controls, the room of another set of cameras."""
    if cameras == draft.cameras:
        return draft
    before = {camera.id: camera for camera in draft.cameras}
    # without cameras before, the data come from the saved calibration of just these
    same_size = {
        camera.id for camera in cameras if before.get(camera.id, camera).size_px == camera.size_px
    }
    same_look = {
        camera.id
        for camera in cameras
        if camera.id in same_size and before.get(camera.id, camera).controls == camera.controls
    }
    lenses = {name: lens for name, lens in draft.intrinsics.items() if name in same_size}
    colours = {name: colours for name, colours in draft.colours.items() if name in same_look}
    draft = replace(
        draft,
        cameras=cameras,
        intrinsics=lenses,
        intrinsics_saved=draft.intrinsics_saved & lenses.keys(),
        colours=colours,
    )
    names = {camera.id for camera in cameras}
    if draft.rig is not None and (set(draft.rig.names) != names or len(same_size) < len(cameras)):
        draft = without_room(draft)
    return draft


def without_room(draft: Draft) -> Draft:
    """The draft without extrinsics, which need measuring again."""
    return replace(draft, rig=None, extrinsics_quality=None, floor_known=False)
