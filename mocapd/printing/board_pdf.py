"""The calibration board as a PDF: a ChArUco board at true size with its parameters and rulers. A two-sided
board has a second page with the mirror image, and crosses for gluing the pages back to back."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.pdfgen.canvas import FILL_EVEN_ODD, Canvas

from mocapd.calibration.board_spec import BoardSpec, aruco_board
from mocapd.printing.board_layout import EDGE_MM, Layout, Rect, layout_behind, layout_of
from mocapd.printing.paper_sizes import RULER_MM
from mocapd.printing.pdf_document import BLACK, BOLD, DARK, Document, draw_ruler, write_text

_ARM_MM = 3.5  # of a cross, on each side of its middle
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


def flags_of(board: BoardSpec) -> str:
    """The flags with which `mocapd calibrate` reads this board; lengths in metres."""
    return (
        f"--board {board.kind} --board-size {board.columns}x{board.rows}"
        f" --square {board.square_m:g} --marker {board.marker_m:g}"
        f" --dictionary {board.dictionary}"
        + (" --inverted" if board.inverted else "")
        + (" --two-sided" if board.two_sided else "")
    )


def board_pdf(board: BoardSpec, paper: str) -> bytes:
    """The PDF of a ChArUco board, not of the legacy layout: one page, or two for a two-sided one. The same board and
    paper give the same bytes."""
    layout = layout_of(board, paper)
    kind = "ChArUco board, inverted" if board.inverted else "ChArUco board"
    document = Document(
        f"mocapd {kind} {board.columns}x{board.rows}",
        f"{kind} for camera calibration, {paper}; print at 100 %",
        flags_of(board),
    )
    title = f"FRONT: {kind}" if board.two_sided else kind
    canvas = document.page(layout.page_mm, title)
    _draw_board(canvas, board, layout.board)
    draw_ruler(canvas, layout.ruler_mm)
    draw_ruler(canvas, layout.upright_ruler_mm, upright=True)
    _draw_crosses(canvas, layout)
    _write_labels(canvas, board, layout, f"{title}, {paper}")
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
    """Rectangles (x, y, width, height) [mm] from the board's top left corner, y down. One rectangle is dark (the
    squares, and the cells of markers in white squares); two on top of each other are light (inverted boards: the cells
    of markers in black squares)."""
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
    if not layout.crosses:
        return
    canvas.setStrokeColorRGB(*BLACK)
    canvas.setLineWidth(0.15)
    for letter, (x, y) in layout.crosses.items():
        canvas.line(x - _ARM_MM, y, x + _ARM_MM, y)
        canvas.line(x, y - _ARM_MM, x, y + _ARM_MM)
        write_text(canvas, (x + 0.8, y + 0.8), letter, 3.0, font=BOLD)


def _write_labels(canvas: Canvas, board: BoardSpec, layout: Layout, title: str) -> None:
    x, y = layout.ruler_mm
    glue = "Glue it flat onto something stiff"
    glue += "; how BACK goes on is said there." if board.two_sided else "."
    _write_title(canvas, board, layout, title, glue)
    write_text(canvas, (x, y - 4.8), _MEASURE, 2.4, font=BOLD)
    command = f"mocapd calibrate --from-folder DIR --no-browser --out rig.json {flags_of(board)}"
    room_mm = layout.page_mm[0] - EDGE_MM - x
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
    room_mm = layout.page_mm[0] - EDGE_MM - x
    for line, below in zip(_GLUE, (4.8, 8.6), strict=True):
        em_mm = _fitting_mm(line, BOLD, 2.4, room_mm)
        write_text(canvas, (x, y - below), line, em_mm, font=BOLD)


def _write_title(canvas: Canvas, board: BoardSpec, layout: Layout, title: str, remark: str) -> None:
    """To the right of the ruler, up to a cross."""
    x, y = layout.ruler_mm
    left = x + RULER_MM + 8.0
    beside = [
        cx - _ARM_MM - 1.0
        for cx, cy in layout.crosses.values()
        if cx > left and cy < layout.board[1]
    ]
    room_mm = min([layout.page_mm[0] - EDGE_MM, *beside]) - left
    em_mm = _fitting_mm(title, BOLD, 3.4, room_mm)
    write_text(canvas, (left, y + 5.0), title, em_mm, font=BOLD)
    squares = f"{board.columns} x {board.rows} squares of {board.square_m * 1000:g} mm"
    markers = f"markers of {board.marker_m * 1000:g} mm, {board.dictionary}"
    lines = [f"{squares}, {markers}", remark]
    em_mm = min(_fitting_mm(line, "Helvetica", 2.4, room_mm) for line in lines)
    write_text(canvas, (left, y + 1.4), lines, em_mm)


def _fitting_mm(line: str, font: str, em_mm: float, room_mm: float) -> float:
    """The font's em, smaller where the line has no room."""
    return min(em_mm, room_mm / float(stringWidth(line, font, 1.0)))


def _runs(cells: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Begin and end of each run of True in (N,)."""
    steps = np.flatnonzero(np.diff(np.concatenate([[0], cells.astype(np.int8), [0]])))
    yield from zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True)
