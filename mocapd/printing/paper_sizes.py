"""Paper to print on: its sizes, and the size of the ruler that shows the scale."""

from mocapd.errors import ConfigError

# width, height in portrait [mm]; ISO 216 and ANSI/ASME Y14.1
PAPERS_MM = {
    "A4": (210.0, 297.0),
    "Letter": (215.9, 279.4),
    "A3": (297.0, 420.0),
    "A2": (420.0, 594.0),
    "A1": (594.0, 841.0),
}
RULER_MM = 100
RULER_HEIGHT_MM = 8.0

Size = tuple[float, float]


def both_ways_mm(paper: str) -> tuple[Size, Size]:
    """Portrait and landscape. Raises ConfigError."""
    width, height = paper_size_mm(paper)
    return (width, height), (height, width)


def paper_size_mm(paper: str) -> Size:
    """Portrait width and height [mm] by name, in any case. Raises ConfigError for other names."""
    for name, size in PAPERS_MM.items():
        if name.lower() == paper.lower():
            return size
    raise ConfigError(f"no paper {paper!r}", "--paper", f"choose one of {', '.join(PAPERS_MM)}")
