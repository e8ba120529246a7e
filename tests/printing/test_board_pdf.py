"""The printed board is the board that it says it is, at the size that it says."""

import cv2
import numpy as np
import pytest

from mocapd.calibration.board_spec import BoardSpec, aruco_board, corners_m
from mocapd.errors import ConfigError
from mocapd.printing.board_layout import fitted_board, layout_behind, layout_of
from mocapd.printing.board_pdf import board_pdf, flags_of
from mocapd.printing.paper_sizes import PAPERS_MM, RULER_MM
from mocapd.types import Floats
from tests.printing.printed import Print, keywords, pages, printed, text

PX_PER_MM = 8.0

BOARDS = [
    ("A4", 5, 7, "DICT_4X4_50", False),
    ("Letter", 8, 5, "DICT_6X6_250", False),  # on its side
    ("A3", 7, 10, "DICT_5X5_100", False),  # an even count of rows: not the legacy layout
    ("A4", 4, 6, "DICT_APRILTAG_36h11", False),
    ("A4", 5, 7, "DICT_4X4_1000", True),
]


def found_corners_mm(sheet: Print, board: BoardSpec) -> tuple[Floats, Floats]:
    """What OpenCV's own detector finds: corner numbers and places [mm] from the page's upper left."""
    grey = cv2.cvtColor(sheet.pixels, cv2.COLOR_RGB2GRAY)
    # a camera sees the table round the sheet, and no sharp pixels
    grey = cv2.GaussianBlur(grey, (0, 0), 1.5)
    parameters = cv2.aruco.DetectorParameters()
    parameters.detectInvertedMarker = board.inverted
    detector = cv2.aruco.CharucoDetector(
        aruco_board(board), cv2.aruco.CharucoParameters(), parameters
    )
    corners, ids, _, _ = detector.detectBoard(grey)
    # pixel centres at integers
    return np.ravel(ids), (np.reshape(corners, (-1, 2)).astype(float) + 0.5) / sheet.px_per_mm


@pytest.mark.parametrize(("paper", "columns", "rows", "dictionary", "inverted"), BOARDS)
def test_a_camera_finds_every_corner_where_it_should_be(
    paper: str, columns: int, rows: int, dictionary: str, inverted: bool
) -> None:
    board = fitted_board(paper, columns, rows, dictionary, inverted=inverted)
    sheet = printed(board_pdf(board, paper), 0, PX_PER_MM)
    ids, found_mm = found_corners_mm(sheet, board)
    assert sorted(ids.tolist()) == list(range((columns - 1) * (rows - 1)))
    x, y, _, height = layout_of(board, paper).board
    origin = np.array([x, sheet.size_mm[1] - y - height])
    expected_mm = origin + 1000 * corners_m(board)[ids.astype(int), :2]
    assert np.abs(found_mm - expected_mm).max() < 0.1
    # the size alone, wherever the board may be: the side of a square over the whole board
    spread = np.ptp(found_mm, axis=0) / [columns - 2, rows - 2]
    assert np.abs(spread - 1000 * board.square_m).max() < 0.1 / (min(columns, rows) - 2)


@pytest.mark.parametrize("paper", PAPERS_MM)
def test_the_page_has_the_size_of_the_paper(paper: str) -> None:
    pdf = board_pdf(fitted_board(paper, 5, 7, "DICT_4X4_50"), paper)
    assert pages(pdf) == 1
    assert np.abs(printed(pdf, 0, 1.0).size_mm - PAPERS_MM[paper]).max() < 0.01


def test_the_board_is_as_large_as_fits() -> None:
    for paper, columns, rows, dictionary, _ in BOARDS:
        board = fitted_board(paper, columns, rows, dictionary)
        assert board.square_m * 1000 == pytest.approx(round(board.square_m * 1000))
        with pytest.raises(ConfigError, match="do not fit"):
            fitted_board(paper, columns, rows, dictionary, square_m=board.square_m + 0.001)
    # on A4 that is most of the sheet
    board = fitted_board("A4", 5, 7, "DICT_4X4_50")
    assert 35 * board.square_m**2 > 0.7 * 0.210 * 0.297


