"""From recordings to a rig, and what is said of recordings that do not give one."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibrate.board.board_recordings import find_recordings, pictures_by_index
from mocapd.calibrate.extrinsics.folder_calibration import (
    FolderCalibration,
    FolderParams,
    calibrate_folder,
)
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.errors import ConfigError, InputError
from mocapd.geometry.camera_model import centre, normalised, project
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Bytes
from tests.calibrate.board_scenes import cameras, floor_pose, held_poses, write_pictures
from tests.calibrate.seen_once import seen_once

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 6, 0.07, 0.052)
RIG = cameras(2)


def quiet(what: str, done: int, total: int) -> None:
    """Progress that nobody looks at."""


@pytest.fixture(scope="module", autouse=True)
def boards_seen_once() -> Iterator[None]:
    """Most of the tests calibrate from the same pictures."""
    with seen_once():
        yield


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """12 positions of the board and one on the floor, by two webcams with noise, blur, distortion."""
    folder = tmp_path_factory.mktemp("boards")
    return write_pictures(folder / "held", RIG, [*held_poses(12), floor_pose()])


@pytest.fixture(scope="module")
def calibrated(pictures: Path) -> FolderCalibration:
    return calibrate_folder(pictures, SPEC, quiet, floor_frame=12)


def test_twelve_positions_give_the_room(calibrated: FolderCalibration) -> None:
    rng = np.random.default_rng(0)
    points_m = rng.uniform([-0.3, 0.05, -0.3], [0.3, 0.5, 0.3], (500, 3))
    pixels = [project(camera, points_m) for camera in RIG]
    found_m, _ = triangulate(
        calibrated.rig.cameras,
        np.stack([normalised(c, px) for c, px in zip(calibrated.rig.cameras, pixels, strict=True)]),
    )
    off_cm = 100.0 * np.linalg.norm(found_m - points_m, axis=1)
    print(f"triangulated point: median {np.median(off_cm):.3f} cm")
    assert np.median(off_cm) <= 0.5
    for true, found in zip(RIG, calibrated.rig.cameras, strict=True):
        focal = np.diag(found.K)[:2] / np.diag(true.K)[:2] - 1.0
        off_m = np.linalg.norm(centre(true) - centre(found))
        print(f"{true.name}: focal {100 * focal} %, position {100 * off_m:.3f} cm")
        assert np.abs(focal).max() <= 0.005
        assert off_m <= 0.01
    assert calibrated.rms_px < 0.3
    assert calibrated.notes == ()


def test_without_a_floor_the_world_is_called_a_guess(pictures: Path) -> None:
    found = calibrate_folder(pictures, SPEC, quiet)
    assert "--floor-frame" in found.notes[0]
    for camera in found.rig.cameras:
        assert -camera.R[1, 1] > 0.5  # up in the picture is up in the world


def test_a_frame_without_the_board_is_no_floor(pictures: Path) -> None:
    with pytest.raises(ConfigError, match="--floor-frame 99: no camera sees the board in it"):
        calibrate_folder(pictures, SPEC, quiet, floor_frame=99)


@pytest.mark.parametrize(
    ("params", "frame"),
    [
        (FolderParams(most_pictures=5), 12),  # thinned to the first five
        (FolderParams(most_pictures=7, densely=1), 13),  # every second one is examined
    ],
)
def test_the_floor_frame_of_a_long_recording_is_used(
    pictures: Path, params: FolderParams, frame: int
) -> None:
    found = calibrate_folder(pictures, SPEC, quiet, floor_frame=frame, params=params)
    assert found.notes == ()
    for true, camera in zip(RIG, found.rig.cameras, strict=True):
        assert np.linalg.norm(centre(true) - centre(camera)) <= 0.03


def copied(
    pictures: Path,
    to: Path,
    change: Callable[[Bytes], Bytes] | None = None,
    fewer: tuple[str, ...] = (),
) -> Path:
    """The same pictures, those of cam1 changed; of the cameras `fewer` three only."""
    for folder in sorted(pictures.iterdir()):
        (to / folder.name).mkdir(parents=True, exist_ok=True)
        for path in sorted(folder.iterdir())[: 3 if folder.name in fewer else None]:
            copy = to / folder.name / path.name
            if change is None or folder.name != "cam1":
                copy.symlink_to(path)
                continue
            pixels = cv2.imread(str(path))
            assert pixels is not None
            cv2.imwrite(str(copy), change(pixels.astype(np.uint8)))
    return to


def test_wrong_dimensions_are_named(pictures: Path, tmp_path: Path) -> None:
    folder = copied(pictures, tmp_path / "d", fewer=("cam0", "cam1"))
    with pytest.raises(ConfigError, match="rows of 5 squares, 7x6 was given -- give --board-size"):
        calibrate_folder(folder, replace(SPEC, columns=7), quiet)


def test_a_mirrored_camera_is_named(pictures: Path, tmp_path: Path) -> None:
    folder = copied(pictures, tmp_path / "m", lambda px: px[:, ::-1], fewer=("cam1",))
    with pytest.raises(ConfigError, match=r"cam1: .*the picture is mirrored -- switch mirroring"):
        calibrate_folder(folder, SPEC, quiet)


def test_a_board_in_one_camera_only_is_said(pictures: Path, tmp_path: Path) -> None:
    folder = copied(pictures, tmp_path / "o", lambda px: np.full_like(px, 110))
    with pytest.raises(ConfigError, match=r"cam1: .* in 0 of 13 pictures \(it is seen by cam0\)"):
        calibrate_folder(folder, SPEC, quiet)


def test_a_board_never_seen_by_both_at_once_is_said(pictures: Path, tmp_path: Path) -> None:
    folder = copied(pictures, tmp_path / "n")
    for path in (folder / "cam1").iterdir():
        path.rename(path.with_name(f"{int(path.stem) + 500}.bmp"))
    with pytest.raises(ConfigError, match="at the same moment"):
        calibrate_folder(folder, SPEC, quiet)


def test_plain_boards_that_look_the_same_upside_down_are_refused(pictures: Path) -> None:
    board = BoardSpec(BoardKind.CHESSBOARD, 6, 8, 0.05)
    with pytest.raises(ConfigError, match="upside down"):
        calibrate_folder(pictures, board, quiet)


def test_pictures_belong_together_by_the_number_in_their_names(tmp_path: Path) -> None:
    for name in ("b_10.png", "b_9.png", "b_2.png"):
        (tmp_path / name).touch()
    assert [(i, p.name) for i, p in pictures_by_index(tmp_path)] == [
        (2, "b_2.png"),
        (9, "b_9.png"),
        (10, "b_10.png"),
    ]
    (tmp_path / "x.png").touch()
    assert [i for i, _ in pictures_by_index(tmp_path)] == [0, 1, 2, 3]


def test_folders_without_recordings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        find_recordings(tmp_path / "absent")
    with pytest.raises(InputError, match="no recording"):
        find_recordings(tmp_path)
    (tmp_path / "cam0.mp4").write_text("not a video")
    with pytest.raises(InputError, match="damaged"):
        find_recordings(tmp_path)


def test_real_webcams(shared_dir: Path, tmp_path: Path) -> None:
    """Three real webcams and a board in a hand; a third of the frames, for time."""
    folder = shared_dir / "realvideo" / "caliscope_charuco"
    if not folder.is_dir():
        pytest.skip("../shared is not beside this checkout: realvideo/caliscope_charuco is missing")
    board = BoardSpec(BoardKind.CHARUCO, 4, 5, 0.054, 0.0405)  # inverted, which it finds itself
    for video in sorted(folder.glob("*.mp4"))[:3]:
        (tmp_path / video.name).symlink_to(video)
    params = FolderParams(most_pictures=20, most_views=12)
    found = calibrate_folder(tmp_path, board, quiet, params=params)
    reference = json.loads((folder / "calib_opencv.json").read_text())["cameras"]
    assert found.board.inverted
    assert list(found.cameras) == [one["name"] for one in reference][:3]
    print(found.rms_px, {name: one.fit.rms_px for name, one in found.cameras.items()})
    assert found.rms_px <= 1.0
