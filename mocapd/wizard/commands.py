"""Everything a person can say on the page: each verb with its arguments and their ranges.

The one way in: `read_command` makes a command of what came, or refuses it, so that what reaches a step
is already right. What only the step knows (which cameras there are, what is being done) it checks
itself. An argument with a default may be left out, or be null where None is the default; others that
a verb does not have are ignored.
"""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

import msgspec

from mocapd.boundary.messages import convert
from mocapd.boundary.numbers import brief
from mocapd.calibration.board_spec import (
    LARGEST_SQUARE_M,
    MOST_SQUARES,
    SMALLEST_SQUARE_M,
    BoardKind,
)
from mocapd.errors import InputError, MalformedError

LONGEST_NAME = 40
LONGEST_COUNTDOWN_S = 30.0
LARGEST_PNG = 8 << 20  # characters of base64

_SMALLEST_MM, _LARGEST_MM = 1000.0 * SMALLEST_SQUARE_M, 1000.0 * LARGEST_SQUARE_M
_SHORTEST_M, _TALLEST_M = 0.8, 2.3

Pixels = Annotated[int, msgspec.Meta(ge=16, le=100_000)]
Squares = Annotated[int, msgspec.Meta(ge=1, le=MOST_SQUARES)]


class Command(msgspec.Struct, frozen=True, kw_only=True):
    """refused, fix: what a person is told when the arguments are not right."""

    refused: ClassVar[str] = "the page said what is not understood"
    fix: ClassVar[str] = "reload the page"


Verbs = Mapping[str, type[Command]]


def read_command(verbs: Verbs, verb: str, args: Mapping[str, object], where: str) -> Command:
    """What was said. Raises InputError for another verb, and for arguments that it does not take."""
    kind = verbs.get(verb)
    if kind is None:
        raise InputError(f"no command {brief(verb)} in this step", where, "reload the page")
    try:
        command: Command = convert(args, kind)
    except MalformedError as error:
        what, _, at = str(error).partition(" - at ")
        named = at.strip("`").removeprefix("$").removeprefix(".") or verb
        why = f"{named}: {what[:1].lower()}{what[1:]}"
        raise InputError(f"{kind.refused} ({why})", where, kind.fix) from None
    return command


# -- of the setup as a whole ---------------------------------------------------------------------


class Go(Command, frozen=True):
    """Show this step."""

    refused = "there is no step of this name"
    step: str


class Next(Command, frozen=True):
    """Show the step after this one, which is done."""


class Again(Command, frozen=True):
    """Begin this step again."""


class Resume(Command, frozen=True):
    """Go on with the setup that was kept when a process ended."""


class BeginAnew(Command, frozen=True):
    """Forget the setup that was kept."""


OF_WIZARD: Verbs = {
    "go": Go,
    "next": Next,
    "again": Again,
    "resume": Resume,
    "begin_anew": BeginAnew,
}


# -- of the step Cameras -------------------------------------------------------------------------


class OfCamera(Command, frozen=True):
    """Of one camera, by its id."""

    camera: str


class LeaveOut(OfCamera, frozen=True):
    """It takes no part."""


class TakeIn(OfCamera, frozen=True):
    """It takes part after all."""


class Name(OfCamera, frozen=True):
    """What the person calls it; empty: its id."""

    refused = "this name does not do"
    fix = f"take up to {LONGEST_NAME} printable characters"
    name: Annotated[str, msgspec.Meta(max_length=LONGEST_NAME)] = ""


class ChangeMode(OfCamera, frozen=True):
    """Another size (width, height) and rate, of those that its node lists."""

    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]


class Lock(OfCamera, frozen=True):
    """Let it settle and lock it anew."""


class SamePort(OfCamera, frozen=True):
    """Whether the webcam that is in another port now is the one that was calibrated."""

    same: bool


CAMERAS: Verbs = {
    "leave_out": LeaveOut,
    "take_in": TakeIn,
    "name": Name,
    "mode": ChangeMode,
    "lock": Lock,
}
PORTS: Verbs = {"same_port": SamePort}


# -- of the step Lens ----------------------------------------------------------------------------

