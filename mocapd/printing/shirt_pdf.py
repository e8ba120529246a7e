"""The standard shirt as a PDF: overview, swatch card, and its pieces at true size."""

from reportlab.pdfgen.canvas import Canvas

from mocapd.errors import ConfigError
from mocapd.printing.cielab import lab_from_srgb
from mocapd.printing.paper_sizes import RULER_HEIGHT_MM, Size, paper_size_mm
from mocapd.printing.pdf_document import BOLD, DARK, Document, draw_ruler, write_text
from mocapd.printing.shirt_drawing import (
    centre_of,
    colour_of,
    draw_cloth,
    draw_lines,
    ink_on,
    polygon_path,
    write_patch_names,
)
from mocapd.printing.shirt_pattern import (
    HEM_MM,
    SEAM_MM,
    Piece,
    ShirtMeasures,
    measures_of,
    pieces_of,
)
from mocapd.printing.shirt_tiles import Tiling, draw_tile, tiling_of
from mocapd.shirt.standard_shirt import N_COLOURS, Shirt, standard_shirt

LAYOUTS = ("sewing", "printing")
_EDGE_MM = 14.0
_SEWING_TINT = 0.25  # of the colour: enough to distinguish the patches, and spares ink
_SHEET_EDGE_MM = 10.0

Tiled = tuple[tuple[Piece, Tiling], ...]


def shirt_pdf(size: str, paper: str = "A4", layout: str = "sewing") -> bytes:
    """The PDF for one of SIZES. The same arguments give the same bytes.

    `sewing`: the pieces over pages of the paper, patches pale, to lay on cloth of ten colours;
    `printing`: each piece in full colour on one page of its own size, for a printer of cloth.
    Raises ConfigError for an unknown size, paper or layout.
    """
    measures, shirt = measures_of(size), standard_shirt()
    size = size.upper()
    paper_mm = paper_size_mm(paper)
    if layout not in LAYOUTS:
        raise ConfigError(f"no layout {layout!r}", "--layout", f"choose {' or '.join(LAYOUTS)}")
    pieces = tuple((piece, tiling_of(piece.cut, paper)) for piece in pieces_of(measures))
    document = Document(
        f"mocapd shirt {shirt.version}, size {size}",
        f"Pattern for {layout} at true size; print at 100 %",
        f"shirt={shirt.version} size={size} seam_mm={SEAM_MM:g} hem_mm={HEM_MM:g}",
    )
    _overview(document.page(paper_mm, "Overview"), paper_mm, size, measures, pieces, layout)
    _swatch_card(document.page(paper_mm, "Swatch card"), paper_mm, shirt)
    if layout == "sewing":
        _add_tiles(document, pieces, f"mocapd shirt {shirt.version} · size {size}")
    else:
        _add_sheets(document, pieces)
    return document.finish()


def _add_tiles(document: Document, pieces: Tiled, what: str) -> None:
    last = 2 + sum(tiling.rows * tiling.columns for _, tiling in pieces)
    number = 2
    for piece, tiling in pieces:
        form = piece.name.replace(" ", "_")  # a name in a PDF has no blank
        for tile in tiling.tiles():
            number += 1
            canvas = document.page(tiling.page_mm, f"{piece.name} {tile.name}")
            foot = (
                f"{what} · {piece.name} · {tile.name}: row {tile.row + 1} of {tiling.rows},"
                f" column {tile.column + 1} of {tiling.columns} · page {number} of {last}"
            )
            if (tile.row, tile.column) == (0, 0):
                _keep_for_sewing(canvas, piece, form)
            draw_tile(canvas, tiling, tile, form, foot)


def _add_sheets(document: Document, pieces: Tiled) -> None:
    for piece, _ in pieces:
        low, high = piece.cut.min(axis=0), piece.cut.max(axis=0)
        width, height = high - low + 2 * _SHEET_EDGE_MM
        canvas = document.page((float(width), float(height)), piece.name)
        canvas.translate(*(_SHEET_EDGE_MM - low))
        draw_cloth(canvas, piece)
        canvas.setLineWidth(0.3)
        canvas.setStrokeColorRGB(*DARK)
        canvas.drawPath(polygon_path(canvas, piece.cut), stroke=1, fill=0)


