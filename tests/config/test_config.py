"""What a user meets in the configuration: precedence, origins, and messages that say the mend."""

import math
import os
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import pytest
from msgspec import Meta

from mocapd.config.config_keys import SectionTable, as_toml, build, keys_of
from mocapd.config.effective import Effective, load_config
from mocapd.config.sections import CameraSection
from mocapd.errors import ConfigError, InputError
from mocapd.outputs.output_table import OscSection, zenoh_section
from mocapd.pipeline.bundler import BundlerParams
from mocapd.session.camera_inputs import bundler_params


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "config.toml"


def load(file: Path, text: str, **env: str) -> Effective:
    file.write_text(text)
    return load_config(file=file, env=env)


def error_of(file: Path, text: str) -> ConfigError:
    with pytest.raises(ConfigError) as caught:
        load(file, text)
    return caught.value


def origin(effective: Effective, path: str) -> str:
    return next(s.origin for s in effective.settings if s.key.path == path)


def test_without_any_source_everything_is_built_in() -> None:
    effective = load_config(env={}, candidates=())
    assert not any(setting.is_changed for setting in effective.settings)
    assert zenoh_section(effective.config.outputs).port == 7447
    assert effective.file is None


def test_flag_beats_environment_beats_file_beats_built_in(file: Path) -> None:
    file.write_text("[zenoh]\nport = 1\nformat = 'json'\nconnect_timeout_s = 9\n")
    env = {"MOCAPD_ZENOH_PORT": "2", "MOCAPD_ZENOH_FORMAT": "msgpack"}
    effective = load_config({"zenoh.port": "3"}, file, env)
    zenoh = zenoh_section(effective.config.outputs)
    assert (zenoh.port, zenoh.format, zenoh.connect_timeout_s) == (3, "msgpack", 9.0)
    assert origin(effective, "zenoh.port") == "command line"
    assert origin(effective, "zenoh.format") == "environment MOCAPD_ZENOH_FORMAT"
    assert origin(effective, "zenoh.connect_timeout_s") == f"{file}:4"
    assert origin(effective, "zenoh.enabled") == "built-in"


def test_how_frames_wait_for_each_other_is_set_for_all_cameras_and_for_one(file: Path) -> None:
    cameras = (
        "[[camera]]\nid = 'a'\nsource = '0'\n[[camera]]\nid = 'b'\nsource = '1'\nwait_s = 0.2\n"
    )
    config = load(file, f"{cameras}[bundler]\nwait_s = 0.1\n").config
    assert bundler_params(config) == BundlerParams(camera_waits_s={"a": 0.1, "b": 0.2})
    config = load(file, cameras).config
    assert bundler_params(config) == BundlerParams(camera_waits_s={"b": 0.2})
    assert bundler_params(load(file, "").config) == BundlerParams()
    error = error_of(file, cameras.replace("0.2", "20"))
    assert error.what == "camera[1].wait_s = 20 does not do"
    assert "wait_s a number from 0" in error.fix


def test_the_users_file_comes_before_the_machines(tmp_path: Path) -> None:
    user, machine = tmp_path / "user.toml", tmp_path / "machine.toml"
    machine.write_text("instance = 'machine'")
    assert load_config(env={}, candidates=(user, machine)).config.instance == "machine"
    user.write_text("instance = 'user'")
    assert load_config(env={}, candidates=(user, machine)).config.instance == "user"


def make_unreadable(path: Path, kind: str) -> None:
    """Something at `path` that is there and is no readable file."""
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case "link to nothing":
            path.symlink_to(path.parent / "share" / "config.toml")
        case "link to itself":
            path.symlink_to(path)
        case "link to a device":
            path.symlink_to("/dev/zero")
        case "folder that leads to nothing":
            path.parent.rmdir()
            path.parent.symlink_to(path.parent.parent / "share")


@pytest.mark.parametrize(
    "kind",
    [
        "pipe",
        "folder",
        "link to nothing",
        "link to itself",
        "link to a device",
        "folder that leads to nothing",
    ],
)
def test_a_config_file_that_cannot_be_read_is_never_taken_for_none(
    tmp_path: Path, kind: str
) -> None:
    path = tmp_path / "etc" / "config.toml"
    path.parent.mkdir()
    make_unreadable(path, kind)
    with pytest.raises(InputError, match="the config file") as caught:
        load_config(env={}, candidates=(tmp_path / "none.toml", path))
    assert caught.value.where == str(path)


def test_the_file_may_be_named_by_the_environment(file: Path) -> None:
    file.write_text("instance = 'here'")
    assert load_config(env={"MOCAPD_CONFIG": str(file)}).config.instance == "here"


def test_a_named_file_must_exist(file: Path) -> None:
    with pytest.raises(InputError, match="no such config file"):
        load_config(file=file, env={})


