"""The calibration board as a PDF: a ChArUco board at true size, its parameters and its rulers; of a
two-sided one a second page with the mirror image, and crosses to glue them back to back by."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.pdfgen.canvas import FILL_EVEN_ODD, Canvas

from mocapd.calibration.board_spec import BoardKind, BoardSpec, aruco_board
from mocapd.errors import ConfigError
from mocapd.printing.paper_sizes import (
    BLACK,
    BOLD,
    DARK,
    RULER_HEIGHT_MM,
    RULER_MM,
    About,
    Document,
    Size,
    draw_ruler,
    paper_size_mm,
    write_text,
)

MIN_SQUARE_MM = 10.0  # the cells of a smaller one's marker are lost to a webcam a metre away
_MARKER_SHARE = 0.75  # of a square's side
_LEAST_SHARE, _WIDEST_SHARE = (
    0.4,
    0.9,
)  # below, cells too small; above, no quiet zone round the marker

_EDGE_MM = 8.0  # what printers leave white
_GAP_MM = 3.0
_RULER_STRIP_MM = RULER_HEIGHT_MM + _GAP_MM
_COMMAND_STRIP_MM = 9.0
_CROSS_MM, _ARM_MM = 4.5, 3.5  # from the board's edges; on each side of the middle
_CROSS_STRIP_MM = 2.0 * _CROSS_MM - 2.0
_EPSILON_MM = 1e-6
_COURIER_ADVANCE = 0.6  # of each letter, in ems
_MEASURE = (
    "Measure me: this must be 100 mm, both ways. If not, it was printed with scaling:"
    " print again at 100 %, or type the measured value."
)
_GLUE = (
    "This ruler must measure the same as that of FRONT. Glue FRONT flat onto something stiff and push a"
    " pin straight through each cross.",
    "Then lay BACK on the other side, each cross on the pin of its own letter, and glue it. The calibration"
    " says by how many millimetres the sides are off.",
)

Rect = tuple[float, float, float, float]  # x, y, width, height


@dataclass(frozen=True, slots=True)
class Layout:
    """Where things are on the page [mm], origin at the lower left: the board, and the beginnings of
    the ruler along its bottom and of the one up its left side; crosses: by letter, of a two-sided board."""

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
    """The board with the largest squares of whole millimetres that fit on the paper, or of the
    side asked for. Raises ConfigError when they do not fit, or are too small to be seen."""
    size = f"{columns}x{rows}"
    most_mm = max(_most_mm(page, columns, rows, two_sided) for page in _pages_mm(paper))
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


def flags_of(board: BoardSpec) -> str:
    """The flags with which `mocapd calibrate` reads this board; lengths in metres."""
    return (
        f"--board {board.kind} --board-size {board.columns}x{board.rows}"
        f" --square {board.square_m:g} --marker {board.marker_m:g}"
        f" --dictionary {board.dictionary}"
        + (" --inverted" if board.inverted else "")
        + (" --two-sided" if board.two_sided else "")
    )


def layout_of(board: BoardSpec, paper: str) -> Layout:
    """The page, upright unless lying it takes the board with more room; of two the front's."""

    def most_mm(page_mm: Size) -> float:
        return _most_mm(page_mm, board.columns, board.rows, board.two_sided)

    page_mm = max(_pages_mm(paper), key=most_mm)
    x, y, _, _ = _area(page_mm, board.two_sided)
    width, height = (board.columns * board.square_m * 1000, board.rows * board.square_m * 1000)
    return Layout(
        page_mm,
        (x, y, width, height),
        ruler_mm=(x, _EDGE_MM + _COMMAND_STRIP_MM),
        upright_ruler_mm=(_EDGE_MM + RULER_HEIGHT_MM, y),
        crosses=_crosses((x, y, width, height)) if board.two_sided else {},
    )


def layout_behind(front: Layout) -> Layout:
    """The page of the back: all that must lie behind the front's own is mirrored across the page, so that it
    lies there too on a sheet that is printed on both sides."""
    width_mm = front.page_mm[0]
    x, y, width, height = front.board
    left = width_mm - x - width
    return replace(
        front,
        board=(left, y, width, height),
        ruler_mm=(left, front.ruler_mm[1]),
        crosses={letter: (width_mm - cx, cy) for letter, (cx, cy) in front.crosses.items()},
    )