def _keep_for_sewing(canvas: Canvas, piece: Piece, form: str) -> None:
    """The piece as a form of this name, which is in the file once and drawn on each of its pages."""
    low, high = piece.cut.min(axis=0) - 1.0, piece.cut.max(axis=0) + 1.0
    canvas.beginForm(form, *low, *high)
    draw_cloth(canvas, piece, _SEWING_TINT)
    draw_lines(canvas, piece)
    write_patch_names(canvas, piece)
    canvas.endForm()


# --- the first page --------------------------------------------------------------------------


def _overview(
    canvas: Canvas, page_mm: Size, size: str, measures: ShirtMeasures, pieces: Tiled, layout: str
) -> None:
    width, height = page_mm
    shirt = standard_shirt()
    title = f"The shirt {shirt.version}, size {size}"
    write_text(canvas, (_EDGE_MM, height - 20), title, 7.0, font=BOLD)
    write_text(canvas, (_EDGE_MM, height - 27), _measures_line(measures), 3.0, colour=DARK)
    write_text(canvas, (_EDGE_MM, height - 34), _how_to(layout), 3.0)
    drawings_mm = (width - 2 * _EDGE_MM, height - 59 - 75)
    _draw_small(canvas, (_EDGE_MM, 75.0), drawings_mm, pieces, numbered=layout == "sewing")
    _patch_table(canvas, (_EDGE_MM, 68.0), width - 2 * _EDGE_MM, shirt)
    draw_ruler(canvas, (_EDGE_MM, 12.0))
    says = ["Measure me: this must be 100 mm.", "If not, print again at 100 %, without scaling."]
    write_text(canvas, (_EDGE_MM + 108, 12.0 + RULER_HEIGHT_MM / 2), says, 2.6, font=BOLD)


def _measures_line(m: ShirtMeasures) -> str:
    figures = {"stature": m.stature, "chest": m.chest, "sleeve round": m.armhole, "cuff": m.cuff}
    return "For a wearer of about: " + ", ".join(f"{k} {v / 10:g} cm" for k, v in figures.items())


def _how_to(layout: str) -> list[str]:
    allowances = f"{SEAM_MM:g} mm for seams and {HEM_MM:g} mm for hems are outside the thin lines."
    if layout == "printing":
        return [
            "Each following page is one piece at true size: print it on stretch cloth, face up.",
            f"Cut along the line. {allowances}",
            "Sew front to back at the shoulders, set the sleeves in (patches 10, 12, 16 and 18 to the"
            " front), close the sides.",
        ]
    return [
        "Cut each page at the right and the lower side of its frame, lay it on the next by the"
        " diamonds, glue.",
        f"Cut each patch from stretch cloth of its colour, {SEAM_MM:g} mm more on every inner side."
        " Sew the patches to pieces.",
        "Sew front to back at the shoulders, set the sleeves in by their notches (one: front, two:"
        " back), close the sides.",
        f"{allowances} The outside of the cloth is towards you.",
        "The dash-dotted line of a sleeve lies along the top of the arm.",
    ]