@pytest.mark.parametrize("paper", PAPERS_MM)
def test_the_rulers_are_100_mm(paper: str) -> None:
    board = fitted_board(paper, 5, 7, "DICT_4X4_50")
    layout = layout_of(board, paper)
    sheet = printed(board_pdf(board, paper), 0, 8.0)
    # strips that only the long ticks at 0, 10 .. 100 mm cross, and no figure
    x, y = layout.ruler_mm
    across = sheet.part((x - 2, y + 3.3), (RULER_MM + 4, 0.5)).mean(axis=(0, 2))
    x, y = layout.upright_ruler_mm
    up = sheet.part((x - 3.8, y - 2), (0.5, RULER_MM + 4)).mean(axis=(1, 2))
    for strip, per_mm in zip((across, up), sheet.px_per_mm, strict=True):
        ink = 255.0 - strip
        runs = np.split(np.arange(len(ink)), np.flatnonzero(np.diff((ink > 20).astype(int))) + 1)
        ticks_mm = np.array([ink[r] @ r / ink[r].sum() / per_mm for r in runs if ink[r[0]] > 20])
        assert len(ticks_mm) == 11
        assert ticks_mm[-1] - ticks_mm[0] == pytest.approx(100.0, abs=0.05)
        assert np.abs(np.diff(ticks_mm) - 10.0).max() < 0.08


@pytest.mark.parametrize("inverted", [False, True])
def test_it_says_how_to_calibrate_with_it(inverted: bool) -> None:
    board = fitted_board("A4", 5, 7, "DICT_4X4_50", inverted=inverted)
    pdf = board_pdf(board, "A4")
    flags = (
        "--board charuco --board-size 5x7 --square 0.036 --marker 0.027 --dictionary DICT_4X4_50"
    )
    flags += " --inverted" if inverted else ""
    assert flags_of(board) == keywords(pdf) == flags
    words = text(pdf, 0)
    assert f"mocapd calibrate --from-folder DIR --no-browser --out rig.json {flags}" in words
    assert "5 x 7 squares of 36 mm" in words
    assert "this must be 100 mm" in words


@pytest.mark.parametrize(("paper", "columns", "rows", "dictionary", "inverted"), BOARDS)
def test_nothing_is_drawn_where_printers_cannot_print(
    paper: str, columns: int, rows: int, dictionary: str, inverted: bool
) -> None:
    pdf = board_pdf(fitted_board(paper, columns, rows, dictionary, inverted=inverted), paper)
    image = printed(pdf, 0, 4.0).pixels
    edge = 4 * 6
    inside = np.zeros(image.shape[:2], dtype=bool)
    inside[edge:-edge, edge:-edge] = True
    assert (image[~inside] == 255).all()


@pytest.mark.parametrize(("paper", "columns", "rows", "dictionary", "inverted"), BOARDS)
def test_back_to_back_every_corner_of_two_sides_has_one_place(
    paper: str, columns: int, rows: int, dictionary: str, inverted: bool
) -> None:
    """The second page, looked at through the paper, is the first."""
    board = fitted_board(paper, columns, rows, dictionary, inverted=inverted, two_sided=True)
    assert board.two_sided
    pdf = board_pdf(board, paper)
    assert pages(pdf) == 2
    front, back = (printed(pdf, page, PX_PER_MM) for page in (0, 1))
    through = Print(np.ascontiguousarray(back.pixels[:, ::-1]), back.size_mm, back.px_per_mm)
    sides = [found_corners_mm(sheet, board) for sheet in (front, through)]
    for ids, _ in sides:
        assert sorted(ids.tolist()) == list(range((columns - 1) * (rows - 1)))
    in_order = [found_mm[np.argsort(ids)] for ids, found_mm in sides]
    assert np.abs(in_order[0] - in_order[1]).max() < 0.1
    layout = layout_of(board, paper)
    for sheet, crosses in ((front, layout.crosses), (back, layout_behind(layout).crosses)):
        assert list(crosses) == ["A", "B", "C", "D"]
        for x, y in crosses.values():
            assert sheet.part((x - 3.2, y - 0.4), (2.0, 0.8)).min() < 128  # left of its middle
            assert sheet.part((x - 0.4, y - 3.2), (0.8, 2.0)).min() < 128  # below it
    edge = int(6 * PX_PER_MM)
    for sheet in (front, back):
        inside = np.zeros(sheet.pixels.shape[:2], dtype=bool)
        inside[edge:-edge, edge:-edge] = True
        assert (sheet.pixels[~inside] == 255).all()


