"""The page layout of a printed board, and the largest squares that fit."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.errors import ConfigError
from mocapd.printing.paper_sizes import RULER_HEIGHT_MM, Size, both_ways_mm

MIN_SQUARE_MM = 10.0  # a webcam a metre away cannot resolve the cells of a smaller marker
_MARKER_SHARE = 0.75  # of a square's side
# below, cells too small; above, no quiet zone round the marker
_LEAST_SHARE, _WIDEST_SHARE = 0.4, 0.9

EDGE_MM = 8.0  # what printers leave white
_GAP_MM = 3.0
_RULER_STRIP_MM = RULER_HEIGHT_MM + _GAP_MM
_COMMAND_STRIP_MM = 9.0
_CROSS_MM = 4.5  # from the board's edges
_CROSS_STRIP_MM = 7.0
_TITLED_RULER_MM = 176.0  # a ruler with the title beside it
_EPSILON_MM = 1e-6

Rect = tuple[float, float, float, float]  # x, y, width, height


@dataclass(frozen=True, slots=True)
class Layout:
    """Positions on the page [mm], origin at the lower left: the board, the starts of the horizontal ruler below it
    and of the upright one at its left; crosses: by letter, of a two-sided board."""

    page_mm: Size
    board: Rect
    ruler_mm: Size
    upright_ruler_mm: Size
    crosses: Mapping[str, Size]


def fitted_board(
    paper: str,
    columns: int,
    rows: int,
    dictionary: str,
    *,
    inverted: bool = False,
    two_sided: bool = False,
    square_m: float | None = None,
    marker_m: float | None = None,
) -> BoardSpec:
    """The board with the largest squares of whole millimetres that fit on the paper, or with the given square.
    Raises ConfigError when it does not fit, or its squares are too small for a webcam."""
    size = f"{columns}x{rows}"
    most_mm = max(_most_mm(page, columns, rows, two_sided) for page in both_ways_mm(paper))
    side_mm = np.floor(most_mm) if square_m is None else square_m * 1000
    if side_mm > most_mm + _EPSILON_MM:
        raise ConfigError(
            f"{size} squares of {side_mm:g} mm do not fit on {paper}",
            "--square",
            f"at most {np.floor(most_mm * 2) / 2000:g} (metres), or a larger paper",
        )
    if marker_m is None:
        marker_m = float(np.round(_MARKER_SHARE * side_mm, 0 if square_m is None else 1)) / 1000
    side_m = float(side_mm) / 1000
    if side_mm < MIN_SQUARE_MM:
        raise ConfigError(
            f"{size} squares on {paper} are of {side_mm:g} mm, which a webcam cannot read",
            "--board-size" if square_m is None else "--square",
            f"fewer squares or a larger paper, for {MIN_SQUARE_MM:g} mm or more",
        )
    board = BoardSpec(
        BoardKind.CHARUCO,
        columns,
        rows,
        side_m,
        marker_m,
        dictionary,
        inverted,
        two_sided=two_sided,
    )
    least_mm, widest_mm = _LEAST_SHARE * side_mm, _WIDEST_SHARE * side_mm
    if not least_mm <= marker_m * 1000 <= widest_mm:
        raise ConfigError(
            f"a marker of {marker_m * 1000:g} mm in a square of {side_mm:g} mm is hard to read",
            "--marker",
            f"give {least_mm / 1000:.3g} to {widest_mm / 1000:.3g} (metres)",
        )
    return board


def layout_of(board: BoardSpec, paper: str) -> Layout:
    """The page, portrait unless landscape gives the board more room; of a two-sided board the front page."""

    def most_mm(page_mm: Size) -> float:
        return _most_mm(page_mm, board.columns, board.rows, board.two_sided)

    page_mm = max(both_ways_mm(paper), key=most_mm)
    x, y, _, _ = _area(page_mm, board.two_sided)
    width, height = (board.columns * board.square_m * 1000, board.rows * board.square_m * 1000)
    return Layout(
        page_mm,
        (x, y, width, height),
        ruler_mm=(x, EDGE_MM + _COMMAND_STRIP_MM),
        upright_ruler_mm=(EDGE_MM + RULER_HEIGHT_MM, y),
        crosses=_crosses((x, y, width, height)) if board.two_sided else {},
    )


def layout_behind(front: Layout) -> Layout:
    """The back page: mirrored across the page, so that board and crosses lie behind their front counterparts on a sheet
    printed on both sides. The ruler begins below the board where the page has room for it."""
    width_mm = front.page_mm[0]
    x, y, width, height = front.board
    left = width_mm - x - width
    return replace(
        front,
        board=(left, y, width, height),
        ruler_mm=(min(left, width_mm - EDGE_MM - _TITLED_RULER_MM), front.ruler_mm[1]),
        crosses={letter: (width_mm - cx, cy) for letter, (cx, cy) in front.crosses.items()},
    )


def _crosses(board: Rect) -> dict[str, Size]:
    """Beside the rulers, also where these are longer than the board."""
    x, y, width, height = board
    right, above = x + width + _CROSS_MM, y + height + _CROSS_MM
    return {
        "A": (x + _CROSS_MM, above),
        "B": (right, above),
        "C": (right, y + _CROSS_MM),
        "D": (x - _CROSS_MM, y - _CROSS_MM),
    }


def _area(page_mm: Size, two_sided: bool) -> Rect:
    """The part of the page that the board may use."""
    left = EDGE_MM + _RULER_STRIP_MM
    bottom = left + _COMMAND_STRIP_MM
    edge = EDGE_MM + (_CROSS_STRIP_MM if two_sided else 0.0)
    return left, bottom, page_mm[0] - left - edge, page_mm[1] - bottom - edge


def _most_mm(page_mm: Size, columns: int, rows: int, two_sided: bool) -> float:
    """The side of the largest squares; BoardSpec refuses a board without any."""
    _, _, width, height = _area(page_mm, two_sided)
    return min(width / max(columns, 1), height / max(rows, 1))
