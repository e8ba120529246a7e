"""A piece of the shirt, drawn in millimetres."""

import numpy as np
from reportlab.pdfgen.canvas import Canvas
from reportlab.pdfgen.pathobject import PDFPathObject

from mocapd.printing.paper_sizes import Size
from mocapd.printing.pdf_document import BLACK, BOLD, DARK, Colour, write_text
from mocapd.printing.shirt_pattern import Piece
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats

_WHITE: Colour = (1.0, 1.0, 1.0)


def colour_of(patch: int) -> tuple[int, Colour]:
    """The number 1..10 of a patch's colour, and its sRGB 0..1."""
    shirt = standard_shirt()
    number = int(shirt.colour_of_patch[patch])
    red, green, blue = (shirt.srgb[number - 1] / 255.0).tolist()
    return number, (red, green, blue)


def ink_on(colour: Colour) -> Colour:
    """Black or white, whichever is easier to read on this colour (WCAG relative luminance)."""
    red, green, blue = (channel**2.2 for channel in colour)
    return BLACK if 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.179 else _WHITE


def draw_cloth(canvas: Canvas, piece: Piece, tint: float = 1.0) -> None:
    """The patches in their colours, as far as the line to cut; `tint` below 1 is paler, to save ink."""
    for patch in piece.patches:
        _, colour = colour_of(patch.index)
        canvas.setFillColorRGB(*(1.0 - tint * (1.0 - channel) for channel in colour))
        canvas.drawPath(polygon_path(canvas, patch.cloth), stroke=0, fill=1)


def draw_lines(canvas: Canvas, piece: Piece, width_mm: float = 0.3) -> None:
    """The line to cut (thick), those to sew (thin), the notches, and the top of the arm (dash-dotted)."""
    canvas.saveState()
    canvas.setLineJoin(1)
    canvas.setStrokeColorRGB(*BLACK)
    canvas.setLineWidth(2 * width_mm)
    canvas.drawPath(polygon_path(canvas, piece.cut), stroke=1, fill=0)
    canvas.setLineWidth(width_mm)
    for x0, y0, x1, y1 in piece.notches:
        canvas.line(x0, y0, x1, y1)
    for patch in piece.patches:
        canvas.drawPath(polygon_path(canvas, patch.outline), stroke=1, fill=0)
    if piece.fold is not None:
        (x0, y0), (x1, y1) = piece.fold
        canvas.setStrokeColorRGB(*DARK)
        canvas.setDash([12 * width_mm, 4 * width_mm, 2 * width_mm, 4 * width_mm])
        canvas.line(x0, y0, x1, y1)
    canvas.restoreState()


def write_patch_names(canvas: Canvas, piece: Piece) -> None:
    """In the middle of each patch its number, name and colour."""
    shirt = standard_shirt()
    for patch in piece.patches:
        number, _ = colour_of(patch.index)
        x, y = centre_of(patch.outline)
        name = shirt.patch_names[patch.index - 1].replace("_", " ")
        lines = [name, f"colour {number} {shirt.colour_names[number - 1]}"]
        figure = str(patch.index)
        write_text(canvas, (x, y + 3), figure, 16, font=BOLD, align="centre")
        write_text(canvas, (x, y - 6), lines, 6, align="centre")


def polygon_path(canvas: Canvas, polygon: Floats) -> PDFPathObject:
    """The closed path of (N,2) points [mm], for `drawPath` and `clipPath`."""
    path = canvas.beginPath()
    path.moveTo(*polygon[0])
    for point in polygon[1:]:
        path.lineTo(*point)
    path.close()
    return path


def centre_of(polygon: Floats) -> Size:
    """Its centre of area."""
    x, y = polygon.T
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    cross = x * next_y - next_x * y
    area = 3.0 * cross.sum()
    return float(((x + next_x) @ cross) / area), float(((y + next_y) @ cross) / area)
