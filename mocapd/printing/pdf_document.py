"""A PDF document in millimetres, and the ruler that shows its scale."""

import io
from collections.abc import Sequence
from pathlib import Path

from reportlab.pdfgen.canvas import Canvas

from mocapd.output_file import PDF, OutputFile
from mocapd.printing.paper_sizes import RULER_HEIGHT_MM, RULER_MM, Size

Colour = tuple[float, float, float]

BOLD = "Helvetica-Bold"
BLACK: Colour = (0.0, 0.0, 0.0)
DARK: Colour = (0.25, 0.25, 0.25)
PALE: Colour = (0.6, 0.6, 0.6)

_POINTS_PER_MM = 72 / 25.4
_CAP_HEIGHT = 0.72  # of Helvetica, in ems


class Document:
    """A PDF whose unit is the millimetre, origin at the lower left, y up.

    The same calls give the same bytes: dates and ids in it are fixed. The file asks viewers to print it
    without scaling.
    """

    def __init__(self, title: str, subject: str, keywords: str) -> None:
        """keywords: the parameters, for programs to read."""
        self._buffer = io.BytesIO()
        self._canvas = Canvas(self._buffer, invariant=1, pageCompression=1)
        self._canvas.setTitle(title)
        self._canvas.setSubject(subject)
        self._canvas.setKeywords(keywords)
        self._canvas.setAuthor("mocapd")
        self._canvas.setCreator("mocapd")
        self._canvas.setViewerPreference("PrintScaling", "None")
        self._pages = 0

    def page(self, size_mm: Size, bookmark: str) -> Canvas:
        """Begin a page, with `bookmark` as its entry in the outline; returns the canvas to draw on."""
        if self._pages:
            self._canvas.showPage()
        self._pages += 1
        self._canvas.setPageSize(tuple(side * _POINTS_PER_MM for side in size_mm))
        self._canvas.scale(_POINTS_PER_MM, _POINTS_PER_MM)
        key = f"page{self._pages}"
        self._canvas.bookmarkPage(key)
        self._canvas.addOutlineEntry(bookmark, key, level=0)
        return self._canvas

    def finish(self) -> bytes:
        """The file's bytes; nothing can be drawn afterwards."""
        self._canvas.save()
        return self._buffer.getvalue()


def write_text(
    canvas: Canvas,
    at_mm: Size,
    lines: str | Sequence[str],
    size_mm: float = 3.0,
    *,
    font: str = "Helvetica",
    colour: Colour = BLACK,
    align: str = "left",
) -> None:
    """Lines of text, the first with its base line at `at_mm`; `size_mm`: the font's em."""
    canvas.setFont(font, size_mm)
    canvas.setFillColorRGB(*colour)
    draw = {
        "left": canvas.drawString,
        "centre": canvas.drawCentredString,
        "right": canvas.drawRightString,
    }[align]
    x, y = at_mm
    for i, line in enumerate([lines] if isinstance(lines, str) else lines):
        draw(x, y - 1.35 * size_mm * i, line)


def draw_ruler(canvas: Canvas, at_mm: Size, *, upright: bool = False) -> None:
    """A ruler of RULER_MM from `at_mm` to the right with its ticks upwards, or (`upright`) upwards with its ticks to
    the left; RULER_HEIGHT_MM high. Its length is from the centre of the first tick to that of the last.
    """
    canvas.saveState()
    canvas.translate(*at_mm)
    if upright:
        canvas.rotate(90)
    canvas.setStrokeColorRGB(*BLACK)
    canvas.setLineCap(0)
    canvas.setLineWidth(0.15)
    canvas.line(-0.075, 0.0, RULER_MM + 0.075, 0.0)
    for mm in range(RULER_MM + 1):
        ends = mm in (0, RULER_MM)
        tick = RULER_HEIGHT_MM - 2.5 if ends else 4.0 if mm % 10 == 0 else 3.0 if mm % 5 == 0 else 2
        canvas.line(mm, 0.0, mm, tick)
        if mm % 10 == 0:
            size = 2.2
            label = f"{mm} mm" if mm == RULER_MM else str(mm)
            y = RULER_HEIGHT_MM - _CAP_HEIGHT * size if ends else 4.6
            write_text(canvas, (mm, y), label, size, align="centre")
    canvas.restoreState()


def write_pdf(path: Path, content: bytes, force: bool = False) -> None:
    """Write the file atomically; force: replace a file of any kind. Raises CannotCreateError."""
    with OutputFile(path, PDF, force).writing() as partial:
        partial.write_bytes(content)
