"""Why a recording does not show its board: the reason that fits, though most pictures are without any board."""

import weakref
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibrate.board.board_detection import BoardDetector, DetectionFailure, Reason
from mocapd.calibrate.board.board_recordings import Recording, find_recordings
from mocapd.calibrate.board.detection_diagnostics import diagnose_detection, most_telling
from mocapd.calibrate.extrinsics import board_sighting
from mocapd.calibrate.extrinsics.board_sighting import (
    BoardSighting,
    SpreadSample,
    refuse_unseen,
    sight_board,
)
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.errors import ConfigError
from mocapd.sim.board.board_picture import BoardFilm, PrintedBoard
from mocapd.types import Bytes
from tests.calibrate.board_scenes import PRINT, cameras, held_poses
from tests.calibrate.seen_once import never_written, seen_once

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052)
(CAMERA,) = cameras(1)
PICTURES = 40
POSES = held_poses(PICTURES)


@pytest.fixture(scope="module", autouse=True)
def boards_seen_once() -> Iterator[None]:
    """Most of the pictures show the same wall, of which the same is said each time."""
    said: dict[tuple[BoardSpec, bytes], DetectionFailure] = {}

    def diagnose_once(detector: BoardDetector, pixels: Bytes) -> DetectionFailure:
        key = (detector.spec, pixels.tobytes())
        if key not in said:
            said[key] = diagnose_detection(detector, pixels)
        return said[key]

    with seen_once(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(board_sighting, "diagnose_detection", diagnose_once)
        yield


def quiet(what: str, done: int, total: int) -> None:
    """Progress that nobody looks at."""


@cache
def wall() -> Bytes:
    """An empty picture: a plain wall, with noise."""
    rng = np.random.default_rng(0)
    return rng.normal(110.0, 2.0, (CAMERA.size_px[1], CAMERA.size_px[0], 3)).astype(np.uint8)


@cache
def film(board: PrintedBoard) -> BoardFilm:
    """The camera's view of this board."""
    return BoardFilm(CAMERA, board)


@cache
def held(board: PrintedBoard, i: int) -> Bytes:
    """The i-th picture of a recording, which shows this board."""
    return never_written(film(board).picture(*POSES[i], seed=i))


def sighted(
    folder: Path,
    spec: BoardSpec,
    board: PrintedBoard,
    shown: Sequence[int],
    change: Callable[[Bytes], Bytes] = lambda pixels: pixels,
) -> BoardSighting:
    """What is found in a recording of a wall before which the board is held in the pictures `shown`."""
    (folder / "left").mkdir()
    empty = cv2.imencode(".jpg", wall())[1].tobytes()
    for i in range(PICTURES):
        path = folder / "left" / f"{i:04d}.jpg"
        if i in shown:
            cv2.imwrite(str(path), change(held(board, i)))
        else:
            path.write_bytes(empty)
    (recording,) = find_recordings(folder)
    return sight_board(recording, spec, 1, quiet)


@pytest.mark.parametrize(
    ("spec", "board", "said"),
    [
        (SPEC, replace(PRINT, dictionary="DICT_5X5_100"), r"dictionary, \d+ markers of DICT_5X5_"),
        (
            replace(SPEC, dictionary="DICT_APRILTAG_16h5"),
            replace(PRINT, dictionary="DICT_APRILTAG_36h11"),
            r"dictionary, \d+ markers of DICT_APRILTAG_36h11",
        ),
        (
            SPEC,
            replace(PRINT, dictionary="DICT_6X6_50", inverted=True),
            r"dictionary, \d+ markers of DICT_6X6_",
        ),
        (replace(SPEC, columns=7), PRINT, "it fits rows of 5 squares, 7x6 was given"),
        (replace(SPEC, columns=4, rows=4), PRINT, r"marker 14 is seen; .* markers 0 to 7"),
        (
            replace(SPEC, columns=7),
            replace(PRINT, inverted=True),
            "rows of 5 squares, 7x6 was given, printed light on dark",
        ),
        (SPEC, replace(PRINT, dictionary=""), "another kind, a plain chessboard of 5x6 squares"),
    ],
)
def test_the_board_that_is_shown_is_named_after_a_while_without_one(
    tmp_path: Path, spec: BoardSpec, board: PrintedBoard, said: str
) -> None:
    sighting = sighted(tmp_path, spec, board, range(32, PICTURES))
    with pytest.raises(ConfigError, match=rf"left: .* in 0 of 40 pictures: .*{said}.* -- "):
        refuse_unseen([sighting])


def test_a_board_that_is_shown_shortly_is_enough(tmp_path: Path) -> None:
    board = replace(PRINT, dictionary="DICT_7X7_250")
    with pytest.raises(ConfigError, match="markers are of another dictionary"):
        refuse_unseen([sighted(tmp_path, SPEC, board, range(29, 33))])


def test_a_mirrored_recording_is_named_after_a_while_without_a_board(tmp_path: Path) -> None:
    def mirror(pixels: Bytes) -> Bytes:
        return np.ascontiguousarray(pixels[:, ::-1])

    with pytest.raises(ConfigError, match="the picture is mirrored -- switch mirroring off"):
        refuse_unseen([sighted(tmp_path, SPEC, PRINT, range(32, PICTURES), mirror)])


@pytest.mark.parametrize("board", [replace(PRINT, inverted=True), replace(PRINT, legacy=True)])
def test_a_variant_that_is_shown_at_the_end_alone_is_found(
    tmp_path: Path, board: PrintedBoard
) -> None:
    """Between the few pictures of the recording that variants are tried on at first."""
    sighting = sighted(tmp_path, SPEC, board, range(31, PICTURES))
    assert (sighting.spec.inverted, sighting.spec.legacy) == (board.inverted, board.legacy)
    assert len(sighting.views) >= 8
    refuse_unseen([sighting])


def test_a_plain_wall_is_not_called_blurred(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no board in the picture -- show the board"):
        refuse_unseen([sighted(tmp_path, SPEC, PRINT, ())])


def test_of_a_video_that_does_not_say_its_length_few_pictures_are_in_memory() -> None:
    shown: list[weakref.ref[Bytes]] = []
    most = 0

    class Unending(Recording):
        def pictures(self, stride: int = 1) -> Iterator[tuple[int, Bytes]]:
            nonlocal most
            for index in range(0, 60, stride):
                pixels = np.full((48, 64, 3), index, np.uint8)
                shown.append(weakref.ref(pixels))
                most = max(most, sum(picture() is not None for picture in shown))
                yield index, pixels

    sight_board(Unending("cam0", Path("cam0.mjpeg"), 0, (64, 48)), SPEC, 1, quiet)
    assert most <= 10


def test_a_second_without_a_board(shared_dir: Path) -> None:
    folder = shared_dir / "findings/reports-2026-11-26/09-empty-first-second"
    if not folder.exists():
        pytest.skip("no such finding here")
    (recording,) = find_recordings(folder)
    spec = BoardSpec(BoardKind.CHARUCO, 5, 7, 0.075, 0.05625, "DICT_4X4_1000")
    for given, said in (
        (replace(spec, dictionary="DICT_5X5_100"), r"dictionary, 1\d markers of DICT_4X4_1000"),
        (replace(spec, columns=7, rows=5), "it fits rows of 5 squares, 7x5 was given"),
    ):
        with pytest.raises(ConfigError, match=said):
            refuse_unseen([sight_board(recording, given, 12, quiet)])


def test_what_is_seen_outranks_what_is_not() -> None:
    blurred = [DetectionFailure(Reason.BLURRED) for _ in range(9)]
    stray = DetectionFailure(Reason.FEW, "1 of 15 markers", 1)
    part = DetectionFailure(Reason.FEW, "4 of 15 markers", 4)
    fewer = DetectionFailure(Reason.OTHER_DICTIONARY, "5 markers", 5)
    more = DetectionFailure(Reason.OTHER_DICTIONARY, "9 markers", 9)
    mirrored = DetectionFailure(Reason.MIRRORED)
    assert most_telling([*blurred, stray]).reason is Reason.BLURRED
    assert most_telling([*blurred, stray, part]) is part
    assert most_telling([*blurred, part, fewer, mirrored, more]) is more


@pytest.mark.parametrize("count", [1, 2, 23, 24, 25, 100, 2000])
def test_a_sample_is_spread_over_a_stream_of_any_length(count: int) -> None:
    sample = SpreadSample()
    for i in range(count):
        sample.offer(np.array([[i // 256, i % 256]], np.uint8))
    indices = [256 * int(grey[0, 0]) + int(grey[0, 1]) for grey in sample.spread()]
    assert len(indices) == len(set(indices)) <= 24
    assert len(indices) >= min(count, 12)
    assert np.diff(sorted(indices), prepend=-1, append=count).max() <= max(1, count // 6)
    assert count < 4 or 0 < sum(index < count / 2 for index in indices[:3]) < 3


def test_a_sample_of_large_pictures_is_smaller() -> None:
    sample = SpreadSample()
    for _ in range(200):
        sample.offer(np.broadcast_to(np.uint8(0), (50_000, 1000)))
    assert len(list(sample.spread())) <= 2
