"""`mocapd calibrate --from-folder`: the file it writes, what it prints, and how it refuses."""

import json
from pathlib import Path

import pytest

from mocapd.geometry.rig_file import load_rig
from tests.calibrate.board_rooms import cameras, floor_pose, held_poses, write_pictures
from tests.cli.mocapd_process import Outcome, mocapd

BOARD = ("--board", "charuco", "--square", "0.07", "--marker", "0.052")


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two webcams, nine positions of the board, and one on the floor."""
    folder = tmp_path_factory.mktemp("boards")
    return write_pictures(folder / "held", cameras(2), [*held_poses(9), floor_pose()])


def calibrate(env: dict[str, str], folder: Path, out: Path, *words: str) -> Outcome:
    size = () if "--board-size" in words else ("--board-size", "5x6")
    return mocapd(
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
    assert told["play_area_cm"]["median"] < 0.2
    assert list(told["cameras"]) == ["cam0", "cam1"]
    for one in told["cameras"].values():
        assert one["rms_px"] < 0.3
        assert one["held_out_px"] < 0.4
        assert one["views"] >= 9
    assert told["refused"]["cam0"]["views"] == []
    assert load_rig(out).names == ("cam0", "cam1")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home", "rig.json"]


def test_a_refusal_is_one_line_and_leaves_the_old_rig(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "rig.json"
    out.write_text("the one before")
    few = tmp_path / "few"
    for picture in sorted(pictures.glob("*/*"))[::3]:
        (few / picture.parent.name).mkdir(parents=True, exist_ok=True)
        (few / picture.parent.name / picture.name).symlink_to(picture)
    outcome = calibrate(clean_env, few, out, "--board-size", "6x5", "--json")
    assert outcome.code == 78
    assert outcome.out == ""
    assert "rows of 5 squares, 6x5 was given" in outcome.err
    assert out.read_text() == "the one before"


def test_what_cannot_be_is_refused_at_once(
    clean_env: dict[str, str], pictures: Path, tmp_path: Path
) -> None:
    out = tmp_path / "rig.json"
    for words, code, says in (
        (("--board-size", "5by6"), 78, "write columns x rows"),
        (("--board", "circles"), 78, "charuco or chessboard"),
        (("--dictionary", "DICT_X"), 78, "DICT_4X4_50"),
    ):
        outcome = calibrate(clean_env, pictures, out, *words)
        assert (outcome.code, says in outcome.err) == (code, True), outcome.err
    outcome = calibrate(clean_env, tmp_path / "absent", out)
    assert outcome.code == 66
    outcome = calibrate(clean_env, pictures, tmp_path / "no" / "rig.json")
    assert outcome.code == 73
    assert not out.exists()
