"""What is permitted although it is unsafe is told in one line each, and passwords are not shown."""

import grp
import json
import os
from pathlib import Path

import pytest

from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.boundary import secret_files
from mocapd.config.effective import load_config
from tests.cli.mocapd_process import mocapd_here

URL = "rtsp://admin:hunter2@127.0.0.1:9/stream"
CAMERA = f"[[camera]]\nid = 'door'\nsource = '{URL}'\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A configuration with a password, for us alone, and a state directory without anything."""
    file = tmp_path / "config.toml"
    file.write_text(f"state_dir = '{tmp_path / 'state'}'\n{CAMERA}")
    file.chmod(0o600)
    return file


def told(file: Path, **flags: str) -> str:
    return "\n".join(unsafe_settings(load_config(flags, file, env={})))


def test_a_password_in_a_file_that_others_may_read_is_told(file: Path) -> None:
    assert told(file) == ""
    file.chmod(0o644)
    assert "camera door" in told(file)
    assert f"chmod 600 {file}" in told(file)


def test_the_group_of_the_service_may_read_its_configuration(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file.chmod(0o640)
    assert "its group may read it" in told(file)
    for name in ("mocapd", "mocapd-node"):
        group = grp.struct_group((name, "x", file.stat().st_gid, []))
        monkeypatch.setattr(grp, "getgrgid", lambda _gid, group=group: group)
        file.chmod(0o640)
        assert told(file) == ""
        file.chmod(0o644)
        assert "every user of this machine may read it" in told(file)


def test_what_a_service_only_reads_is_narrowed_by_its_group(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`chmod 600` of root's file would take it away from the service."""
    file.chmod(0o644)
    group = grp.struct_group(("mocapd", "x", 12_345, []))
    monkeypatch.setattr(grp, "getgrgid", lambda _gid: group)
    monkeypatch.setattr(os, "geteuid", lambda: file.stat().st_uid + 1)
    assert f"`sudo chown root:mocapd {file} && sudo chmod 640 {file}`" in told(file)
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(secret_files, "SERVICE_FOLDER", file.parent)
    assert f"`chown root:mocapd {file} && chmod 640 {file}`" in told(file)
    node = file.rename(file.parent / "camera-node.toml")
    assert f"`chown root:mocapd-node {node} && chmod 640 {node}`" in told(node)


def test_a_password_on_the_command_line_is_told(file: Path) -> None:
    assert "command line" in told(file, camera=f'[{{id = "a", source = "{URL}"}}]')
    assert told(file, camera='[{id = "a", source = "/dev/video0"}]') == ""


def test_pictures_of_the_wearer_that_others_may_see_are_told(file: Path) -> None:
    state = file.parent / "state"
    state.mkdir(mode=0o755)
    assert told(file) == ""  # nothing is in it
    (state / "calibration.toml").touch()
    assert f"chmod 700 {state}" in told(file)
    (state / "cameras.secret.toml").touch(0o644)
    assert told(file).count("\n") == 1
    state.chmod(0o700)
    (state / "cameras.secret.toml").chmod(0o600)
    assert told(file) == ""


def test_check_config_shows_no_password_and_what_is_unsafe(
    clean_env: dict[str, str], file: Path
) -> None:
    file.chmod(0o644)
    for words in (("--json",), ()):
        outcome = mocapd_here(clean_env, "check-config", "--config", file, *words)
        assert outcome.code == 0, outcome.err
        assert "hunter2" not in outcome.out + outcome.err
        assert "admin:***@127.0.0.1:9" in outcome.out
        if words:
            json.loads(outcome.out)
        else:
            assert "# unsafe: " in outcome.out


def test_check_config_shows_what_is_unsafe_of_zenoh(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    users = tmp_path / "users"
    users.write_text("game:secret\n")
    users.chmod(0o644)
    outcome = mocapd_here(clean_env, "check-config", "--set", f"zenoh.password_file={users}")
    assert f"chmod 600 {users}" in outcome.out, outcome.err


def test_a_camera_with_an_odd_name_is_a_camera(clean_env: dict[str, str]) -> None:
    words = ("check-config", "--changed", "--json", "--camera", 'a"\n\\=usb:\x7f')
    outcome = mocapd_here(clean_env, *words)
    assert outcome.code == 0, outcome.err
    camera = json.loads(outcome.out)["camera"]["value"][0]
    assert (camera["id"], camera["source"]) == ('a"\n\\', "usb:\x7f")


def test_a_site_elsewhere_that_may_have_the_frames_is_told(file: Path) -> None:
    assert told(file, **{"web.allow_origins": '["http://localhost:8000"]'}) == ""
    lines = told(file, **{"web.allow_origins": '["https://game.example", "http://localhost:8000"]'})
    assert "lets https://game.example see" in lines
