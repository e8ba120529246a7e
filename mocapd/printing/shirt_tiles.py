"""A large piece over several pages: the part on each page, and marks for joining them."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from string import ascii_uppercase

import numpy as np
from reportlab.pdfgen.canvas import Canvas

from mocapd.printing.paper_sizes import Size, both_ways_mm
from mocapd.printing.pdf_document import BOLD, DARK, PALE, write_text
from mocapd.types import Floats

EDGE_MM = 12.0  # from the paper's edge to the frame; printers leave 5 mm of it white
FOOT_MM = 8.0  # more at the lower edge, for the page's name
_BLEED_MM = 4.0  # drawn beyond the frame, so that joining them need not be exact
_MARK_MM = 5.0
_SPARE_MM = 4.0  # round the piece, so that no line runs along a frame


@dataclass(frozen=True, slots=True)
class Tile:
    """Row and column from the top left, 0.., and the lower left of its frame on the piece [mm]."""

    row: int
    column: int
    corner_mm: Size

    @property
    def name(self) -> str:
        """Row as a letter, column as a number: A1 is at the top left."""
        return f"{ascii_uppercase[self.row]}{self.column + 1}"


@dataclass(frozen=True, slots=True)
class Tiling:
    """Rows and columns of frames of one size on pages of one size, that cover the piece."""

    page_mm: Size
    rows: int
    columns: int
    top_left_mm: Size  # of the whole, on the piece

    @property
    def frame_mm(self) -> Size:
        """Width and height of the part that is on one page."""
        return _frame(self.page_mm)

    def tiles(self) -> Iterator[Tile]:
        """From the top left, row by row."""
        width, height = self.frame_mm
        left, top = self.top_left_mm
        for row in range(self.rows):
            for column in range(self.columns):
                yield Tile(row, column, (left + column * width, top - (row + 1) * height))


def tiling_of(polygon: Floats, paper: str) -> Tiling:
    """The layout, portrait or landscape, with the fewest pages; the polygon (N,2) is in the middle."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    size = high - low + 2 * _SPARE_MM
    centre = 0.5 * (low + high)

    def tiling(page_mm: Size) -> Tiling:
        frame = _frame(page_mm)
        columns, rows = ceil(size[0] / frame[0]), ceil(size[1] / frame[1])
        top_left = centre + 0.5 * np.array([-columns * frame[0], rows * frame[1]])
        return Tiling(page_mm, rows, columns, (float(top_left[0]), float(top_left[1])))

    return min(map(tiling, both_ways_mm(paper)), key=lambda one: one.rows * one.columns)


def draw_tile(canvas: Canvas, tiling: Tiling, tile: Tile, form: str, foot: str) -> None:
    """One page: its part of the piece, which is the canvas's form of this name, and its frame."""
    width, height = tiling.frame_mm
    canvas.saveState()
    clip = canvas.beginPath()
    corner = (EDGE_MM - _BLEED_MM, EDGE_MM + FOOT_MM - _BLEED_MM)
    clip.rect(*corner, width + 2 * _BLEED_MM, height + 2 * _BLEED_MM)
    canvas.clipPath(clip, stroke=0, fill=0)
    canvas.translate(EDGE_MM - tile.corner_mm[0], EDGE_MM + FOOT_MM - tile.corner_mm[1])
    canvas.doForm(form)
    canvas.restoreState()
    canvas.saveState()
    canvas.translate(EDGE_MM, EDGE_MM + FOOT_MM)
    _draw_frame(canvas, tiling, tile)
    write_text(canvas, (3.0, height - 8.0), tile.name, 7.0, font=BOLD, colour=PALE)
    write_text(canvas, (0.0, -9.0), foot, 2.6, colour=DARK)
    canvas.restoreState()


def _draw_frame(canvas: Canvas, tiling: Tiling, tile: Tile) -> None:
    """The frame; crosses at its corners; at the middle of each side that has a neighbour a diamond,
    half of it on either page, with the names of both."""
    width, height = tiling.frame_mm
    canvas.setStrokeColorRGB(*PALE)
    canvas.setLineWidth(0.2)
    canvas.rect(0.0, 0.0, width, height)
    canvas.setStrokeColorRGB(*DARK)
    for x in (0.0, width):
        for y in (0.0, height):
            canvas.line(x - _MARK_MM, y, x + _MARK_MM, y)
            canvas.line(x, y - _MARK_MM, x, y + _MARK_MM)
    for x, y, down, right in (
        (width / 2, height, -1, 0),
        (width / 2, 0.0, 1, 0),
        (0.0, height / 2, 0, -1),
        (width, height / 2, 0, 1),
    ):
        row, column = tile.row + down, tile.column + right
        if not (0 <= row < tiling.rows and 0 <= column < tiling.columns):
            continue
        diamond = canvas.beginPath()
        diamond.moveTo(x - _MARK_MM, y)
        for dx, dy in ((0, _MARK_MM), (_MARK_MM, 0), (0, -_MARK_MM)):
            diamond.lineTo(x + dx, y + dy)
        diamond.close()
        canvas.drawPath(diamond, stroke=1, fill=0)
        neighbour = Tile(row, column, (0.0, 0.0)).name
        inwards = (x - 9.0 * right - 1.0 * abs(right), y + 9.0 * down - 1.0 * abs(down))
        write_text(canvas, inwards, f"to {neighbour}", 2.2, colour=DARK, align="centre")


def _frame(page_mm: Size) -> Size:
    return page_mm[0] - 2 * EDGE_MM, page_mm[1] - 2 * EDGE_MM - FOOT_MM
