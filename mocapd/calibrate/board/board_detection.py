"""Finds the corners of a calibration board in a picture."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.calibration.board_spec import BoardKind, BoardSpec, aruco_board, first_markers
from mocapd.errors import ConfigError
from mocapd.types import Bytes, Floats, Ints, Singles

_MARKERS = 250  # of a dictionary: no portable board has more
_PLENTY = 0.6  # share of the corners that needs no second search
_ENLARGED_UP_TO_PX = 800  # width of a picture that is enlarged; a larger one takes too long
FEWEST_CORNERS = 6  # in one picture; 4 fix the pose of a plane, the rest check it


class Reason(StrEnum):
    """Why a picture has no usable board, in the user's words."""

    TOO_DARK = "the picture is too dark"
    BLURRED = "the picture is blurred"
    FEW = "too little of the board is in sight"
    OTHER_SIZE = "the board has another size than the one given"
    OTHER_DICTIONARY = "the markers are of another dictionary"
    OTHER_KIND = "the board is of another kind"
    MIRRORED = "the picture is mirrored"
    NOTHING = "no board in the picture"


@dataclass(frozen=True, slots=True, eq=False)
class BoardView:
    """The board in one picture: ids (n,) of corners, corners_px (n,2), ascending by id.

    `sharpness` is the rise of the steepest edges, in parts of the contrast per pixel. `back`: the view is of
    the back of a two-sided board, whose markers are mirrored.
    """

    index: int
    ids: Ints
    corners_px: Floats
    sharpness: float
    back: bool = False


@dataclass(frozen=True, slots=True)
class DetectionFailure:
    """No usable board in this picture. `detail`: what the picture shows instead; `markers`: how many of any dictionary."""

    reason: Reason
    detail: str = ""
    markers: int = 0


class BoardDetector:
    """Finds one kind of board. Not thread-safe."""

    def __init__(self, spec: BoardSpec) -> None:
        self.spec = spec
        self._charuco: Any = None
        self._charuco_enlarged: Any = None
        if spec.kind is BoardKind.CHARUCO:
            board = aruco_board(spec, own_markers=True)
            self._charuco = cv2.aruco.CharucoDetector(board)
            self._charuco_enlarged = cv2.aruco.CharucoDetector(
                board, cv2.aruco.CharucoParameters(), _for_small_markers()
            )

    def find(self, pixels: Bytes, index: int = 0) -> BoardView | None:
        """The board in a picture (h,w,3) BGR or (h,w) grey; None where too few corners are visible.

        Raises ConfigError when OpenCV does not support such a board.
        """
        grey = self.as_printed(pixels)
        back = False
        try:
            corners = self._of_chessboard(grey) if self._charuco is None else self._of_charuco(grey)
            if self.spec.two_sided and self._few(corners):
                mirrored = self._of_charuco(mirror_image(grey))
                back = mirrored is not None and (
                    corners is None or len(mirrored[0]) > len(corners[0])
                )
                corners = mirrored if back else corners
        except cv2.error as error:
            raise ConfigError(
                f"OpenCV cannot look for a {self.spec} in a picture of"
                f" {grey.shape[1]}x{grey.shape[0]} ({error.err})",
                "the board",
                "give another board, or pictures of another size",
            ) from None
        if corners is None:
            return None
        ids, corners_px = corners
        if back:
            corners_px = corners_px * [-1.0, 1.0] + [grey.shape[1] - 1.0, 0.0]
        if len(ids) < FEWEST_CORNERS or _on_a_line(corners_px):
            return None
        return BoardView(index, ids, corners_px, edge_sharpness(grey, corners_px), back)

    def as_printed(self, pixels: Bytes) -> Bytes:
        """The picture in grey, dark on light for an inverted board, too."""
        grey = as_grey(pixels)
        return 255 - grey if self.spec.inverted else grey

    def markers(self, grey: Bytes) -> Ints:
        """Ids of the visible markers, of any board; of the first 250."""
        if self._charuco is None:
            return np.zeros(0, np.int64)
        dictionary = first_markers(self.spec.dictionary, _MARKERS)
        ids: Any = cv2.aruco.ArucoDetector(dictionary).detectMarkers(grey)[1]
        return np.zeros(0, np.int64) if ids is None else np.sort(ids.ravel()).astype(np.int64)

    def _of_charuco(self, grey: Bytes) -> tuple[Ints, Floats] | None:
        """Searches an enlarged picture for a far board: with cells of 2 px that finds four times the corners."""
        corners, ids, _, markers = self._charuco.detectBoard(grey)
        result = None if ids is None else _ascending(corners, ids)
        if markers is None or not self._few(result) or grey.shape[1] > _ENLARGED_UP_TO_PX:
            return result
        large = cv2.resize(grey, None, fx=2.0, fy=2.0, interpolation=cv2.INTER_CUBIC)
        corners, ids, _, _ = self._charuco_enlarged.detectBoard(large)
        if ids is None or (result is not None and len(ids) <= len(result[0])):
            return result
        # pixel centres are at integers in both pictures
        return _ascending((corners + 0.5) / 2.0 - 0.5, ids)

    def _few(self, corners: tuple[Ints, Floats] | None) -> bool:
        columns, rows = self.spec.grid
        return corners is None or len(corners[0]) < _PLENTY * columns * rows

    def _of_chessboard(self, grey: Bytes) -> tuple[Ints, Floats] | None:
        columns, rows = self.spec.grid
        # a part of a larger board looks like the board itself: CALIB_CB_LARGER finds the whole of it
        flags = cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER
        is_found, corners, squares = cv2.findChessboardCornersSBWithMeta(
            grey, (columns, rows), flags=flags
        )
        if not is_found or squares.shape != (rows, columns):
            return None
        corners_px = corners.reshape(-1, 2).astype(float)
        # OpenCV numbers the corners from either end. The first square is black, which identifies the
        # end where the numbers of columns and rows are not both even or both odd.
        if self.spec.turns_show and not _first_is_black(grey, corners_px.reshape(rows, columns, 2)):
            corners_px = corners_px[::-1].copy()
        return np.arange(rows * columns), corners_px


