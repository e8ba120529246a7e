"""A PDF as a printer puts it on paper: pages as pixels."""

from dataclasses import dataclass

import numpy as np
import pypdfium2
from numpy.typing import ArrayLike

from mocapd.types import Bytes, Floats

MM_PER_INCH = 25.4


@dataclass(frozen=True)
class Print:
    """`pixels` (H,W,3) uint8 RGB of a page of `size_mm` (2,), of which `px_per_mm` (2,) are across and up."""

    pixels: Bytes
    size_mm: Floats
    px_per_mm: Floats

    def part(self, low_mm: ArrayLike, size_mm: ArrayLike) -> Bytes:
        """What is in a rectangle given by its lower left, from that of the page, and its size."""
        x, y = np.round(np.asarray(low_mm) * self.px_per_mm).astype(int)
        w, h = np.round(np.asarray(size_mm) * self.px_per_mm).astype(int)
        bottom = len(self.pixels) - y
        return self.pixels[bottom - h : bottom, x : x + w]


def printed(pdf: bytes, page: int, px_per_mm: float) -> Print:
    """One page, at about this resolution."""
    document = pypdfium2.PdfDocument(pdf)
    try:
        width_pt, height_pt = document[page].get_size()
        bitmap = document[page].render(scale=px_per_mm * MM_PER_INCH / 72)
        pixels = np.array(bitmap.to_pil().convert("RGB"))
    finally:
        document.close()
    # the page is stretched to whole pixels
    size_mm = np.array([width_pt, height_pt]) * MM_PER_INCH / 72
    return Print(pixels, size_mm, np.array(pixels.shape[1::-1]) / size_mm)


def pages(pdf: bytes) -> int:
    """How many."""
    document = pypdfium2.PdfDocument(pdf)
    count = len(document)
    document.close()
    return count


def text(pdf: bytes, page: int) -> str:
    """The words on one page."""
    document = pypdfium2.PdfDocument(pdf)
    words: str = document[page].get_textpage().get_text_range()
    document.close()
    return words


def keywords(pdf: bytes) -> str:
    """The parameters that the file carries for programs."""
    document = pypdfium2.PdfDocument(pdf)
    words: str = document.get_metadata_dict()["Keywords"]
    document.close()
    return words
