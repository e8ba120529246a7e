"""Converts the board to and from the page's form: lengths in millimetres, and the scale by a ruler."""

import math
from dataclasses import replace

import msgspec

from mocapd.calibration.board_spec import FEWEST_SQUARES, MOST_SQUARES, BoardSpec, dictionaries
from mocapd.printing.board_layout import fitted_board
from mocapd.printing.paper_sizes import RULER_MM
from mocapd.wizard.step import Json
from mocapd.wizard.step_commands import Board


def usual_board() -> BoardSpec:
    """The board that `mocapd board` prints by default."""
    return fitted_board("A4", 5, 7, "DICT_4X4_1000")


def board_of(said: Board, before: BoardSpec) -> BoardSpec:
    """The board of the form; None leaves a value unchanged. Raises ConfigError."""
    named = msgspec.structs.asdict(said)
    lengths_m = {
        name.replace("_mm", "_m"): mm / 1000.0
        for name in ("square_mm", "marker_mm")
        if (mm := named.pop(name)) is not None
    }
    given = {name: value for name, value in named.items() if value is not None}
    return replace(before, **given, **lengths_m)


def scaled_board(spec: BoardSpec, ruler_mm: float) -> BoardSpec:
    """The board at its true size, when its ruler's 100 mm measure `ruler_mm`. Raises ConfigError."""
    scale = ruler_mm / RULER_MM
    return replace(spec, square_m=spec.square_m * scale, marker_m=spec.marker_m * scale)


def same_print(a: BoardSpec, b: BoardSpec) -> bool:
    """Whether both have the same corners: all but the scale is equal."""
    return replace(a, square_m=0.1, marker_m=0.05) == replace(b, square_m=0.1, marker_m=0.05)


def is_rescaled(a: BoardSpec, b: BoardSpec) -> bool:
    """Whether both have the same corners at another scale, beyond the rounding of the form."""
    return same_print(a, b) and not math.isclose(a.square_m, b.square_m, rel_tol=1e-3)


def form_of(spec: BoardSpec) -> dict[str, Json]:
    return {
        "kind": spec.kind.value,
        "columns": spec.columns,
        "rows": spec.rows,
        "square_mm": round(1000.0 * spec.square_m, 2),
        "marker_mm": round(1000.0 * spec.marker_m, 2),
        "dictionary": spec.dictionary,
        "inverted": spec.inverted,
        "legacy": spec.legacy,
        "two_sided": spec.two_sided,
        "dictionaries": list(dictionaries()),
        "fewest": {kind.value: count for kind, count in FEWEST_SQUARES.items()},
        "most": MOST_SQUARES,
    }
