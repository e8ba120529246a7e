"""`mocapd calibrate --from-folder`: the file it writes, what it prints, and how it refuses."""

import json
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibration.calibration_file import load_calibration
from mocapd.geometry.rig_file import load_rig
from mocapd.shirt.standard_shirt import standard_shirt
from tests.calibrate.board_scenes import cameras, floor_pose, held_poses, write_pictures
from tests.calibrate.seen_once import seen_once
from tests.cli.mocapd_process import Outcome, mocapd_here

SIZE_PX = (640, 480)
BOARD = ("--board", "charuco", "--square", "0.07", "--marker", "0.052")


@pytest.fixture(scope="module", autouse=True)
def boards_seen_once() -> Iterator[None]:
    """All commands but those of another board calibrate from the same pictures."""
    with seen_once():
        yield


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two webcams, nine positions of the board, and one on the floor."""
    folder = tmp_path_factory.mktemp("boards")
    return write_pictures(folder / "held", cameras(2), [*held_poses(9), floor_pose()])


def calibrate(env: dict[str, str], folder: Path, out: Path, *words: str) -> Outcome:
    size = () if "--board-size" in words else ("--board-size", "5x6")
    return mocapd_here(
        env,
        "calibrate",
        "--from-folder",
        folder,
        "--no-browser",
        "--out",
        out,
        *BOARD,
        *size,
        *words,
    )


def test_it_writes_the_rig_and_prints_one_object(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "rig.json"
    outcome = calibrate(clean_env, pictures, out, "--floor-frame", "9", "--json")
    assert outcome.code == 0, outcome.err
    told = json.loads(outcome.out)
    assert told["rms_px"] < 0.3
    assert told["play_area_cm"]["median"] < 0.8  # with how well nine positions place the cameras
    assert list(told["cameras"]) == ["cam0", "cam1"]
    for one in told["cameras"].values():
        assert one["rms_px"] < 0.3
        assert one["held_out_px"] < 0.4
        assert one["views"] >= 9
    assert told["refused"]["cam0"]["views"] == []
    assert load_rig(out).names == ("cam0", "cam1")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home", "rig.json"]


def test_a_board_whose_back_nobody_sees_is_said(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    outcome = calibrate(clean_env, pictures, tmp_path / "rig.json", "--two-sided", "--json")
    assert outcome.code == 0, outcome.err
    told = json.loads(outcome.out)
    assert told["board"]["two_sided"]
    assert told["back"] is None
    assert [one["backs"] for one in told["cameras"].values()] == [0, 0]
    assert "no camera saw the back of the board" in outcome.err


def test_a_refusal_is_one_line_and_leaves_the_old_rig(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "rig.json"
    before = '{"cameras": "the one before"}'
    out.write_text(before)
    few = tmp_path / "few"
    for picture in sorted(pictures.glob("*/*"))[::3]:
        (few / picture.parent.name).mkdir(parents=True, exist_ok=True)
        (few / picture.parent.name / picture.name).symlink_to(picture)
    outcome = calibrate(clean_env, few, out, "--board-size", "6x5", "--json", "--force")
    assert outcome.code == 78
    assert outcome.out == ""
    assert "rows of 5 squares, 6x5 was given" in outcome.err
    assert out.read_text() == before


def test_what_is_no_rig_is_not_replaced_by_one(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    for name in ("rig.json", "calibration.toml"):
        out = tmp_path / name
        out.write_text("my notes")
        outcome = calibrate(clean_env, pictures, out)
        assert outcome.code == 73
        assert "is there already, and is not a" in outcome.err
        assert out.read_text() == "my notes"


def test_what_cannot_be_is_refused_at_once(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "rig.json"
    for words, code, says in (
        (("--board-size", "5by6"), 2, "write columns x rows"),
        (("--board-size", "20000x20000"), 2, "up to 100 each"),
        (("--board-size", "5x" + "9" * 5000), 2, "is no whole number"),
        (("--board", "chessboard", "--board-size", "5x3"), 2, "at least 4 "),
        (("--board", "circles"), 2, "charuco or chessboard"),
        (("--dictionary", "DICT_X"), 2, "DICT_4X4_50"),
    ):
        outcome = calibrate(clean_env, pictures, out, *words)
        assert (outcome.code, says in outcome.err) == (code, True), outcome.err
    outcome = calibrate(clean_env, tmp_path / "absent", out)
    assert outcome.code == 66
    outcome = calibrate(clean_env, pictures, tmp_path / "no" / "rig.json")
    assert outcome.code == 73
    assert not out.exists()


def test_a_camera_of_the_configuration_without_a_recording_is_named(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    config = tmp_path / "mocapd.toml"
    config.write_text(
        "".join(f'[[camera]]\nid = "{name}"\nsource = "{name}.mp4"\n' for name in ("cam0", "cam7"))
    )
    out = tmp_path / "rig.json"
    outcome = calibrate(clean_env, pictures, out, "--config", str(config))
    assert outcome.code == 0, outcome.err
    assert "no recording of cam7, which the configuration names too" in outcome.err


def test_into_a_toml_file_it_writes_a_calibration_with_the_colours(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "state" / "calibration.toml"
    out.parent.mkdir()
    strokes = tmp_path / "strokes"
    write_strokes(strokes / "cam0.png", SIZE_PX, colours=3)
    refused = calibrate(clean_env, pictures, out, "--strokes", str(strokes))
    assert refused.code == 66
    assert "only 3 of 10 colours" in refused.err
    assert not out.exists()
    write_strokes(strokes / "cam0.png", SIZE_PX, colours=10)
    words = ("--strokes", str(strokes), "--floor-frame", "9")
    outcome = calibrate(clean_env, pictures, out, *words)
    assert outcome.code == 0, outcome.err
    saved = load_calibration(out)
    assert saved.calibration.rig is not None
    assert saved.calibration.rig.names == ("cam0", "cam1")
    assert saved.tables.room is not None
    assert saved.tables.room.floor_known
    assert saved.calibration.shirt is not None
    assert set(saved.calibration.shirt.white_balance) == {"cam0"}
    assert "--strokes lacks cam1.png" in outcome.err
    # the strokes lie on the standard's own colours
    colour = saved.tables.camera[0].colour
    assert colour is not None
    assert np.abs(np.array(colour.W) - np.eye(3)).max() < 0.1
    lens = saved.tables.camera[1].lens
    assert lens is not None
    assert lens.views >= 9


def test_the_saved_rate_is_that_of_the_recording_or_the_configuration(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    (tmp_path / "films").mkdir()
    for name in ("cam0", "cam1"):
        codec = cv2.VideoWriter.fourcc(*"MJPG")
        video = cv2.VideoWriter(str(tmp_path / "films" / f"{name}.avi"), codec, 15.0, SIZE_PX)
        for path in sorted((pictures / name).iterdir()):
            video.write(np.asarray(cv2.imread(str(path))))
        video.release()
    config = tmp_path / "mocapd.toml"
    config.write_text('[[camera]]\nid = "cam1"\nsource = "/dev/video7"\nfps_hz = 25\n')
    out = tmp_path / "state" / "calibration.toml"
    out.parent.mkdir()
    outcome = calibrate(clean_env, tmp_path / "films", out, "--config", str(config))
    assert outcome.code == 0, outcome.err
    saved = load_calibration(out).tables.camera
    assert [(one.source, one.fps_hz) for one in saved] == [
        (str(tmp_path / "films" / "cam0.avi"), 15.0),
        ("/dev/video7", 25.0),
    ]


def write_strokes(path: Path, size_px: tuple[int, int], colours: int) -> None:
    """A picture with patches of the shirt's colours, and a stroke on each of the first of them."""
    path.parent.mkdir(exist_ok=True)
    width, height = size_px
    picture = np.full((height, width, 3), 90, np.uint8)
    strokes = np.zeros((height, width), np.uint8)
    side = width // 12
    for i, rgb in enumerate(standard_shirt().srgb):
        across = slice((i + 1) * side, (i + 2) * side)
        picture[:, across] = rgb[::-1]
        if i < colours:
            strokes[height // 3 : 2 * height // 3, across] = i + 1
    cv2.imwrite(str(path), picture)
    cv2.imwrite(str(path.with_name(f"{path.stem}_strokes.png")), strokes)
