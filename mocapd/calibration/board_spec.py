"""The calibration board: what is printed on it, and where its inner corners are."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.boundary.numbers import brief, whole_number_of_text
from mocapd.errors import ConfigError, MalformedError
from mocapd.types import Floats

_WHERE = "the board"
MOST_SQUARES = 100  # in each direction: no print and no camera shows more
LARGEST_SQUARE_M = 1.0
SMALLEST_SQUARE_M = 0.001


class BoardKind(StrEnum):
    """`charuco`: a chessboard with markers in its white squares; `chessboard`: a plain one."""

    CHARUCO = "charuco"
    CHESSBOARD = "chessboard"


# in each direction: fewer have not the corners that fix a pose; OpenCV finds no plain chessboard
# with fewer than three inner corners, which it says by raising
FEWEST_SQUARES: Mapping[BoardKind, int] = {BoardKind.CHARUCO: 3, BoardKind.CHESSBOARD: 4}


@dataclass(frozen=True, slots=True)
class BoardSpec:
    """The printed pattern of a board. Raises ConfigError for an impossible one.

    `columns` and `rows` count squares, not inner corners. Only ChArUco uses `marker_m` and `dictionary`.
    `inverted`: white where other boards are black. `legacy`: the layout of OpenCV before 4.6, which
    differs where `rows` is even. `two_sided`: the back bears the mirror image, so each corner has the
    same place on both sides.

    The board's frame, viewed from the printed side (two-sided: from the side that is not mirrored):
    x right along a row, y down, z into the board, origin at the outer corner of the first square [m].
    """

    kind: BoardKind
    columns: int
    rows: int
    square_m: float
    marker_m: float = 0.0
    dictionary: str = "DICT_4X4_1000"
    inverted: bool = False
    legacy: bool = False
    two_sided: bool = False

    def __post_init__(self) -> None:
        fewest = FEWEST_SQUARES[self.kind]
        if not all(fewest <= count <= MOST_SQUARES for count in (self.columns, self.rows)):
            too = "few" if min(self.columns, self.rows) < fewest else "many"
            raise ConfigError(
                f"{brief(self.columns)}x{brief(self.rows)} squares are too {too}",
                _WHERE,
                f"give columns x rows of squares, at least {fewest} and at most {MOST_SQUARES} each",
            )
        if not SMALLEST_SQUARE_M <= self.square_m < LARGEST_SQUARE_M:
            raise ConfigError(
                f"a square of {self.square_m:g} m",
                _WHERE,
                "give the side of one square in metres, as measured with a ruler",
            )
        if self.dictionary not in dictionaries():
            raise ConfigError(
                f"no marker dictionary {brief(self.dictionary)}",
                _WHERE,
                "one of " + ", ".join(dictionaries()),
            )
        if self.kind is BoardKind.CHESSBOARD:
            if self.two_sided:
                raise ConfigError(
                    "a plain chessboard looks the same from both sides",
                    _WHERE,
                    "take a ChArUco board, whose markers distinguish front from back",
                )
            if not 0.0 <= self.marker_m < LARGEST_SQUARE_M:  # not used, but stored
                raise ConfigError(
                    f"a marker of {self.marker_m:g} m", _WHERE, "leave it out for a chessboard"
                )
            return
        # OpenCV computes in single precision, and raises where they are the same there
        in_square = np.float32(self.marker_m) < np.float32(self.square_m)
        if not (self.marker_m >= 0.5 * SMALLEST_SQUARE_M and in_square):
            raise ConfigError(
                f"a marker of {self.marker_m:g} m in a square of {self.square_m:g} m",
                _WHERE,
                "give the side of a marker in metres; it is smaller than the square",
            )
        available = len(_dictionary(self.dictionary).bytesList)
        if available < self.columns * self.rows // 2:
            raise ConfigError(
                f"{self.dictionary} has {available} markers, a board of {self.columns}x{self.rows} "
                f"squares needs {self.columns * self.rows // 2}",
                _WHERE,
                "give the dictionary that the board was printed with",
            )

    @property
    def grid(self) -> tuple[int, int]:
        """Inner corners along a row and along a column."""
        return self.columns - 1, self.rows - 1

    @property
    def turns_show(self) -> bool:
        """Whether a half turn of the board changes its pattern."""
        return self.kind is BoardKind.CHARUCO or (self.columns + self.rows) % 2 == 1

    def __str__(self) -> str:
        return f"{self.kind} of {self.columns}x{self.rows} squares"


def board_size(text: str) -> tuple[int, int]:
    """`4x5` as (4, 5): columns and rows of squares. Raises ConfigError."""
    columns, _, rows = text.lower().partition("x")
    try:
        return (
            whole_number_of_text(columns, 0, MOST_SQUARES),
            whole_number_of_text(rows, 0, MOST_SQUARES),
        )
    except MalformedError as error:
        raise ConfigError(
            f"the board size {brief(text)}: {error}",
            _WHERE,
            f"write columns x rows, as 4x5, up to {MOST_SQUARES} each",
        ) from None


@cache
def dictionaries() -> tuple[str, ...]:
    """Names of the marker dictionaries that OpenCV knows, small ones first."""
    names = (name for name in dir(cv2.aruco) if name.startswith("DICT_"))
    return tuple(sorted(names, key=lambda name: (len(_dictionary(name).bytesList), name)))


def _dictionary(name: str) -> Any:
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))


def corners_m(spec: BoardSpec) -> Floats:
    """The inner corners (n,3) in the board's frame [m], row by row as OpenCV numbers them."""
    columns, rows = spec.grid
    y, x = np.mgrid[1 : rows + 1, 1 : columns + 1]
    grid = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return grid * spec.square_m


def centre_m(spec: BoardSpec) -> Floats:
    """The middle of the board (3,) in its frame [m]."""
    return 0.5 * spec.square_m * np.array([spec.columns, spec.rows, 0.0])


def aruco_board(spec: BoardSpec, own_markers: bool = False) -> Any:
    """The board as cv2.aruco has it.

    With `own_markers` the dictionary ends with the board's last marker: the detector then ignores
    markers of other boards, and takes a tenth of the time that a dictionary of 1000 takes.
    """
    dictionary = _dictionary(spec.dictionary)
    if own_markers:
        dictionary = first_markers(spec.dictionary, spec.columns * spec.rows // 2)
    board = cv2.aruco.CharucoBoard(
        (spec.columns, spec.rows), spec.square_m, spec.marker_m, dictionary
    )
    board.setLegacyPattern(spec.legacy)
    return board


def first_markers(name: str, count: int) -> Any:
    """The beginning of a dictionary of cv2.aruco: the time of a search grows with its length."""
    whole = _dictionary(name)
    return cv2.aruco.Dictionary(
        whole.bytesList[:count].copy(), whole.markerSize, whole.maxCorrectionBits
    )