def _crosses(board: Rect) -> dict[str, Size]:
    x, y, width, height = board
    left, right = x - _CROSS_MM, x + width + _CROSS_MM
    below, above = y - _CROSS_MM, y + height + _CROSS_MM
    return {"A": (left, above), "B": (right, above), "C": (right, below), "D": (left, below)}


def board_pdf(board: BoardSpec, paper: str) -> bytes:
    """The PDF with a ChArUco board, not of the legacy layout: one page, or two for a two-sided one. The same
    board and paper give the same bytes."""
    layout = layout_of(board, paper)
    kind = "ChArUco board, inverted" if board.inverted else "ChArUco board"
    document = Document(
        About(
            f"mocapd {kind} {board.columns}x{board.rows}",
            f"{kind} for camera calibration, {paper}; print at 100 %",
            flags_of(board),
        )
    )
    title = f"FRONT: {kind}" if board.two_sided else kind
    canvas = document.page(layout.page_mm, title)
    _draw_board(canvas, board, layout.board)
    draw_ruler(canvas, layout.ruler_mm)
    draw_ruler(canvas, layout.upright_ruler_mm, upright=True)
    _draw_crosses(canvas, layout)
    _write_beside(canvas, board, layout, f"{title}, {paper}")
    if board.two_sided:
        behind = layout_behind(layout)
        title = f"BACK: {kind}, mirrored"
        canvas = document.page(layout.page_mm, title)
        _draw_mirrored(canvas, board, behind.board)
        draw_ruler(canvas, behind.ruler_mm)
        _draw_crosses(canvas, behind)
        _write_on_back(canvas, board, behind, f"{title}, {paper}")
    return document.finish()


def dark_rects(board: BoardSpec) -> Iterator[Rect]:
    """Rectangles (x, y, width, height) [mm] from the board's top left corner, y down: dark where one
    covers (the squares, and the markers' cells beside them), light where two do (inverted: the
    cells in their squares)."""
    side = board.square_m * 1000
    for row in range(board.rows):
        for column in range((row + board.inverted) % 2, board.columns, 2):
            yield column * side, row * side, side, side
    charuco = aruco_board(board)
    dictionary = charuco.getDictionary()
    cells = dictionary.markerSize + 2
    cell_mm = board.marker_m * 1000 / cells
    for marker, corners in zip(charuco.getIds().ravel(), charuco.getObjPoints(), strict=True):
        x, y = 1000 * np.asarray(corners, dtype=float)[:, :2].min(axis=0)
        image = dictionary.generateImageMarker(int(marker), cells, borderBits=1)
        for r, row_of_cells in enumerate(image == 0):
            for begin, end in _runs(row_of_cells):
                yield x + begin * cell_mm, y + r * cell_mm, (end - begin) * cell_mm, cell_mm


def _draw_board(canvas: Canvas, board: BoardSpec, rect: Rect) -> None:
    x, y, _, height = rect
    canvas.saveState()
    canvas.setFillColorRGB(*BLACK)
    # one path for all: cells that touch are filled as one, without a hairline between them
    path = canvas.beginPath()
    for left, top, w, h in dark_rects(board):
        path.rect(x + left, y + height - top - h, w, h)
    canvas.drawPath(path, stroke=0, fill=1, fillMode=FILL_EVEN_ODD)
    canvas.restoreState()


def _draw_mirrored(canvas: Canvas, board: BoardSpec, rect: Rect) -> None:
    canvas.saveState()
    canvas.translate(2.0 * rect[0] + rect[2], 0.0)
    canvas.scale(-1.0, 1.0)
    _draw_board(canvas, board, rect)
    canvas.restoreState()


