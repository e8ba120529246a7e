"""What the commands print, and what they leave behind."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mocapd as package
from mocapd.app.terminal.own_command import own_command
from mocapd.cli.demo import watch_command
from mocapd.config.sections import Config
from mocapd.outputs.output_table import ZenohSection
from tests.cli.mocapd_process import COMMAND, mocapd, mocapd_here
from tests.cli.small_capture import FRAMES, write_capture
from tests.sim.kept_capture import kept_capture
from tests.sim.small import scenario

COMMANDS = ("run", "demo", "track", "watch", "cameras", "check-config", "version")


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_each_command_has_an_example(command: str, clean_env: dict[str, str]) -> None:
    outcome = mocapd_here(clean_env, command, "--help")
    assert outcome.code == 0
    assert f"Example: mocapd {command}" in outcome.out


def test_the_help_names_every_command(clean_env: dict[str, str]) -> None:
    outcome = mocapd_here(clean_env, "--help")
    for command in COMMANDS:
        assert f"  {command} " in outcome.out


def test_version(clean_env: dict[str, str]) -> None:
    assert mocapd(clean_env, "version").out == f"{package.__version__}\n"
    option = mocapd_here(clean_env, "--version")
    assert (option.code, option.out) == (0, f"{package.__version__}\n")


@pytest.mark.parametrize(
    "words",
    [
        ("dance",),
        ("run", "--set", "instance"),
        ("run", "--camera", "left"),
        ("run", "--no-such-option"),
        ("export", "a.mcap", "--to", "fbx"),
        ("replay", "a.mcap", "--output", "smoke"),
        ("send-test", "--output", "smoke"),
        ("send-test", "--output", "zenoh", "--host", "127.0.0.1", "--port", "70000"),
        ("bench", "--watched"),
        ("bench", "--endurance", "nan"),
        ("bench", "--endurance", "inf"),
        ("bench", "--seconds", "inf"),
        ("eval",),
        ("track", "capture", "--variant", "paper"),
        ("calibrate", "--step", "dance"),
        ("calibrate", "--json"),
        ("calibrate", "--from-folder", "boards"),
        ("camera-node", "--camera", "a=/dev/video9", "--imperfect", "soap=3"),
        ("install-service", "--root", "a", "--user"),
        ("as-service", "--rig", "a b", "status"),
        ("board", "--board-size", "five"),
        ("shirt", "--size", "XXXL"),
    ],
    ids=" ".join,
)
def test_a_wrong_command_line_ends_with_2_and_writes_nothing(
    clean_env: dict[str, str], tmp_path: Path, words: tuple[str, ...]
) -> None:
    here = tmp_path / "here"
    here.mkdir()
    outcome = mocapd_here(clean_env, *words, cwd=here)
    assert (outcome.code, outcome.out) == (2, ""), outcome.err
    assert "Traceback" not in outcome.err
    assert list(here.iterdir()) == []


def test_check_config_tells_every_key_and_its_origin(clean_env: dict[str, str]) -> None:
    env = clean_env | {"MOCAPD_LOG_LEVEL": "debug"}
    outcome = mocapd_here(env, "check-config", "--set", "zenoh.port=7448")
    assert outcome.code == 0
    lines = {line.split()[0]: line for line in outcome.out.splitlines()}
    assert lines["zenoh.port"].split() == ["zenoh.port", "=", "7448", "#", "command", "line"]
    assert lines["log_level"].endswith("# environment MOCAPD_LOG_LEVEL")
    assert lines["osc.enabled"].endswith("# built-in")


def test_check_config_changed_and_json(clean_env: dict[str, str]) -> None:
    words = ("check-config", "--changed", "--json", "--camera", "left=/dev/video0")
    outcome = mocapd_here(clean_env, *words)
    told = json.loads(outcome.out)
    assert list(told) == ["camera"]
    assert told["camera"]["value"][0]["source"] == "/dev/video0"
    assert told["camera"]["from"] == "command line"


def test_cameras_as_json_is_one_object_a_line(clean_env: dict[str, str]) -> None:
    outcome = mocapd(clean_env, "cameras", "--json")
    assert outcome.code == 0
    for line in outcome.out.splitlines():
        assert {"node", "usb_id", "port", "source", "problem"} <= set(json.loads(line))


def test_track_writes_every_frame_and_the_same_bytes_twice(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    capture = write_capture(tmp_path / "capture")
    for name in ("a.npz", "b.npz"):
        words = ("track", capture, "--out", tmp_path / name, "--tracker", "canned")
        outcome = mocapd_here(clean_env, *words)
        assert outcome.code == 0, outcome.err
        assert outcome.out == ""
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with np.load(tmp_path / "a.npz", allow_pickle=False) as track:
        assert track["joints"].shape == (FRAMES, 22, 3)
        assert track["global_quats"].shape == (FRAMES, 22, 4)
        np.testing.assert_allclose(track["times"], np.arange(FRAMES) / 30.0, atol=1e-8)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.npz", "b.npz", "capture", "home"]


def test_score_track_reads_what_track_writes(
    clean_env: dict[str, str], tmp_path: Path, cache_home: Path, shared_dir: Path
) -> None:
    # as in tests/evaluate/test_command.py, so that one capture serves both
    capture = kept_capture(scenario(person_appears_s=0.2), 1.5, cache_home)
    out = tmp_path / "t.npz"
    assert mocapd_here(clean_env, "track", capture, "--out", out, "--tracker", "canned").code == 0
    score = [sys.executable, str(shared_dir / "tools" / "score_track.py"), str(capture), str(out)]
    done = subprocess.run([*score, "--json"], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)


def test_logs_carry_priorities_in_the_journal(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture = write_capture(tmp_path / "capture")
    log = tmp_path / "log"
    with log.open("w") as stream:
        stat = os.fstat(stream.fileno())
        env = clean_env | {"JOURNAL_STREAM": f"{stat.st_dev}:{stat.st_ino}"}
        setting = "zenoh.enabled=false"
        words = ("run", "--capture", capture, "--tracker", "canned", "--set", setting)
        done = subprocess.run([*COMMAND, *words], env=env, stderr=stream, timeout=60, check=False)
    assert done.returncode == 0
    lines = log.read_text().splitlines()
    assert lines
    assert all(line.startswith("<") and line[2] == ">" for line in lines), lines


def test_the_demo_prints_a_command_for_the_second_terminal() -> None:
    command = shlex.split(watch_command(Config(outputs={"zenoh": ZenohSection(port=7448)})))
    assert Path(command[0]).name == "mocapd"
    assert command[1:] == ["watch", "--set", "zenoh.port=7448"]
    assert shlex.split(watch_command(Config()))[1:] == ["watch"]
    assert watch_command(Config(outputs={"zenoh": ZenohSection(enabled=False)})) == ""


def test_a_command_that_the_shell_finds_by_a_link_is_named_without_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """pipx and the Debian package make such a link."""
    own, links = tmp_path / "environment" / "mocapd", tmp_path / "bin"
    for folder in (own.parent, links):
        folder.mkdir()
    own.touch(0o755)
    monkeypatch.setattr("sys.executable", str(own.parent / "python"))
    monkeypatch.setenv("PATH", str(links))
    assert own_command() == str(own)
    (links / "mocapd").symlink_to(own)
    assert own_command() == "mocapd"
