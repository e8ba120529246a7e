"""Why no board is found in a picture: asked only of pictures without one, since it looks long."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.calibrate.board.board_detection import (
    BoardDetector,
    DetectionFailure,
    Reason,
    as_grey,
    flipped,
)
from mocapd.calibration.board_spec import BoardKind, BoardSpec, dictionaries, first_markers
from mocapd.errors import ConfigError
from mocapd.types import Bytes, Ints

_DARK = 45  # grey value under which all but the lamps of a dark picture lie
_SHARP = 25.0  # variance of the Laplacian of a picture of 640 pixels across, whose noise is gone
_BEGINNING = 50  # markers of another dictionary that are looked for: boards begin with the first
_CERTAIN = 3  # markers that are not there by chance

# what to do about each; of recordings
FIX: Mapping[Reason, str] = {
    Reason.TOO_DARK: "add light, or lengthen the exposure",
    Reason.BLURRED: "focus the camera, hold the board still",
    Reason.FEW: "show the whole board, nearer",
    Reason.OTHER_SIZE: "give --board-size as columns x rows of squares",
    Reason.OTHER_DICTIONARY: "give the --dictionary that the board was printed with",
    Reason.MIRRORED: "switch mirroring off in the camera or the recorder, and record again; if it is the "
    "mirrored back of a board that is printed on both sides, give --two-sided",
    Reason.NOTHING: "show the board to this camera, or take its recording out of the folder",
}


def diagnose_detection(detector: BoardDetector, pixels: Bytes, index: int = 0) -> DetectionFailure:
    """The reason why `detector` finds no board in this picture, the likeliest first."""
    grey = detector.as_printed(pixels)
    lit = as_grey(pixels)
    if np.percentile(lit, 98) < _DARK:
        return DetectionFailure(index, Reason.TOO_DARK)
    spec = detector.spec
    if spec.kind is BoardKind.CHARUCO:
        told = _of_markers(detector, grey, index)
    else:
        told = _of_squares(spec, grey, index)
    if told is not None:
        return told
    small = cv2.resize(lit, (640, max(1, round(640 * lit.shape[0] / lit.shape[1]))))
    fine = cv2.Laplacian(cv2.GaussianBlur(small, (0, 0), 1.0), cv2.CV_32F)
    if float(fine.var()) < _SHARP:
        return DetectionFailure(index, Reason.BLURRED)
    return DetectionFailure(index, Reason.NOTHING)


def _of_markers(detector: BoardDetector, grey: Bytes, index: int) -> DetectionFailure | None:
    spec = detector.spec
    ids = detector.markers(grey)
    on_board = spec.columns * spec.rows // 2
    if spec.two_sided:
        grey, ids = _clearer_side(detector, grey, ids)
    # first, since a mirrored marker may well be another marker of a large dictionary
    elif detector.find(grey_of(spec, flipped(grey))) is not None:
        return DetectionFailure(index, Reason.MIRRORED)
    if len(ids) >= _CERTAIN:
        foreign = ids[ids >= on_board]
        if len(foreign):
            detail = f"marker {foreign[-1]} is seen; {spec} has markers 0 to {on_board - 1}"
            return DetectionFailure(index, Reason.OTHER_SIZE, detail)
        return _misfit(spec, ids, grey, index)
    other = _other_dictionary(spec, grey, index)
    if other is None and len(ids):
        return DetectionFailure(index, Reason.FEW, f"{len(ids)} of {on_board} markers")
    return other


def _clearer_side(detector: BoardDetector, grey: Bytes, ids: Ints) -> tuple[Bytes, Ints]:
    """The picture and its markers, or its mirror image and its where there are more: the back is seen."""
    mirrored = flipped(grey)
    others = detector.markers(mirrored)
    return (mirrored, others) if len(others) > len(ids) else (grey, ids)


def _misfit(spec: BoardSpec, ids: Ints, grey: Bytes, index: int) -> DetectionFailure:
    """Known markers in sight and no corners: too few of them, or in other places than given."""
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
        if _shows(_resized(spec, columns, rows), grey):
            detail = f"it fits rows of {columns} squares, {spec.columns}x{spec.rows} was given"
            return DetectionFailure(index, Reason.OTHER_SIZE, detail)
    return DetectionFailure(
        index, Reason.FEW, f"{len(ids)} of {spec.columns * spec.rows // 2} markers"
    )


def _resized(spec: BoardSpec, columns: int, rows: int) -> BoardSpec | None:
    """The board with so many squares; None when there is none, as with more than its dictionary has
    markers for."""
    try:
        return replace(spec, columns=columns, rows=rows)
    except ConfigError:
        return None


def _shows(spec: BoardSpec | None, as_printed: Bytes) -> bool:
    if spec is None:
        return False
    return BoardDetector(spec).find(grey_of(spec, as_printed)) is not None


def grey_of(spec: BoardSpec, as_printed: Bytes) -> Bytes:
    """What `BoardDetector.as_printed` was made of."""
    return 255 - as_printed if spec.inverted else as_printed


def _other_dictionary(spec: BoardSpec, grey: Bytes, index: int) -> DetectionFailure | None:
    """The family of dictionaries with the most markers in sight."""
    best, name = 0, ""
    for one in dictionaries():
        # DICT_5X5_50 and so on are the beginnings of DICT_5X5_1000
        family = one.rpartition("_")[0]
        if one.endswith(("_50", "_100", "_250")) or spec.dictionary.startswith(family + "_"):
            continue
        beginning = first_markers(one, _BEGINNING)
        ids: Any = cv2.aruco.ArucoDetector(beginning).detectMarkers(grey)[1]
        if ids is not None and len(ids) > best:
            best, name = len(ids), one
    if best < _CERTAIN:
        return None
    return DetectionFailure(index, Reason.OTHER_DICTIONARY, f"{best} markers of {name}")


def _of_squares(spec: BoardSpec, grey: Bytes, index: int) -> DetectionFailure | None:
    """A plain board of another size: turned, or its inner corners counted in place of squares."""
    c, r = spec.columns, spec.rows
    others = [(r, c), (c + 1, r + 1), (c - 1, r - 1), (r + 1, c + 1), (r - 1, c - 1)]
    others += [(c + 1, r), (c, r + 1), (c - 1, r), (c, r - 1)]
    for columns, rows in dict.fromkeys(others):
        if {columns, rows} != {c, r} and _shows(_resized(spec, columns, rows), grey):
            detail = f"{columns}x{rows} squares are seen, {c}x{r} were given (squares, not corners)"
            return DetectionFailure(index, Reason.OTHER_SIZE, detail)
    return None
