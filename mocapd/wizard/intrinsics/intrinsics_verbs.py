"""Commands of the step Lens, with their arguments and ranges."""

from typing import Annotated

import msgspec

from mocapd.calibration.board_spec import (
    LARGEST_SQUARE_M,
    MOST_SQUARES,
    SMALLEST_SQUARE_M,
    BoardKind,
)
from mocapd.wizard.commands import Command, OfCamera, Verbs

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
