"""Bad input, as a user meets it: one clear line on stderr, and the exit code.

Some in a process of their own, whose streams nobody else writes to; the others by the command's entry.
"""

import os
import socket
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.mocapd_process import COMMAND, Outcome, mocapd, mocapd_here
from tests.cli.small_capture import (
    camera_entry,
    write_capture,
    write_rig,
    write_stroked,
    write_video,
)

Track = Callable[..., Outcome]


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    return write_capture(tmp_path / "capture")


@pytest.fixture
def track(capture: Path, clean_env: dict[str, str], tmp_path: Path) -> Track:
    """`mocapd track` of the capture, with further words."""

    def run(*words: str | Path) -> Outcome:
        out = tmp_path / "track.npz"
        return mocapd_here(clean_env, "track", capture, "--out", out, "--tracker", "canned", *words)

    return run


def assert_one_line(outcome: Outcome, code: int, *parts: str | Path) -> None:
    """That the command ended with this code, and one line that says all of this."""
    assert outcome.code == code, outcome.err
    assert outcome.out == ""
    lines = outcome.err.strip().splitlines()
    assert len(lines) == 1, outcome.err
    assert lines[0].startswith("mocapd: ")
    assert " -- " in lines[0], "no mend"
    for part in parts:
        assert str(part) in lines[0]


@pytest.mark.parametrize("recording", ["", ".", "/"])
def test_an_export_of_a_folder(clean_env: dict[str, str], recording: str) -> None:
    outcome = mocapd_here(clean_env, "export", recording, "--to", "csv")
    assert_one_line(outcome, 66, "no regular file")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_output_to_a_full_disk(clean_env: dict[str, str], unbuffered: str) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, "version"],
            env={**clean_env, "PYTHONUNBUFFERED": unbuffered},
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120.0,
            check=False,
        )
    assert_one_line(Outcome(done.returncode, "", done.stderr), 73, "No space left", "make room")


def test_an_endpoint_with_quotes_is_named_as_it_was_given(clean_env: dict[str, str]) -> None:
    endpoint = 'tcp/127.0.0.1:port#iface="lo"'
    outcome = mocapd(clean_env, "camera-node", "--camera", "a=/dev/video9", "--listen", endpoint)
    assert_one_line(outcome, 78, f"{endpoint!r} does not do", "protocol/address:port")


def test_output_to_a_terminal_without_the_letters(clean_env: dict[str, str]) -> None:
    env = {**clean_env, "PYTHONIOENCODING": "ascii"}
    outcome = mocapd(env, "check-config", "--changed", "--set", "instance=Küche")
    assert outcome.code == 0, outcome.err
    assert r"K\xfcche" in outcome.out


def test_output_to_a_reader_that_is_gone(clean_env: dict[str, str]) -> None:
    there, gone = os.pipe()
    os.close(there)
    with os.fdopen(gone, "w") as pipe:
        done = subprocess.run(
            [*COMMAND, "version"],
            env={**clean_env, "PYTHONUNBUFFERED": ""},
            stdout=pipe,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120.0,
            check=False,
        )
    assert (done.returncode, done.stderr) == (1, "")


def test_a_rig_with_a_missing_field(track: Track, capture: Path) -> None:
    entry = camera_entry("cam0", 0.0)
    del entry["dist"]
    rig = write_rig(capture, [entry])
    assert_one_line(track(), 78, rig, "camera 'cam0'", "'dist' is missing", "calibrate again")


def test_a_nan_in_the_calibration(track: Track, capture: Path) -> None:
    rig = write_rig(capture, [camera_entry("cam0", float("nan"))])
    assert_one_line(track(), 78, rig, "camera 'cam0'", "'t' contains NaN")


def test_a_rig_that_is_no_json(track: Track, capture: Path) -> None:
    (capture / "rig.json").write_text('{"cameras": [')
    assert_one_line(track(), 78, capture / "rig.json", "line 1")


def test_a_camera_of_another_size_than_its_calibration(track: Track, capture: Path) -> None:
    write_video(capture / "cam1.mp4", (32, 32))
    assert_one_line(track(), 78, capture / "cam1.mp4", "32x32", "64x48")


def test_a_video_that_is_damaged(clean_env: dict[str, str], capture: Path, tmp_path: Path) -> None:
    video = capture / "cam1.mp4"
    video.write_bytes(video.read_bytes()[:200])
    # how much the libraries say of it depends on how they were imported
    outcome = mocapd(
        clean_env, "track", capture, "--out", tmp_path / "t.npz", "--tracker", "canned"
    )
    assert_one_line(outcome, 66, video)