def _draw_small(
    canvas: Canvas, at_mm: Size, room_mm: Size, pieces: Tiled, *, numbered: bool
) -> None:
    """The pieces two by two, in true colours; with the pages when `numbered`."""
    cell = (room_mm[0] / 2, room_mm[1] / 2)
    wholes = [(t.columns * t.frame_mm[0], t.rows * t.frame_mm[1]) for _, t in pieces]
    scale = min(min((cell[0] - 4) / w, (cell[1] - 14) / h) for w, h in wholes)
    last = 2
    for i, (piece, tiling) in enumerate(pieces):
        middle_x = at_mm[0] + cell[0] * (i % 2 + 0.5)
        top = at_mm[1] + cell[1] * (2 - i // 2)
        write_text(canvas, (middle_x, top - 3.0), piece.name, 3.2, font=BOLD, align="centre")
        sizes = "{:.0f} x {:.0f} mm without allowances".format(*piece.size_mm)
        if numbered:
            first, last = last + 1, last + tiling.rows * tiling.columns
            sizes += f", pages {first} to {last}"
        write_text(canvas, (middle_x, top - 6.6), sizes, 2.4, colour=DARK, align="centre")
        left, high = tiling.top_left_mm
        canvas.saveState()
        canvas.translate(middle_x, top - 11.5)
        canvas.scale(scale, scale)
        canvas.translate(-left - wholes[i][0] / 2, -high)
        draw_cloth(canvas, piece)
        draw_lines(canvas, piece, 0.12 / scale)
        if numbered:
            _draw_grid(canvas, tiling, scale)
        for patch in piece.patches:
            ink = ink_on(colour_of(patch.index)[1])
            x, y = centre_of(patch.outline)
            at, figure = (x, y - 1.5 / scale), str(patch.index)
            write_text(canvas, at, figure, 4 / scale, font=BOLD, colour=ink, align="centre")
        canvas.restoreState()


def _draw_grid(canvas: Canvas, tiling: Tiling, scale: float) -> None:
    """The pages' frames, with row and column names at their edges."""
    w, h = tiling.frame_mm
    canvas.setStrokeColorRGB(*DARK)
    canvas.setLineWidth(0.1 / scale)
    for tile in tiling.tiles():
        x, y = tile.corner_mm
        canvas.rect(x, y, w, h)
        if tile.column == 0:
            at = (x - 2.5 / scale, y + h / 2 - 0.8 / scale)
            write_text(canvas, at, tile.name[0], 2.4 / scale, colour=DARK, align="centre")
        if tile.row == 0:
            at = (x + w / 2, y + h + 1.0 / scale)
            write_text(canvas, at, tile.name[1:], 2.4 / scale, colour=DARK, align="centre")


def _patch_table(canvas: Canvas, at_mm: Size, width_mm: float, shirt: Shirt) -> None:
    """The twenty patches in three columns: number, swatch, name, colour."""
    x0, y0 = at_mm
    rows = 7
    for i, name in enumerate(shirt.patch_names):
        x = x0 + (i // rows) * width_mm / 3
        y = y0 - (i % rows) * 5.6
        number, colour = colour_of(i + 1)
        write_text(canvas, (x + 5, y), str(i + 1), 2.8, font=BOLD, align="right")
        canvas.setFillColorRGB(*colour)
        canvas.rect(x + 7, y - 0.9, 6, 3.8, stroke=0, fill=1)
        says = f"{name.replace('_', ' ')}: {number} {shirt.colour_names[number - 1]}"
        write_text(canvas, (x + 15, y), says, 2.5)


# --- the second page -------------------------------------------------------------------------


def _swatch_card(canvas: Canvas, page_mm: Size, shirt: Shirt) -> None:
    """Ten fields of the true colours with names, sRGB and CIELAB."""
    width, height = page_mm
    write_text(canvas, (_EDGE_MM, height - 20), f"Swatch card of {shirt.version}", 7.0, font=BOLD)
    lines = [
        "Compare it in daylight with cloth or dye. Close is good enough: mocapd learns the colours in"
        " your light.",
        "What matters is that the ten differ as much from each other as here. CIELAB: D65, 2 degrees.",
    ]
    write_text(canvas, (_EDGE_MM, height - 27), lines, 3.0)
    lab = lab_from_srgb(shirt.srgb)
    cell_mm = ((width - 2 * _EDGE_MM + 6) / 2, (height - 50) / 5)
    for i in range(N_COLOURS):
        x = _EDGE_MM + (i % 2) * cell_mm[0]
        y = height - 36 - (i // 2 + 1) * cell_mm[1] + 6
        red, green, blue = shirt.srgb[i].tolist()
        field = (cell_mm[0] - 6, cell_mm[1] - 18)
        canvas.setFillColorRGB(red / 255, green / 255, blue / 255)
        canvas.rect(x, y + 12, *field, stroke=0, fill=1)
        title = f"{i + 1} {shirt.colour_names[i]}"
        write_text(canvas, (x, y + 7.5), title, 4.0, font=BOLD)
        on = ", ".join(str(p) for p in range(1, 21) if shirt.colour_of_patch[p] == i + 1)
        hexadecimal = f"#{red:02X}{green:02X}{blue:02X}"
        says = [
            f"sRGB {red} {green} {blue}   {hexadecimal}",
            "L* {:.1f}   a* {:.1f}   b* {:.1f}".format(*lab[i]) + f"   patches {on}",
        ]
        write_text(canvas, (x, y + 3.2), says, 2.8, colour=DARK)