@pytest.mark.parametrize(
    ("text", "where", "what", "fix"),
    [
        ("[zenoh]\nenabled = true\nprot = 7447\n", ":3", "'zenoh.prot'", "'zenoh.port'"),
        ("\ninstanze = 'a'\n", ":2", "'instanze'", "'instance'"),
        ("[zenho]\nport = 1\n", ":1", "'zenho'", "'zenoh'"),
        ("[zenoh]\nport = 'high'\n", ":2", 'zenoh.port = "high"', "a whole number"),
        ("[tracker]\nstature_m = 172\n", ":2", "tracker.stature_m = 172", "from 0.5 to 2.6"),
        ("log_level = 'loud'\n", ":1", 'log_level = "loud"', '"warning"'),
        ("osc = true\n", ":1", "osc = true", "write [osc]"),
        ("[camera]\nid = 'a'\n", ":1", "[camera] is not a section", "[[camera]]"),
        ("[[camera]]\nid = 'a'\n", ":1", "camera[0] has no 'source'", "add source"),
        (
            "[[camera]]\nid = 'a'\nsource = '0'\n\n[[camera]]\nid = 'b'\nsource = '1'\nfsp_hz = 30\n",
            ":8",
            "'camera[1].fsp_hz'",
            "'fps_hz'",
        ),
        (
            "[[camera]]\nid = 'a'\nsource = '0'\n[camera.controls]\nexposure = 'dim'\n",
            ":5",
            'camera[0].controls.exposure = "dim"',
            "a whole number",
        ),
        (
            "[[camera]]\nid = 'a'\nsource = '0'\n[[camera]]\nid = 'a'\nsource = '1'\n",
            ":1",
            "two cameras have the id 'a'",
            "rename",
        ),
        ("a = \n", ":1", "not valid TOML", "mend"),
        ("[zenoh]\nport = 70000\n", ":2", "70000", "a port from 1 to 65535"),
        ("[osc]\ndestinations = ['localhost:1']\n", ":2", "'localhost:1'", "not localhost"),
    ],
)
def test_an_error_names_place_value_and_mend(
    file: Path, text: str, where: str, what: str, fix: str
) -> None:
    error = error_of(file, text)
    assert error.exit_code == 78
    assert error.where.startswith(f"{file}{where}")
    assert what in error.what
    assert fix in error.fix


