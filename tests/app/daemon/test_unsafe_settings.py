"""What is permitted although it is unsafe is told in one line each, and passwords are not shown."""

import json
from pathlib import Path

import pytest

from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.config.effective import load_config
from tests.cli.mocapd_process import mocapd

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
        outcome = mocapd(clean_env, "check-config", "--config", file, *words)
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
    outcome = mocapd(clean_env, "check-config", "--set", f"zenoh.password_file={users}")
    assert f"chmod 600 {users}" in outcome.out, outcome.err


def test_a_camera_with_an_odd_name_is_a_camera(clean_env: dict[str, str]) -> None:
    words = ("check-config", "--changed", "--json", "--camera", 'a"\n\\=usb:\x7f')
    outcome = mocapd(clean_env, *words)
    assert outcome.code == 0, outcome.err
    camera = json.loads(outcome.out)["camera"]["value"][0]
    assert (camera["id"], camera["source"]) == ('a"\n\\', "usb:\x7f")


def test_a_site_elsewhere_that_may_have_the_frames_is_told(file: Path) -> None:
    assert told(file, **{"web.allow_origins": '["http://localhost:8000"]'}) == ""
    lines = told(file, **{"web.allow_origins": '["https://game.example", "http://localhost:8000"]'})
    assert "lets https://game.example see" in lines