def test_a_capture_that_is_not_there(clean_env: dict[str, str], tmp_path: Path) -> None:
    outcome = mocapd_here(clean_env, "track", tmp_path / "none", "--out", tmp_path / "t.npz")
    assert_one_line(outcome, 66, tmp_path / "none")


def test_a_colour_model_with_a_colour_missing(track: Track, capture: Path) -> None:
    write_stroked(capture / "model" / "0.png", range(1, 10))
    assert_one_line(track(), 78, capture / "model", "colour 10 (")


def test_an_unknown_tracker(track: Track) -> None:
    assert_one_line(track("--tracker", "magic"), 78, "'magic'", "canned")


def test_the_option_of_earlier_versions_names_what_to_write_now(track: Track) -> None:
    outcome = track("--tracker", "shirt", "--variant", "paper")
    assert_one_line(outcome, 2, "--variant", "wang2011")


def test_several_cameras_without_a_rig(clean_env: dict[str, str], capture: Path) -> None:
    cameras = [f"{name}={capture / name}.mp4" for name in ("cam0", "cam1")]
    outcome = mocapd_here(clean_env, "run", "--camera", cameras[0], "--camera", cameras[1])
    assert_one_line(outcome, 78, "rig", "--rig")


def test_an_unwritable_cache(track: Track, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    outcome = track("--set", f"cache_dir={tmp_path / 'file' / 'cache'}")
    assert_one_line(outcome, 73, tmp_path / "file" / "cache", "cache_dir")


def test_an_output_that_cannot_be_written(track: Track, tmp_path: Path) -> None:
    outcome = track("--out", tmp_path / "absent" / "t.npz")
    assert_one_line(outcome, 73, tmp_path / "absent" / "t.npz")


def test_a_config_key_that_does_not_exist(track: Track, tmp_path: Path) -> None:
    config = tmp_path / "c.toml"
    config.write_text("[smoothing]\npreste = 'off'\n")
    outcome = track("--config", config)
    assert_one_line(outcome, 78, f"{config}:2", "smoothing.preste", "'smoothing.preset'")


def test_a_taken_port(clean_env: dict[str, str], capture: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        setting = f"zenoh.port={port}"
        words = ("run", "--capture", capture, "--tracker", "canned", "--set", setting)
        assert_one_line(mocapd(clean_env, *words), 69, str(port))


def test_no_camera_is_configured(clean_env: dict[str, str]) -> None:
    assert_one_line(mocapd_here(clean_env, "run"), 78, "camera", "mocapd cameras")


def test_a_camera_that_the_rig_does_not_have(clean_env: dict[str, str], capture: Path) -> None:
    words = ("run", "--rig", capture / "rig.json", "--camera", "left=/dev/video0")
    assert_one_line(mocapd_here(clean_env, *words), 78, "'left'", "cam0, cam1")


def test_a_scenario_that_does_not_exist(clean_env: dict[str, str]) -> None:
    assert_one_line(
        mocapd_here(clean_env, "run", "--capture", "sim:moon"), 66, "'moon'", "living_room"
    )


def test_nobody_to_watch(clean_env: dict[str, str]) -> None:
    words = ("watch", "--endpoint", "tcp/127.0.0.1:9", "--timeout", "0.3")
    assert_one_line(mocapd(clean_env, *words), 69, "tcp/127.0.0.1:9", "mocapd run")


def test_a_video_shorter_than_the_others_keeps_what_there_is(
    track: Track, capture: Path, tmp_path: Path
) -> None:
    write_video(capture / "cam1.mp4", frames=4)
    outcome = track()
    assert outcome.code == 0, outcome.err
    assert "10 of 10 frames" in outcome.err


def test_check_config_says_where_it_is_wrong(clean_env: dict[str, str], tmp_path: Path) -> None:
    home = Path(clean_env["HOME"]) / ".config" / "mocapd"
    home.mkdir(parents=True)
    (home / "config.toml").write_text("\n\n[zenoh]\nport = 'x'\n")
    outcome = mocapd_here(clean_env, "check-config")
    assert_one_line(outcome, 78, f"{home / 'config.toml'}:4", 'zenoh.port = "x"', "a whole number")
