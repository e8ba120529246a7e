"""The units as systemd itself reads them: nothing to complain of, and a sandbox as tight as a webcam allows."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mocapd.app.install.installing import InstallTarget, install
from mocapd.config.effective import load_config
from tests.conftest import ROOT

TIGHT_ENOUGH = "20"  # in tenths: 2.0 of 10, "OK"
UNITS = (
    "mocapd.service",
    "mocapd@.service",
    "mocapd-prepare.service",
    "mocapd-camera-node.service",
)


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Everything, as in a package."""
    root = tmp_path_factory.mktemp("package")
    install(InstallTarget(root=root))
    return root


@pytest.fixture
def analyze() -> str:
    """systemd-analyze; skips where there is none, unless MOCAPD_REQUIRE_SYSTEMD is set (.ci/run)."""
    found = shutil.which("systemd-analyze")
    if found is None:
        assert not os.environ.get("MOCAPD_REQUIRE_SYSTEMD"), "no systemd-analyze: install systemd"
        pytest.skip("no systemd-analyze: install systemd")
    return found


def said(*words: str | Path, env: dict[str, str] | None = None) -> tuple[int, str]:
    done = subprocess.run(
        words,
        env=os.environ | {"SYSTEMD_COLORS": "0"} | (env or {}),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    )
    return done.returncode, done.stdout


@pytest.mark.parametrize(
    "unit",
    [
        "mocapd.service",
        "mocapd@hall.service",
        "mocapd-prepare.service",
        "mocapd-camera-node.service",
    ],
)
def test_systemd_has_nothing_to_complain_of(analyze: str, package: Path, unit: str) -> None:
    path = package / "usr/lib/systemd/system" / unit
    assert said(analyze, "verify", "--man=no", path) == (0, "")


def test_nor_in_a_users_own_unit(analyze: str, package: Path, tmp_path: Path) -> None:
    path = package / "usr/lib/systemd/user/mocapd.service"
    env = {"XDG_RUNTIME_DIR": str(tmp_path)}
    assert said(analyze, "verify", "--user", "--man=no", path, env=env) == (0, "")


def test_a_drop_in_of_the_example_is_read(analyze: str, package: Path, tmp_path: Path) -> None:
    unit = tmp_path / "mocapd.service"
    shutil.copy(package / "usr/lib/systemd/system/mocapd.service", unit)
    drop_in = tmp_path / "mocapd.service.d" / "network.conf"
    drop_in.parent.mkdir()
    shutil.copy(package / "usr/share/doc/mocapd/examples/network.conf.example", drop_in)
    assert said(analyze, "verify", "--man=no", unit) == (0, "")


@pytest.mark.parametrize("unit", UNITS)
def test_the_sandbox_is_tight(analyze: str, package: Path, unit: str) -> None:
    path = package / "usr/lib/systemd/system" / unit
    words = ("security", "--offline=true", f"--threshold={TIGHT_ENOUGH}", "--no-pager")
    code, table = said(analyze, *words, path)
    assert code == 0, table
    assert "Overall exposure level" in table


@pytest.mark.skipif(shutil.which("systemd-sysusers") is None, reason="no systemd-sysusers")
def test_the_user_is_made_in_the_group_of_the_webcams(package: Path) -> None:
    path = package / "usr/lib/sysusers.d/mocapd.conf"
    code, out = said("systemd-sysusers", f"--root={package}", path)
    assert code == 0, out
    groups = (package / "etc/group").read_text()
    (members,) = re.findall(r"^video:.*:(.*)$", groups, re.MULTILINE)
    assert {*members.split(",")} == {"mocapd", "mocapd-node"}


def test_what_the_camera_node_writes_is_never_run_by_the_daemon(package: Path) -> None:
    """numba's index in the cache is unpickled."""
    folder, own = package / "usr/lib/systemd/system", ("User", "CacheDirectory", "StateDirectory")
    node, *daemons = (settings_of(folder / name, own) for name in reversed(UNITS))
    for daemon in daemons:
        assert not {*node.values()} & {*daemon.values()}
    assert node["User"] == "mocapd-node"


@pytest.mark.parametrize("unit", [*(f"system/{unit}" for unit in UNITS), "user/mocapd.service"])
def test_no_unit_takes_the_machines_memory(package: Path, unit: str) -> None:
    found = settings_of(
        package / "usr/lib/systemd" / unit, ("MemoryMax", "TasksMax", "LimitNOFILE")
    )
    assert found == {"MemoryMax": "2G", "TasksMax": "512", "LimitNOFILE": "4096"}


@pytest.mark.parametrize(
    "unit", [f"system/{UNITS[0]}", f"system/{UNITS[1]}", "user/mocapd.service"]
)
def test_an_export_that_takes_the_memory_ends_alone(package: Path, unit: str) -> None:
    """By default systemd ends the service of which one process was killed."""
    found = settings_of(package / "usr/lib/systemd" / unit, ("OOMPolicy",))
    assert found == {"OOMPolicy": "continue"}


def test_what_prepares_is_the_daemons_user_with_the_daemons_cache(package: Path) -> None:
    folder, own = package / "usr/lib/systemd/system", ("User", "CacheDirectory", "StateDirectory")
    assert settings_of(folder / UNITS[2], own) == settings_of(folder / UNITS[0], own)


def settings_of(unit: Path, names: tuple[str, ...]) -> dict[str, str]:
    """Those of these settings that the unit has."""
    lines = (line.partition("=") for line in unit.read_text().splitlines())
    return {name: value for name, _, value in lines if name in names}


def test_the_units_start_the_mocapd_that_installed_them(package: Path) -> None:
    for path in package.glob("usr/lib/systemd/*/mocapd*.service"):
        (started,) = re.findall(r"^ExecStart=(.*)$", path.read_text(), re.MULTILINE)
        command = path.stem.removeprefix("mocapd-") if "-" in path.stem else "run"
        assert started == f"{sys.executable} -P -m mocapd.cli.main {command}"
        shown = said(*started.split()[:-1], "version")
        assert shown[0] == 0, shown[1]


def test_the_sample_is_a_configuration_and_changes_nothing(
    package: Path, empty_home: Path, tmp_path: Path
) -> None:
    sample = package / "etc/mocapd/config.toml"
    assert load_config(file=sample, env={}).config == load_config(candidates=(), env={}).config


def test_each_key_of_the_sample_is_one_when_it_is_taken_up(package: Path, tmp_path: Path) -> None:
    """As an admin does: by removing its mark."""
    lines = (package / "etc/mocapd/config.toml").read_text().splitlines()
    taken = [re.sub(r"^#(?=\S)", "", line) for line in lines]
    assert taken != lines
    config = tmp_path / "config.toml"
    config.write_text("\n".join(taken))
    effective = load_config(file=config, env={})
    changed = {one.key.path for one in effective.settings if one.is_changed}
    assert {"camera", "tracker.stature_m", "zenoh.port", "vmc.enabled"} <= changed


def test_each_unit_is_stopped_before_its_package_is_removed() -> None:
    """Of the user of one that still runs, a purge could take neither the cache nor the user."""
    script = (ROOT / "deb/prerm").read_text().splitlines()
    (words,) = (shlex.split(line) for line in script if line.strip().startswith("systemctl stop"))
    assert {*words[2:]} == {unit.replace("@.", "@*.") for unit in UNITS}
