"""Diagnoses why a picture shows no board. Slow, so only for pictures without one."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.calibrate.board.board_detection import (
    BoardDetector,
    DetectionFailure,
    Reason,
    as_grey,
    edge_rise,
    mirror_image,
)
from mocapd.calibration.board_spec import BoardKind, BoardSpec, dictionaries, first_markers
from mocapd.errors import ConfigError
from mocapd.types import Bytes, Ints

_DARK = 45  # grey value; in a dark picture all but the lamps lie below it
_SHARP = 0.12  # rise of edges in focus, of the contrast per pixel, of pictures of 640 pixels across
_CONTRAST = 15.0  # grey values between light and dark; with less, the focus cannot be judged
_BEGINNING = 50  # markers of another dictionary to search for: boards begin with the first
_SQUARES_PX = 480  # width of a picture in a search for plain chessboards, which is slow
_CERTAIN = 3  # markers; fewer may be chance

# remedies; for recordings
FIX: Mapping[Reason, str] = {
    Reason.TOO_DARK: "add light, or lengthen the exposure",
    Reason.BLURRED: "focus the camera, hold the board still",
    Reason.FEW: "show the whole board, nearer",
    Reason.OTHER_SIZE: "give --board-size as columns x rows of squares",
    Reason.OTHER_DICTIONARY: "give the --dictionary that the board was printed with",
    Reason.OTHER_KIND: "give the --board that it is, charuco or chessboard",
    Reason.MIRRORED: "switch mirroring off in the camera or the recorder, and record again; if it is the "
    "mirrored back of a board that is printed on both sides, give --two-sided",
    Reason.NOTHING: "show the board to this camera, or take its recording out of the folder",
}


# Reasons that name another object in the picture: one such picture says more than many without a board.
TELLING = frozenset(
    {Reason.OTHER_SIZE, Reason.OTHER_DICTIONARY, Reason.OTHER_KIND, Reason.MIRRORED}
)


def most_telling(failures: Sequence[DetectionFailure]) -> DetectionFailure:
    """The failure to report of several pictures: one that shows something outranks an empty one, then the commonest.

    Of the failures with that reason the one with the most visible markers, of these the first.
    """
    counts = Counter(failure.reason for failure in failures)

    def rank(one: DetectionFailure) -> tuple[int, int, int]:
        is_part = one.reason is Reason.FEW and one.markers >= _CERTAIN
        level = 2 if one.reason in TELLING else int(is_part)
        return level, counts[one.reason], one.markers

    return max(failures, key=rank)


def diagnose_detection(detector: BoardDetector, pixels: Bytes) -> DetectionFailure:
    """The likeliest reason why `detector` finds no board in this picture."""
    grey = detector.as_printed(pixels)
    lit = as_grey(pixels)
    if np.percentile(lit, 98) < _DARK:
        return DetectionFailure(Reason.TOO_DARK)
    if detector.spec.kind is BoardKind.CHARUCO:
        failure = _of_markers(detector, grey)
    else:
        failure = _of_squares(detector.spec, grey)
    if failure is not None:
        return failure
    return DetectionFailure(Reason.BLURRED if _is_blurred(lit) else Reason.NOTHING)


def _is_blurred(lit: Bytes) -> bool:
    """Whether the steepest edges of a picture are flat; False for a picture without contrast, which has no edges."""
    smooth = cv2.GaussianBlur(downscale(lit, 640), (0, 0), 0.8).astype(np.float32)
    low, high = np.percentile(smooth, (1, 99))
    if high - low < _CONTRAST:
        return False
    return float(np.percentile(edge_rise(smooth), 99.9)) < _SHARP * float(high - low)


def _of_markers(detector: BoardDetector, grey: Bytes) -> DetectionFailure | None:
    spec = detector.spec
    ids = detector.markers(grey)
    if spec.two_sided:
        mirrored = mirror_image(grey)
        others = detector.markers(mirrored)
        if len(others) > len(ids):  # a view of the back
            grey, ids = mirrored, others
    # first, since a mirrored marker may well be another marker of a large dictionary
    elif _is_mirrored(detector, grey, len(ids)):
        return DetectionFailure(Reason.MIRRORED)
    if len(ids) >= _CERTAIN:
        return _of_own_markers(spec, ids, grey)
    swapped = BoardDetector(replace(spec, inverted=not spec.inverted))
    swapped_ids = swapped.markers(255 - grey)
    if len(swapped_ids) >= _CERTAIN:
        failure = _of_own_markers(swapped.spec, swapped_ids, 255 - grey)
        ink = "light on dark" if swapped.spec.inverted else "dark on light"
        return replace(failure, detail=f"{failure.detail}, printed {ink}")
    other = _other_dictionary(spec, grey) or _other_kind(spec, grey)
    return _few(spec, ids) if other is None and len(ids) else other


def _is_mirrored(detector: BoardDetector, grey: Bytes, markers: int) -> bool:
    """Whether the mirror image shows the board, or twice as many of its dictionary's markers."""
    mirrored = mirror_image(grey)
    if detector.find(grey_of(detector.spec, mirrored)) is not None:
        return True
    return len(detector.markers(mirrored)) >= max(_CERTAIN, 2 * markers + 1)


def _of_own_markers(spec: BoardSpec, ids: Ints, grey: Bytes) -> DetectionFailure:
    """For visible markers of the right dictionary: a larger board, another one, or too few markers."""
    on_board = spec.columns * spec.rows // 2
    foreign = ids[ids >= on_board]
    if len(foreign) > 1:  # a single one may be chance
        detail = f"marker {foreign[-1]} is seen; {spec} has markers 0 to {on_board - 1}"
        return DetectionFailure(Reason.OTHER_SIZE, detail, len(ids))
    return _misfit(spec, ids, grey)