def _draw_crosses(canvas: Canvas, layout: Layout) -> None:
    """Each with its letter in its upper right quarter."""
    canvas.setStrokeColorRGB(*BLACK)
    canvas.setLineWidth(0.15)
    for letter, (x, y) in layout.crosses.items():
        canvas.line(x - _ARM_MM, y, x + _ARM_MM, y)
        canvas.line(x, y - _ARM_MM, x, y + _ARM_MM)
        write_text(canvas, (x + 0.8, y + 0.8), letter, 3.0, font=BOLD)


def _write_beside(canvas: Canvas, board: BoardSpec, layout: Layout, title: str) -> None:
    x, y = layout.ruler_mm
    glue = "Glue it flat onto something stiff"
    glue += "; how BACK goes on is said there." if board.two_sided else "."
    _write_title(canvas, board, layout, title, glue)
    write_text(canvas, (x, y - 4.8), _MEASURE, 2.4, font=BOLD)
    command = f"mocapd calibrate --from-folder DIR --no-browser --out rig.json {flags_of(board)}"
    room_mm = layout.page_mm[0] - _EDGE_MM - x
    em_mm = min(2.0, room_mm / (_COURIER_ADVANCE * len(command)))
    write_text(canvas, (x, y - 8.6), command, em_mm, font="Courier", colour=DARK)
    canvas.saveState()
    ux, uy = layout.upright_ruler_mm
    canvas.translate(ux - 1.0, uy + RULER_MM + 6.0)
    canvas.rotate(90)
    write_text(canvas, (0.0, 0.0), "mocapd", 3.4, font=BOLD, colour=DARK)
    canvas.restoreState()


def _write_on_back(canvas: Canvas, board: BoardSpec, layout: Layout, title: str) -> None:
    x, y = layout.ruler_mm
    _write_title(canvas, board, layout, title, "Its crosses belong behind those of FRONT.")
    room_mm = layout.page_mm[0] - _EDGE_MM - x
    for line, below in zip(_GLUE, (4.8, 8.6), strict=True):
        em_mm = _fitting_mm(line, BOLD, 2.4, room_mm)
        write_text(canvas, (x, y - below), line, em_mm, font=BOLD)


def _write_title(canvas: Canvas, board: BoardSpec, layout: Layout, title: str, remark: str) -> None:
    """Beside the ruler."""
    x, y = layout.ruler_mm
    beside = x + RULER_MM + 8.0
    write_text(canvas, (beside, y + 5.0), title, 3.4, font=BOLD)
    squares = f"{board.columns} x {board.rows} squares of {board.square_m * 1000:g} mm"
    markers = f"markers of {board.marker_m * 1000:g} mm, {board.dictionary}"
    lines = [f"{squares}, {markers}", remark]
    room_mm = layout.page_mm[0] - _EDGE_MM - beside
    em_mm = min(_fitting_mm(line, "Helvetica", 2.4, room_mm) for line in lines)
    write_text(canvas, (beside, y + 1.4), lines, em_mm)


def _fitting_mm(line: str, font: str, em_mm: float, room_mm: float) -> float:
    """The font's em, smaller where the line has no room."""
    return min(em_mm, room_mm / float(stringWidth(line, font, 1.0)))


def _pages_mm(paper: str) -> tuple[Size, Size]:
    """Upright and lying."""
    width, height = paper_size_mm(paper)
    return (width, height), (height, width)


def _area(page_mm: Size, two_sided: bool) -> Rect:
    """Where the board may be."""
    left = _EDGE_MM + _RULER_STRIP_MM
    bottom = left + _COMMAND_STRIP_MM
    edge = _EDGE_MM + (_CROSS_STRIP_MM if two_sided else 0.0)
    return left, bottom, page_mm[0] - left - edge, page_mm[1] - bottom - edge


def _most_mm(page_mm: Size, columns: int, rows: int, two_sided: bool) -> float:
    """The side of the largest squares; BoardSpec refuses a board without any."""
    _, _, width, height = _area(page_mm, two_sided)
    return min(width / max(columns, 1), height / max(rows, 1))


def _runs(cells: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Begin and end of each run of True in (N,)."""
    steps = np.flatnonzero(np.diff(np.concatenate([[0], cells.astype(np.int8), [0]])))
    yield from zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True)
