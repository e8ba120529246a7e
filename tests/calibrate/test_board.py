"""What may be printed on a board, and what is seen of it in a picture."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import cv2
import numpy as np
import pytest

from mocapd.calibrate.board.board_detection import BoardDetector, Reason, settle_variant
from mocapd.calibrate.board.detection_diagnostics import diagnose_detection
from mocapd.calibration.board_spec import BoardKind, BoardSpec, aruco_board, board_size, corners_m
from mocapd.errors import ConfigError
from mocapd.sim.board.board_picture import BoardFilm, BoardLight, PrintedBoard, print_picture
from mocapd.types import Bytes
from tests.calibrate.board_scenes import PRINT, cameras, corners_px, held_poses

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052)
CHESS = BoardSpec(BoardKind.CHESSBOARD, 5, 6, 0.07)
(CAMERA,) = cameras(1)
POSE = held_poses(3)[1]


@cache
def film(board: PrintedBoard) -> BoardFilm:
    return BoardFilm(CAMERA, board)


def picture(board: PrintedBoard = PRINT, light: BoardLight | None = None) -> Bytes:
    return film(board).picture(*POSE, light)


def mirrored() -> Bytes:
    return picture()[:, ::-1].copy()


@pytest.mark.parametrize(
    "change",
    [
        {"columns": 2},
        {"columns": 20000, "rows": 20000},
        {"rows": 10**5000},
        {"square_m": 0.0},
        {"square_m": 54.0},
        {"square_m": 1e-300, "marker_m": 1e-301},
        {"square_m": float("nan")},
        {"marker_m": float("nan")},
        {"marker_m": 0.07 * (1.0 - 1e-12)},  # not smaller as OpenCV computes
        {"marker_m": 0.08},
        {"dictionary": "DICT_9X9"},
        {"columns": 12, "rows": 12, "dictionary": "DICT_4X4_50"},
    ],
)
def test_a_board_that_cannot_be_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match=" -- "):
        replace(SPEC, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "change",
    [
        {"columns": 3},
        {"rows": 3},
        {"columns": 101},
        {"columns": 20000, "rows": 20000},
        {"marker_m": float("inf")},
    ],
)
def test_a_chessboard_that_opencv_does_not_find_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match=" -- "):
        replace(CHESS, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize("size_px", [(3, 5), (16, 16), (1000, 16), (640, 480)])
@pytest.mark.parametrize(
    "spec",
    [
        replace(CHESS, columns=4, rows=4),
        replace(CHESS, columns=100, rows=100),
        replace(SPEC, columns=3, rows=3),
        replace(SPEC, columns=3, rows=100, square_m=0.001, marker_m=0.0005),
        replace(SPEC, columns=44, rows=45, marker_m=0.0699),
    ],
    ids=str,
)
def test_every_board_that_is_taken_can_be_looked_for(
    spec: BoardSpec, size_px: tuple[int, int]
) -> None:
    empty = np.full(size_px[::-1], 128, np.uint8)
    assert BoardDetector(spec).find(empty) is None


@pytest.mark.parametrize(
    "spec", [replace(CHESS, columns=4, rows=4), replace(SPEC, dictionary="DICT_4X4_50")], ids=str
)
def test_why_a_board_is_not_seen_is_told_of_boards_at_the_limits(spec: BoardSpec) -> None:
    """Its neighbours in size, which are tried too, cannot all be printed."""
    told = diagnose_detection(BoardDetector(spec), picture())
    assert told.reason in (
        Reason.NOTHING,
        Reason.OTHER_SIZE,
        Reason.OTHER_KIND,
        Reason.FEW,
    )


def test_the_size_is_columns_by_rows() -> None:
    assert board_size("4x5") == (4, 5)
    for text in ("4", "4x", "x5", "-4x5", "4x5x6", "4x101", "9" * 5000 + "x5", "\u0664x5"):
        with pytest.raises(ConfigError):
            board_size(text)


@pytest.mark.parametrize("legacy", [False, True])
@pytest.mark.parametrize(("columns", "rows"), [(4, 5), (5, 4), (6, 8)])
def test_the_simulated_print_is_the_board_as_others_print_it(
    columns: int, rows: int, legacy: bool
) -> None:
    spec = replace(SPEC, columns=columns, rows=rows, marker_m=0.0525, legacy=legacy)
    theirs = aruco_board(spec).generateImage((columns * 24, rows * 24), marginSize=0)
    ours = print_picture(PrintedBoard(columns, rows, 0.07, 0.0525, spec.dictionary, legacy=legacy))
    np.testing.assert_array_equal(ours > 0, theirs > 0)


def test_corners_are_numbered_as_opencv_numbers_them() -> None:
    np.testing.assert_allclose(corners_m(SPEC), aruco_board(SPEC).getChessboardCorners(), atol=1e-6)


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize("spec", [SPEC, CHESS])
def test_corners_are_found_where_they_are(spec: BoardSpec, inverted: bool) -> None:
    dictionary = PRINT.dictionary if spec is SPEC else ""
    board = replace(PRINT, inverted=inverted, dictionary=dictionary)
    view = BoardDetector(replace(spec, inverted=inverted)).find(picture(board))
    assert view is not None
    assert len(view.ids) >= 15
    true_px = corners_px(CAMERA, corners_m(spec), POSE)[view.ids]
    assert np.linalg.norm(view.corners_px - true_px, axis=1).max() < 0.35


def test_the_board_is_found_in_the_other_layout_and_ink() -> None:
    for board in (replace(PRINT, inverted=True), replace(PRINT, legacy=True)):
        found = settle_variant(SPEC, [picture(board)])
        assert (found.inverted, found.legacy) == (board.inverted, board.legacy)
    assert settle_variant(SPEC, [np.full((100, 100), 90, np.uint8)]) == SPEC


def test_a_blurred_picture_is_less_sharp() -> None:
    detector = BoardDetector(SPEC)
    sharp = detector.find(picture())
    soft = detector.find(picture(light=BoardLight(blur_px=1.2)))
    assert sharp is not None
    assert soft is not None
    assert soft.sharpness < 0.9 * sharp.sharpness


@pytest.mark.parametrize(
    ("spec", "draw", "reason", "says"),
    [
        (
            SPEC,
            partial(picture, light=BoardLight(brightness=0.0005, noise=0.5)),
            Reason.TOO_DARK,
            "",
        ),
        (SPEC, partial(picture, light=BoardLight(blur_px=12.0)), Reason.BLURRED, ""),
        (SPEC, mirrored, Reason.MIRRORED, ""),
        (
            SPEC,
            partial(picture, replace(PRINT, dictionary="DICT_6X6_250")),
            Reason.OTHER_DICTIONARY,
            "6X6",
        ),
        (replace(SPEC, columns=6, rows=5), picture, Reason.OTHER_SIZE, "rows of 5"),
        (replace(SPEC, columns=3, rows=4), picture, Reason.OTHER_SIZE, "marker 14"),
        (replace(CHESS, columns=9, rows=4), picture, Reason.OTHER_KIND, "markers of DICT_4X4_1000"),
        (
            replace(CHESS, columns=4, rows=5),
            partial(picture, replace(PRINT, dictionary="", columns=5, rows=6)),
            Reason.OTHER_SIZE,
            "5x6",
        ),
    ],
)
def test_the_reason_why_there_is_no_board(
    spec: BoardSpec, draw: Callable[[], Bytes], reason: Reason, says: str
) -> None:
    detector, pixels = BoardDetector(spec), draw()
    assert detector.find(pixels) is None
    told = diagnose_detection(detector, pixels)
    assert told.reason is reason
    assert says in told.detail


def test_an_empty_room_has_no_board() -> None:
    rng = np.random.default_rng(0)
    room = cv2.resize(rng.integers(0, 255, (30, 40), np.uint8), (640, 480), interpolation=0)
    noise = rng.normal(0, 3, room.shape)
    pixels = np.clip(room + noise, 0, 255).astype(np.uint8)
    detector = BoardDetector(SPEC)
    assert detector.find(pixels) is None
    assert diagnose_detection(detector, pixels).reason is Reason.NOTHING