def _few(spec: BoardSpec, ids: Ints) -> DetectionFailure:
    detail = f"{len(ids)} of {spec.columns * spec.rows // 2} markers"
    return DetectionFailure(Reason.FEW, detail, len(ids))


def _misfit(spec: BoardSpec, ids: Ints, grey: Bytes) -> DetectionFailure:
    """For visible markers of the board without corners: too few of them, or another layout than given."""
    sizes = [
        (columns, rows)
        for columns in range(3, 16)
        for rows in range(3, 16)
        if (columns, rows) != (spec.columns, spec.rows)
        and columns * rows // 2 > ids[-1]
        # of boards with rows of one length the longer holds the shorter: one of them is enough
        and rows == max(3, -(-2 * (int(ids[-1]) + 1) // columns))
    ]
    for columns, rows in sizes:
        if _shows(_board_of_size(spec, columns, rows), grey):
            detail = f"it fits rows of {columns} squares, {spec.columns}x{spec.rows} was given"
            return DetectionFailure(Reason.OTHER_SIZE, detail, len(ids))
    return _few(spec, ids)


def _board_of_size(
    spec: BoardSpec, columns: int, rows: int, kind: BoardKind | None = None
) -> BoardSpec | None:
    """The board with so many squares; None for an impossible one, such as with more squares than its dictionary
    has markers for."""
    try:
        return replace(spec, columns=columns, rows=rows, kind=kind or spec.kind)
    except ConfigError:
        return None


def _shows(spec: BoardSpec | None, as_printed: Bytes) -> bool:
    if spec is None:
        return False
    return BoardDetector(spec).find(grey_of(spec, as_printed)) is not None


def grey_of(spec: BoardSpec, as_printed: Bytes) -> Bytes:
    """The inverse of `BoardDetector.as_printed`."""
    return 255 - as_printed if spec.inverted else as_printed


def _other_dictionary(spec: BoardSpec, grey: Bytes) -> DetectionFailure | None:
    """The family of dictionaries with the most visible markers, dark on light or light on dark."""
    best = _most_markers(grey, _family(spec.dictionary))
    if best is None:
        return None
    count, name = best
    return DetectionFailure(Reason.OTHER_DICTIONARY, f"{count} markers of {name}", count)


def _most_markers(grey: Bytes, left_out: str = "") -> tuple[int, str] | None:
    """The number of markers, and the name, of the dictionary family with the most; None for too few."""
    names = [name for name in _families() if _family(name) != left_out]
    candidates: Any = [first_markers(name, _BEGINNING) for name in names]
    detector = cv2.aruco.ArucoDetector(candidates)
    for picture in (grey, 255 - grey):
        which: Any = detector.detectMarkersMultiDict(picture)[3]
        if which is not None and len(which) >= _CERTAIN:
            counts = np.bincount(np.ravel(which), minlength=len(names))
            best = int(counts.argmax())
            if counts[best] >= _CERTAIN:
                return int(counts[best]), names[best]
    return None


@cache
def _families() -> tuple[str, ...]:
    """The largest dictionary of each family, which contains the others of it."""
    return tuple({_family(name): name for name in dictionaries()}.values())


def _family(name: str) -> str:
    return re.sub(r"_(50|100|250|1000)$", "", name.lower())


def _other_kind(spec: BoardSpec, grey: Bytes) -> DetectionFailure | None:
    """A chessboard in place of the ChArUco board of so many squares."""
    plain, small = replace(spec, two_sided=False), downscale(grey, _SQUARES_PX)
    for columns, rows in ((spec.columns, spec.rows), (spec.rows, spec.columns)):
        if _shows_squares(_board_of_size(plain, columns, rows, BoardKind.CHESSBOARD), small):
            detail = f"a plain chessboard of {columns}x{rows} squares, without markers"
            return DetectionFailure(Reason.OTHER_KIND, detail)
    return None


def _of_squares(spec: BoardSpec, grey: Bytes) -> DetectionFailure | None:
    """A board with markers, or a plain one of another size: turned, or its inner corners counted."""
    markers = _most_markers(grey)
    if markers is not None:
        count, name = markers
        detail = f"a ChArUco board with {count} markers of {name}"
        return DetectionFailure(Reason.OTHER_KIND, detail, count)
    c, r = spec.columns, spec.rows
    others = [(r, c), (c + 1, r + 1), (c - 1, r - 1), (r + 1, c + 1), (r - 1, c - 1)]
    others += [(c + 1, r), (c, r + 1), (c - 1, r), (c, r - 1)]
    small = downscale(grey, _SQUARES_PX)
    for columns, rows in dict.fromkeys(others):
        if {columns, rows} != {c, r} and _shows_squares(_board_of_size(spec, columns, rows), small):
            detail = f"{columns}x{rows} squares are seen, {c}x{r} were given (squares, not corners)"
            return DetectionFailure(Reason.OTHER_SIZE, detail)
    return None


def _shows_squares(spec: BoardSpec | None, as_printed: Bytes) -> bool:
    """As `_shows`, for a chessboard; a quick test that takes a hundredth of the time comes first."""
    return (
        spec is not None
        and bool(cv2.checkChessboard(as_printed, spec.grid))
        and _shows(spec, as_printed)
    )


def downscale(picture: Bytes, width_px: int) -> Bytes:
    """The picture, at most this wide."""
    height, width = picture.shape[:2]
    if width <= width_px:
        return picture
    size = (width_px, max(1, round(height * width_px / width)))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
