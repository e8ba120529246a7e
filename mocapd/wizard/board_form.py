"""The board as the page's form has it: lengths in millimetres, and the scale that a ruler shows."""

from collections.abc import Mapping
from dataclasses import replace

from mocapd.calibrate.board import BoardKind, BoardSpec, dictionaries
from mocapd.calibrate.board_pdf import fitted_board
from mocapd.errors import ConfigError, InputError
from mocapd.wizard.step import Json

RULER_MM = 100.0
_WHERE = "the board"
_RULER_RANGE_MM = (50.0, 150.0)  # beyond, something else was measured


def usual_board() -> BoardSpec:
    """What `mocapd board` prints when nothing is asked for."""
    return fitted_board("A4", 5, 7, "DICT_4X4_1000")


def board_of(args: Mapping[str, Json], before: BoardSpec) -> BoardSpec:
    """The board of the form; what is absent stays as before. Raises InputError."""
    kind = str(args.get("kind", before.kind))
    if kind not in tuple(BoardKind):
        raise InputError(f"no kind of board {kind!r}", _WHERE, "charuco or chessboard")
    try:
        return BoardSpec(
            BoardKind(kind),
            _count(args, "columns", before.columns),
            _count(args, "rows", before.rows),
            _length_m(args, "square_mm", before.square_m),
            _length_m(args, "marker_mm", before.marker_m),
            str(args.get("dictionary", before.dictionary)),
            bool(args.get("inverted", before.inverted)),
            bool(args.get("legacy", before.legacy)),
        )
    except ConfigError as error:
        raise InputError(error.what, error.where, error.fix) from None


def scaled_board(spec: BoardSpec, ruler_mm: Json) -> BoardSpec:
    """The board as it was really printed, when its ruler's 100 mm measure `ruler_mm`."""
    low_mm, high_mm = _RULER_RANGE_MM
    if not isinstance(ruler_mm, int | float) or not low_mm <= ruler_mm <= high_mm:
        raise InputError(
            f"a ruler of {ruler_mm!r} mm",
            _WHERE,
            f"measure the line that should be {RULER_MM:g} mm long, in millimetres",
        )
    scale = float(ruler_mm) / RULER_MM
    try:
        return replace(spec, square_m=spec.square_m * scale, marker_m=spec.marker_m * scale)
    except ConfigError as error:
        raise InputError(error.what, error.where, error.fix) from None


def same_print(a: BoardSpec, b: BoardSpec) -> bool:
    """Whether the corners found of one are those of the other: all but the scale is the same."""
    return replace(a, square_m=0.1, marker_m=0.05) == replace(b, square_m=0.1, marker_m=0.05)


def form_of(spec: BoardSpec) -> dict[str, Json]:
    """The form's fields."""
    return {
        "kind": spec.kind.value,
        "columns": spec.columns,
        "rows": spec.rows,
        "square_mm": round(1000.0 * spec.square_m, 2),
        "marker_mm": round(1000.0 * spec.marker_m, 2),
        "dictionary": spec.dictionary,
        "inverted": spec.inverted,
        "legacy": spec.legacy,
        "dictionaries": list(dictionaries()),
    }


def _count(args: Mapping[str, Json], key: str, before: int) -> int:
    value = args.get(key, before)
    if not isinstance(value, int | float) or value != int(value):
        raise InputError(f"{value!r} {key} of squares", _WHERE, "give a whole number")
    return int(value)


def _length_m(args: Mapping[str, Json], key: str, before_m: float) -> float:
    value = args.get(key)
    if value is None:
        return before_m
    if not isinstance(value, int | float):
        raise InputError(f"{key} of {value!r}", _WHERE, "give a length in millimetres")
    return float(value) / 1000.0