@pytest.mark.parametrize(
    ("columns", "rows", "square_m", "inverted"),
    [(5, 7, 0.014, False), (9, 3, 0.02, False), (3, 12, 0.01, True), (4, 5, 0.03, True), (5, 7, None, True)],
)  # fmt: skip
def test_no_ruler_and_no_word_lies_under_a_cross(
    columns: int, rows: int, square_m: float | None, inverted: bool
) -> None:
    board = fitted_board(
        "A4", columns, rows, "DICT_4X4_1000", inverted=inverted, two_sided=True, square_m=square_m
    )
    pdf, layout = board_pdf(board, "A4"), layout_of(board, "A4")
    for page, sides in enumerate((layout, layout_behind(layout))):
        sheet = printed(pdf, page, PX_PER_MM)
        for letter, (x, y) in sides.crosses.items():
            # the quarters without the letter
            for corner in ((x - 3.4, y + 0.4), (x - 3.4, y - 3.4), (x + 0.4, y - 3.4)):
                assert (sheet.part(corner, (3.0, 3.0)) == 255).all(), (page, letter)


def test_two_sides_say_how_they_are_glued() -> None:
    board = fitted_board("A4", 5, 7, "DICT_4X4_1000", two_sided=True)
    pdf = board_pdf(board, "A4")
    assert flags_of(board) == keywords(pdf)
    assert flags_of(board).endswith(" --two-sided")
    front, back = (" ".join(text(pdf, page).split()) for page in (0, 1))
    assert "FRONT: ChArUco board, A4" in front
    assert "how BACK goes on is said there" in front
    assert "BACK: ChArUco board, mirrored, A4" in back
    assert "push a pin straight through each cross" in back
    assert "each cross on the pin of its own letter" in back


def test_the_back_of_a_small_board_has_all_of_its_ruler_and_its_words_on_the_page() -> None:
    board = fitted_board("A4", 3, 3, "DICT_4X4_50", two_sided=True, square_m=0.02)
    back = printed(board_pdf(board, "A4"), 1, 4.0)
    margin = back.pixels[:, -4 * 6 :]
    assert (margin == 255).all()
    x, y = layout_behind(layout_of(board, "A4")).ruler_mm
    assert back.part((x + RULER_MM - 0.2, y), (0.4, 4.0)).min() < 128


def test_the_same_board_gives_the_same_bytes() -> None:
    board = fitted_board("A4", 5, 7, "DICT_4X4_50")
    assert board_pdf(board, "A4") == board_pdf(board, "A4")


def test_boards_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ConfigError, match=r"no paper 'A5'.*A4, Letter, A3"):
        fitted_board("A5", 5, 7, "DICT_4X4_50")
    with pytest.raises(ConfigError, match=r"--board-size: 30x40 .* which a webcam cannot read"):
        fitted_board("A4", 30, 40, "DICT_4X4_1000")
    with pytest.raises(ConfigError, match="has 50 markers"):
        fitted_board("A3", 10, 12, "DICT_4X4_50")
    with pytest.raises(ConfigError, match="DICT_4X4_9"):
        fitted_board("A4", 5, 7, "DICT_4X4_9")
    with pytest.raises(ConfigError, match="too few"):
        fitted_board("A4", 2, 7, "DICT_4X4_50")
    with pytest.raises(ConfigError, match="a marker of"):
        fitted_board("A4", 5, 7, "DICT_4X4_50", square_m=0.03, marker_m=0.03)
    with pytest.raises(ConfigError, match="hard to read"):
        fitted_board("A4", 5, 7, "DICT_4X4_50", square_m=0.03, marker_m=0.029)