def _ascending(corners: Floats, ids: Ints) -> tuple[Ints, Floats]:
    order = np.argsort(ids.ravel())
    return ids.ravel()[order].astype(np.int64), corners.reshape(-1, 2)[order].astype(float)


def _for_small_markers() -> Any:
    """Tolerates rounder borders and more wrong bits: the dictionary has only the board's own markers."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeStep = 4
    parameters.polygonalApproxAccuracyRate = 0.08
    parameters.errorCorrectionRate = 1.0
    parameters.perspectiveRemovePixelPerCell = 8
    return parameters


def mirror_image(grey: Bytes) -> Bytes:
    """The mirror image of a picture (h,w), left and right exchanged."""
    return np.ascontiguousarray(grey[:, ::-1])


def as_grey(pixels: Bytes) -> Bytes:
    """(h,w) of a picture (h,w,3) BGR, or of one that is grey already."""
    if pixels.ndim == 2:
        return pixels
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY).astype(np.uint8, copy=False)


def edge_sharpness(grey: Bytes, corners_px: Floats) -> float:
    """The rise of the steepest edges within the corners' box, in parts of the contrast per pixel.

    About 0.5 for the sharpest picture a lens gives, 0.1 for one in which edges are ten pixels
    wide; independent of the board's size in the picture and of the light. 0 without contrast.
    """
    height, width = grey.shape
    low = np.floor(np.maximum(corners_px.min(axis=0), 0)).astype(int)
    high = np.ceil(np.minimum(corners_px.max(axis=0), (width - 1, height - 1))).astype(int) + 1
    part = grey[low[1] : high[1], low[0] : high[0]].astype(np.float32)
    if min(part.shape) < 4:
        return 0.0
    dark, light = np.percentile(part, (5, 95))
    if light - dark < 8.0:
        return 0.0
    return float(np.percentile(edge_rise(part), 98) / (light - dark))


def edge_rise(picture: Singles) -> Singles:
    """(h,w): the rise of the grey values of a picture (h,w) per pixel."""
    gx = cv2.Scharr(picture, cv2.CV_32F, 1, 0) / 32.0
    gy = cv2.Scharr(picture, cv2.CV_32F, 0, 1) / 32.0
    return np.asarray(np.hypot(gx, gy), dtype=np.float32)


def _on_a_line(corners_px: Floats) -> bool:
    spread = np.linalg.svd(corners_px - corners_px.mean(axis=0), compute_uv=False)
    return bool(spread[1] < 0.05 * spread[0])


def _first_is_black(grey: Bytes, corners_px: Floats) -> bool:
    """Whether the squares with the colour of the very first one are dark."""
    middles = 0.25 * (
        corners_px[:-1, :-1] + corners_px[1:, :-1] + corners_px[:-1, 1:] + corners_px[1:, 1:]
    )
    x, y = np.moveaxis(np.round(middles).astype(int), -1, 0)
    values = grey[np.clip(y, 0, grey.shape[0] - 1), np.clip(x, 0, grey.shape[1] - 1)]
    # the square between the first four inner corners is diagonal to the very first: same colour
    same = np.indices(values.shape).sum(axis=0) % 2 == 0
    return bool(values[same].mean() < values[~same].mean())


def settle_variant(spec: BoardSpec, pictures: Sequence[Bytes]) -> BoardSpec:
    """The spec, or its inverted or other layout where the pictures show that board instead.

    Unchanged when any picture shows the board of the spec, and when none shows any variant.
    """
    variants = [replace(spec, inverted=i, legacy=spec.legacy) for i in _first(spec.inverted)]
    if spec.kind is BoardKind.CHARUCO and spec.rows % 2 == 0:
        variants = [replace(v, legacy=legacy) for legacy in _first(spec.legacy) for v in variants]
    given = BoardDetector(spec)
    if any(given.find(picture) is not None for picture in pictures):
        return spec
    counts = [0]
    for variant in variants[1:]:
        detector = BoardDetector(variant)
        views = [detector.find(picture) for picture in pictures]
        counts.append(sum(len(view.ids) for view in views if view is not None))
    return variants[int(np.argmax(counts))]


def _first(given: bool) -> tuple[bool, bool]:
    return given, not given