@pytest.mark.parametrize(
    ("flag", "text", "example"),
    [
        ("osc.destinations", "1", """--set 'osc.destinations=["1"]'"""),
        (
            "osc.destinations",
            "[127.0.0.1:9000, 127.0.0.1:9001]",  # as a shell leaves ["...", "..."]
            """--set 'osc.destinations=["127.0.0.1:9000", "127.0.0.1:9001"]'""",
        ),
        ("node.size_px", "640, 480", "--set 'node.size_px=[640, 480]'"),
        ("node.size_px", "large", "--set 'node.size_px=[1, 1]'"),
    ],
)
def test_the_error_of_a_list_has_an_example_as_it_is_typed(
    flag: str, text: str, example: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config({flag: text}, env={}, candidates=())
    assert caught.value.fix.endswith(f", such as {example}")


@pytest.mark.parametrize("text", ['a "quoted" word', "back\\slash", "Küche", "two\nlines"])
def test_text_is_shown_as_toml_reads_it(text: str) -> None:
    assert tomllib.loads(f"v = {as_toml([text])}") == {"v": [text]}


def test_the_error_of_a_list_in_a_file_has_an_example(file: Path) -> None:
    error = error_of(file, "[osc]\ndestinations = '127.0.0.1:9000'\n")
    assert error.fix.endswith('a list, each of it text, such as ["127.0.0.1:9000"]')


def test_an_unknown_variable_is_an_error_with_the_nearest_name() -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(env={"MOCAPD_ZENOH_PROT": "1"}, candidates=())
    assert "MOCAPD_ZENOH_PROT" in caught.value.what
    assert "MOCAPD_ZENOH_PORT" in caught.value.fix
    with pytest.raises(ConfigError) as caught:
        load_config(env={"MOCAPD_FOO": "1"}, candidates=())
    assert "MOCAPD_" not in caught.value.fix  # no key is like it but for the beginning of all


def test_a_wrong_variable_names_the_variable() -> None:
    with pytest.raises(ConfigError, match=r"environment MOCAPD_OSC_ENABLED: osc.enabled = "):
        load_config(env={"MOCAPD_OSC_ENABLED": "perhaps"}, candidates=())


def test_text_in_the_environment_needs_no_quotes_and_lists_are_toml() -> None:
    env = {
        "MOCAPD_INSTANCE": "12",
        "MOCAPD_OSC_ENABLED": "false",
        "MOCAPD_OSC_DESTINATIONS": '["127.0.0.1:9000"]',
        "MOCAPD_CAMERA": '[{id = "a", source = "/dev/video0", controls = {gain = 3}}]',
    }
    config = load_config(env=env, candidates=()).config
    assert config.instance == "12"
    osc = config.outputs["osc"]
    assert osc == OscSection(destinations=("127.0.0.1:9000",), enabled=False)
    assert config.camera[0].controls.gain == 3


def test_paths_in_a_file_are_meant_from_that_file(file: Path) -> None:
    (file.parent / "left.mp4").write_bytes(b"")
    text = (
        "rig = 'rig.json'\n"
        "[[camera]]\nid = 'l'\nsource = 'left.mp4'\nwhite_balance = 'l.png'\n"
        "[[camera]]\nid = 'r'\nsource = 'rtsp://host/left.mp4'\n"
    )
    config = load(file, text).config
    assert config.rig == file.parent / "rig.json"
    assert config.camera[0].source == str(file.parent / "left.mp4")
    assert config.camera[0].white_balance == file.parent / "l.png"
    assert config.camera[1] == CameraSection("r", "rtsp://host/left.mp4")


@pytest.mark.parametrize(
    "text",
    [
        "zenoh.port = " + "9" * 5000,
        "zenoh.port = 0x" + "f" * 5000,
        "a = " + "[" * 2000,
        "a" + ".a" * 600 + " = 1",
        "rig = '~nosuchuser/rig.json'",
        'cache_dir = "a\\u0000b"',
        "[[camera]]\nid = 'a'\nsource = '~nosuchuser/a.mp4'",
        "[[camera]]\nid = 'a'\nsource = '0'\nfps_hz = 1e-300",
        "[[camera]]\nid = 'a'\nsource = '0'\ncontrols.exposure = 10000000000",
        "tracker.coast_s = nan",
        "instance = '" + "x" * 1300 + "'",
        "a" + " " * 3000 + "b\n" + "zenoh.port = 'high'",
        "\0",
    ],
    ids=range(13),  # pytest would write the texts out
)
def test_no_text_of_a_file_ends_in_a_traceback(file: Path, text: str) -> None:
    error = error_of(file, text)
    assert str(file) in error.where
    assert error.fix
    assert len(str(error)) < 1000


@pytest.mark.parametrize("text", ["9" * 5000, "0x" + "f" * 5000, "[" * 2000, "1e400", "\udcff"])
def test_no_text_of_a_flag_or_variable_ends_in_a_traceback(text: str) -> None:
    for flags, env in (({"zenoh.port": text}, {}), ({}, {"MOCAPD_ZENOH_PORT": text})):
        with pytest.raises(ConfigError) as caught:
            load_config(flags, env=env, candidates=())
        assert len(str(caught.value)) < 500


def test_a_path_that_is_too_long_is_no_traceback(file: Path) -> None:
    long = "x/" * 3000
    config = load(file, f"rig = '{long}'\n[[camera]]\nid = 'a'\nsource = '{long}'\n").config
    assert config.camera[0].source == long
    with pytest.raises(InputError, match="cannot be read"):
        load_config(file=Path(long), env={})


def test_what_is_no_regular_file_is_no_config_file() -> None:
    with pytest.raises(InputError, match="no regular file"):
        load_config(file=Path("/dev/zero"), env={})


def test_an_error_does_not_show_a_password(file: Path) -> None:
    error = error_of(file, "camera = [['rtsp://admin:hunter2@cam/x']]")
    assert "hunter2" not in str(error)
    error = error_of(file, "rig = ['rtsp://admin:hunter2@cam/x']")
    assert "admin:***@cam" in error.what


def test_every_key_is_documented() -> None:
    effective = load_config(env={}, candidates=())
    assert [s.key.path for s in effective.settings if not s.key.help] == []


def test_reading_the_configuration_loads_no_numba() -> None:
    """Numba reads where its cache is while it is imported, and the configuration says where."""
    code = "import sys, mocapd.config.effective; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@dataclass(frozen=True)
class _Shirt:
    """learn: whether it learns"""

    learn: bool = True


@dataclass(frozen=True)
class _Waves:
    count: Annotated[int, Meta(ge=1)] = 6


@dataclass(frozen=True)
class _Chosen:
    name: str = "shirt"
    own: Annotated[Mapping[str, Any], SectionTable(lambda: {"shirt": _Shirt, "canned": _Waves})] = (
        field(default_factory=dict)
    )


@dataclass(frozen=True)
class _Whole:
    tracker: _Chosen = field(default_factory=_Chosen)


def test_sections_of_a_table_stand_beside_the_keys_of_the_section_that_holds_them() -> None:
    keys = {key.path: key for key in keys_of(_Whole)}
    assert list(keys) == ["tracker.name", "tracker.shirt.learn", "tracker.canned.count"]
    assert keys["tracker.shirt.learn"].help == "whether it learns"
    whole = build(_Whole, {"tracker.name": "canned", "tracker.canned.count": 3})
    assert whole.tracker.own == {"shirt": _Shirt(), "canned": _Waves(3)}


def test_prediction_is_set_once_for_all_outputs(file: Path) -> None:
    text = "[prediction]\nhz = 90\nahead_ms = 10\noutputs = ['vmc', 'osc']\n"
    prediction = load(file, text).config.prediction
    assert prediction.rate_hz("osc", math.inf) == 90.0
    assert prediction.rate_hz("vmc", 60.0) == 60.0  # as much as the output lets through
    assert prediction.rate_hz("zenoh", math.inf) == 0.0
