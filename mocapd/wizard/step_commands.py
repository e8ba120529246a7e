"""Commands of the steps, with their arguments and ranges."""

from typing import Annotated, Literal

import msgspec

from mocapd.calibration.board_spec import (
    LARGEST_SQUARE_M,
    MOST_SQUARES,
    SMALLEST_SQUARE_M,
    BoardKind,
)
from mocapd.wizard.commands import Command, OfCamera, Verbs

# -- Cameras ---------------------------------------------------------------------------------------

LONGEST_NAME = 40
Pixels = Annotated[int, msgspec.Meta(ge=16, le=100_000)]


class LeaveOut(OfCamera, frozen=True):
    """Exclude a camera."""


class TakeIn(OfCamera, frozen=True):
    """Include a camera again."""


class Name(OfCamera, frozen=True):
    """The user's name for it; empty: its id."""

    refused = "this name does not do"
    fix = f"take up to {LONGEST_NAME} printable characters"
    name: Annotated[str, msgspec.Meta(max_length=LONGEST_NAME)] = ""


class ChangeMode(OfCamera, frozen=True):
    """Another size (width, height) and rate, of those that its node lists."""

    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]


class Lock(OfCamera, frozen=True):
    """Let it settle and lock it again."""


class SamePort(OfCamera, frozen=True):
    """Whether the webcam in another port now is the calibrated one."""

    same: bool


CAMERAS: Verbs = {
    "leave_out": LeaveOut,
    "take_in": TakeIn,
    "name": Name,
    "mode": ChangeMode,
    "lock": Lock,
}
PORTS: Verbs = {"same_port": SamePort}

# -- Lens ------------------------------------------------------------------------------------------

_SMALLEST_MM, _LARGEST_MM = 1000.0 * SMALLEST_SQUARE_M, 1000.0 * LARGEST_SQUARE_M
Squares = Annotated[int, msgspec.Meta(ge=1, le=MOST_SQUARES)]

Millimetres = Annotated[float, msgspec.Meta(ge=_SMALLEST_MM, lt=_LARGEST_MM)]


class Board(Command, frozen=True):
    """The printed pattern; None leaves a value unchanged."""

    refused = "this board cannot be"
    fix = (
        f"give up to {MOST_SQUARES} squares each way, of {_SMALLEST_MM:g} to {_LARGEST_MM:g} mm, as "
        "they were printed"
    )
    kind: BoardKind | None = None
    columns: Squares | None = None
    rows: Squares | None = None
    square_mm: Millimetres | None = None
    marker_mm: Annotated[float, msgspec.Meta(ge=0.0, lt=_LARGEST_MM)] | None = None
    dictionary: Annotated[str, msgspec.Meta(max_length=40)] | None = None
    inverted: bool | None = None
    legacy: bool | None = None
    two_sided: bool | None = None


class Ruler(Command, frozen=True):
    """Measured length of the printed 100 mm; the range excludes other rulers."""

    refused = "this cannot be the ruler"
    fix = "measure the line that should be 100 mm long, in millimetres"
    mm: Annotated[float, msgspec.Meta(ge=50.0, le=150.0)]


class UseSaved(Command, frozen=True):
    """Use an earlier lens; None: all of them."""

    camera: str | None = None


class MeasureLens(OfCamera, frozen=True):
    """Measure a new lens instead of the saved one."""


class Finish(Command, frozen=True):
    """Accept the present lenses."""


LENS: Verbs = {
    "board": Board,
    "ruler": Ruler,
    "use_saved": UseSaved,
    "measure": MeasureLens,
    "finish": Finish,
}

# -- Room ------------------------------------------------------------------------------------------


class Method(Command, frozen=True):
    refused = "there is no such method"
    fix = "take board or wearer"
    method: Literal["board", "wearer"] = "board"


class Floor(Command, frozen=True):
    """The board lies on the floor now."""


class SkipFloor(Command, frozen=True):
    """Go on with a guess of the floor."""


class Solve(Command, frozen=True):
    """Solve with the present observations."""


class StartWalk(Command, frozen=True):
    """The wearer walks about."""


class StopWalk(Command, frozen=True):
    """End early; nothing is changed."""


ROOM: Verbs = {"method": Method}
BOARD_ROOM: Verbs = {"floor": Floor, "skip_floor": SkipFloor, "solve": Solve}
WEARER_ROOM: Verbs = {"walk": StartWalk, "stop": StopWalk}

# -- Colour ----------------------------------------------------------------------------------------

LONGEST_COUNTDOWN_S = 30.0
LARGEST_PNG = 8 << 20  # characters of base64


class Freeze(Command, frozen=True):
    """Take the pictures after so many seconds; None: the usual 3."""

    refused = "cannot wait so long"
    fix = f"give 0 to {LONGEST_COUNTDOWN_S:g} seconds"
    seconds: Annotated[float, msgspec.Meta(ge=0.0, le=LONGEST_COUNTDOWN_S)] | None = None


class Propose(Command, frozen=True):
    """Propose strokes again on the present pictures."""


class Strokes(OfCamera, frozen=True):
    """The camera's present strokes: colour ids as an 8-bit grey PNG of the picture's size. by: the page that drew them,
    so that it recognises its own strokes."""

    refused = "the strokes did not come as a picture"
    fix = "reload the page and draw again"
    png_base64: Annotated[str, msgspec.Meta(max_length=LARGEST_PNG)]
    by: Annotated[str, msgspec.Meta(pattern=r"^[\w.\-]{0,80}$")] = ""


class Personal(Command, frozen=True):
    """Whether to use the colours of the wearer's own shirt instead of the standard's."""

    on: bool = False


COLOUR: Verbs = {
    "freeze": Freeze,
    "propose": Propose,
    "strokes": Strokes,
    "personal": Personal,
}

# -- Body ------------------------------------------------------------------------------------------

_SHORTEST_M, _TALLEST_M = 0.8, 2.3


class Stature(Command, frozen=True):
    """How tall the wearer is without shoes [m]."""

    refused = "this stature cannot be"
    fix = f"type it in metres, {_SHORTEST_M} to {_TALLEST_M}: 1.75 is 175 cm or 5 ft 9 in"
    m: Annotated[float, msgspec.Meta(ge=_SHORTEST_M, le=_TALLEST_M)]


class MeasureBody(Command, frozen=True):
    """Measure the wearer's proportions, perhaps again."""


class SkipBody(Command, frozen=True):
    """Go on with the mean proportions of this stature."""


BODY: Verbs = {"stature": Stature, "measure": MeasureBody, "skip": SkipBody}

# -- Check -----------------------------------------------------------------------------------------


class MeasureAgain(Command, frozen=True):
    """Judge another five seconds."""


class Save(Command, frozen=True):
    """Write the calibration."""


CHECK: Verbs = {"measure": MeasureAgain, "save": Save}