Millimetres = Annotated[float, msgspec.Meta(ge=_SMALLEST_MM, lt=_LARGEST_MM)]


class Board(Command, frozen=True):
    """What is printed on it; None: as before."""

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


class Ruler(Command, frozen=True):
    """How long the printed 100 mm are; farther off, something else was measured."""

    refused = "this cannot be the ruler"
    fix = "measure the line that should be 100 mm long, in millimetres"
    mm: Annotated[float, msgspec.Meta(ge=50.0, le=150.0)]


class UseSaved(Command, frozen=True):
    """The lens of before; None: all of them."""

    camera: str | None = None


class MeasureLens(OfCamera, frozen=True):
    """Not the saved lens but a new one."""


class Finish(Command, frozen=True):
    """With the lenses as good as they are."""


LENS: Verbs = {
    "board": Board,
    "ruler": Ruler,
    "use_saved": UseSaved,
    "measure": MeasureLens,
    "finish": Finish,
}


# -- of the step Room ----------------------------------------------------------------------------


class Method(Command, frozen=True):
    """How the room is found; wearer: true does the same as method: "wearer"."""

    refused = "there is no such method"
    fix = "take board or wearer"
    method: Literal["board", "wearer"] = "board"
    wearer: bool = False


class Floor(Command, frozen=True):
    """The board lies on the floor now."""


class SkipFloor(Command, frozen=True):
    """Go on with a guessed one."""


class Solve(Command, frozen=True):
    """With the observations there are."""


class StartWalk(Command, frozen=True):
    """The wearer walks about."""


class StopWalk(Command, frozen=True):
    """End early; nothing is changed."""


ROOM: Verbs = {"method": Method}
BOARD_ROOM: Verbs = {"floor": Floor, "skip_floor": SkipFloor, "solve": Solve}
WEARER_ROOM: Verbs = {"walk": StartWalk, "stop": StopWalk}


# -- of the step Colours -------------------------------------------------------------------------


class Freeze(Command, frozen=True):
    """Take the pictures after so many seconds; None: the usual 3."""

    refused = "cannot wait so long"
    fix = f"give 0 to {LONGEST_COUNTDOWN_S:g} seconds"
    seconds: Annotated[float, msgspec.Meta(ge=0.0, le=LONGEST_COUNTDOWN_S)] | None = None


class Propose(Command, frozen=True):
    """Propose strokes anew on the pictures that are there."""


class Strokes(OfCamera, frozen=True):
    """The camera's strokes now: colour ids as an 8-bit grey PNG of the picture's size. by: the page
    that drew them, so that it knows its own when it sees them again."""

    refused = "the strokes did not come as a picture"
    fix = "reload the page and draw again"
    png_base64: Annotated[str, msgspec.Meta(max_length=LARGEST_PNG)]
    by: Annotated[str, msgspec.Meta(pattern=r"^[\w.\-]{0,80}$")] = ""


class Personal(Command, frozen=True):
    """Whether the colours of the wearer's own shirt are used, not the standard's."""

    on: bool = False


COLOUR: Verbs = {
    "freeze": Freeze,
    "propose": Propose,
    "strokes": Strokes,
    "personal": Personal,
}


# -- of the step Body ----------------------------------------------------------------------------


class Stature(Command, frozen=True):
    """How tall the wearer is without shoes [m]."""

    refused = "this stature cannot be"
    fix = f"type it in metres, {_SHORTEST_M} to {_TALLEST_M}: 1.75 is 175 cm or 5 ft 9 in"
    m: Annotated[float, msgspec.Meta(ge=_SHORTEST_M, le=_TALLEST_M)]


class MeasureBody(Command, frozen=True):
    """Look at the wearer and work out the proportions; also again."""


class SkipBody(Command, frozen=True):
    """Go on with the proportions that people of this stature have."""


BODY: Verbs = {"stature": Stature, "measure": MeasureBody, "skip": SkipBody}


# -- of the step Check ---------------------------------------------------------------------------


class MeasureAgain(Command, frozen=True):
    """Judge another five seconds."""


class Save(Command, frozen=True):
    """Write the calibration."""


CHECK: Verbs = {"measure": MeasureAgain, "save": Save}
