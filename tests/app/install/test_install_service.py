"""A service installed, installed again, changed by its admin, taken away: each file as its owner would have it."""

import grp
import os
import stat
from pathlib import Path

import pytest

from mocapd.app.install import installing, interpreter
from mocapd.app.install.installing import InstallStep, InstallTarget, install, next_steps, uninstall
from mocapd.app.install.own_file import Outcome
from mocapd.app.install.places import InstallPaths, files, of_machine, unit_text
from mocapd.errors import CannotCreateError, ConfigError, PermissionDeniedError, UsageError
from tests.cli.mocapd_process import mocapd_here

UNIT = "usr/lib/systemd/system/mocapd.service"
CONFIG = "etc/mocapd/config.toml"


def outcomes(done: list[InstallStep]) -> set[Outcome]:
    return {one.outcome for one in done}


def contents(root: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_installed_twice_is_as_installed_once(tmp_path: Path) -> None:
    target = InstallTarget(root=tmp_path)
    assert outcomes(install(target)) == {Outcome.MADE}
    once = contents(tmp_path)
    assert outcomes(install(target)) == {Outcome.UNCHANGED}
    assert contents(tmp_path) == once
    modes = {path: stat.S_IMODE(path.stat().st_mode) for path in once}
    assert modes.pop(tmp_path / CONFIG) == 0o640  # it may come to hold passwords
    assert {*modes.values()} == {0o644}


def test_the_service_may_enter_the_folder_of_its_configuration_whatever_the_umask(
    tmp_path: Path,
) -> None:
    before = os.umask(0o077)
    try:
        install(InstallTarget(root=tmp_path))
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / CONFIG).parent.stat().st_mode) == 0o755


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_the_configuration_is_of_the_services_group_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    group = grp.struct_group(("mocapd", "x", 12_345, []))
    monkeypatch.setattr(grp, "getgrnam", {"mocapd": group}.__getitem__)
    done = install(InstallTarget(root=tmp_path))
    assert (tmp_path / CONFIG).stat().st_gid == 12_345
    assert (tmp_path / UNIT).stat().st_gid == os.getegid()
    assert "chgrp" not in " ".join(next_steps(InstallTarget(), done))


def test_where_the_group_is_still_to_be_made_the_steps_give_it_the_configuration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(grp, "getgrnam", {}.__getitem__)
    steps = next_steps(InstallTarget(), install(InstallTarget(root=tmp_path)))
    made = steps.index("systemd-sysusers")
    assert steps.index(f"chgrp mocapd {tmp_path / CONFIG}") > made


def test_a_dry_run_says_the_same_and_changes_nothing(tmp_path: Path) -> None:
    dry = install(InstallTarget(root=tmp_path, dry_run=True))
    assert not any(tmp_path.iterdir())
    assert install(InstallTarget(root=tmp_path)) == dry
    before = contents(tmp_path)
    dry = uninstall(InstallTarget(root=tmp_path, dry_run=True))
    assert contents(tmp_path) == before
    assert uninstall(InstallTarget(root=tmp_path)) == dry


def test_another_interpreter_renews_the_units_alone(tmp_path: Path) -> None:
    install(InstallTarget(root=tmp_path, python=Path("/old/bin/python")))
    done = install(InstallTarget(root=tmp_path, python=Path("/new/bin/python")))
    renewed = {one.path.name for one in done if one.outcome is Outcome.RENEWED}
    assert renewed == {
        *(
            "mocapd.service",
            "mocapd@.service",
            "mocapd-camera-node.service",
            "mocapd-prepare.service",
        )
    }
    assert "ExecStart=/new/bin/python -P" in (tmp_path / UNIT).read_text()


def test_what_an_admin_has_changed_stays(tmp_path: Path) -> None:
    install(InstallTarget(root=tmp_path, python=Path("/old/bin/python")))
    unit, config = tmp_path / UNIT, tmp_path / CONFIG
    changed = unit.read_text().replace("WatchdogSec=30", "WatchdogSec=90")
    unit.write_text(changed)
    config.write_text("instance = 'hall'\n")
    done = install(InstallTarget(root=tmp_path))
    assert unit.read_text() == changed
    assert config.read_text() == "instance = 'hall'\n"
    beside = unit.with_name("mocapd.service.new")
    assert "WatchdogSec=30" in beside.read_text()
    assert {one.path for one in done if one.outcome is Outcome.KEPT} == {unit}
    assert str(unit) in installing.changed_files_hint(done)
    assert {
        one.path for one in uninstall(InstallTarget(root=tmp_path)) if one.outcome is Outcome.KEPT
    } == {unit}
    assert {path.name for path in contents(tmp_path)} == {"mocapd.service", "config.toml"}


def test_uninstalled_leaves_the_configuration_alone(tmp_path: Path) -> None:
    install(InstallTarget(root=tmp_path))
    assert outcomes(uninstall(InstallTarget(root=tmp_path))) == {Outcome.REMOVED}
    assert {*contents(tmp_path)} == {tmp_path / CONFIG}
    assert outcomes(uninstall(InstallTarget(root=tmp_path))) == {Outcome.ABSENT}


def test_an_enabled_service_is_not_pulled_away(
    empty_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SUDO_USER", raising=False)
    units = empty_home / "config/systemd/user"
    install(InstallTarget(user=True))
    wants = units / "default.target.wants"
    wants.mkdir()
    (wants / "mocapd.service").symlink_to(units / "mocapd.service")
    with pytest.raises(ConfigError, match=r"systemctl --user disable --now mocapd\.service"):
        uninstall(InstallTarget(user=True))
    assert (units / "mocapd.service").exists()
    (wants / "mocapd.service").unlink()
    assert outcomes(uninstall(InstallTarget(user=True))) == {Outcome.REMOVED}


def test_only_root_installs_for_the_machine_and_sudo_not_for_a_user(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(PermissionDeniedError, match="only root") as refused:
        install(InstallTarget(), euid=1000)
    assert refused.value.exit_code == 77
    monkeypatch.setenv("SUDO_USER", "someone")
    with pytest.raises(UsageError, match="root's own service"):
        install(InstallTarget(user=True), euid=0)


def test_a_service_is_not_given_an_interpreter_that_it_cannot_see(tmp_path: Path) -> None:
    """Its sandbox hides homes and /tmp, and its user is nobody's friend."""
    python = tmp_path / "venv/bin/python"
    python.parent.mkdir(parents=True)
    python.touch(0o755)
    with pytest.raises(ConfigError, match=r"does not see .* --user"):
        interpreter.require_visible((python,), hidden=(tmp_path,))
    for folder in (tmp_path, *tmp_path.parents):
        if os.access(folder, os.W_OK) and folder.stat().st_uid == os.geteuid():
            folder.chmod(folder.stat().st_mode | 0o711)
    interpreter.require_visible((python,), hidden=())
    (tmp_path / "venv").chmod(0o700)
    with pytest.raises(ConfigError, match=f"may not look into {tmp_path}/venv"):
        interpreter.require_visible((python,), hidden=())


def test_a_link_out_of_the_environment_is_looked_at_as_well(tmp_path: Path) -> None:
    real = tmp_path / "home/python"
    real.parent.mkdir()
    real.touch(0o755)
    link = tmp_path / "opt/python"
    link.parent.mkdir()
    link.symlink_to(real)
    assert {link, real} <= {*interpreter.required_paths(link)}


@pytest.mark.parametrize(
    ("path", "written"),
    [
        ("/opt/m/bin/python", "ExecStart=/opt/m/bin/python -P"),
        ("/opt/my tools/python", 'ExecStart="/opt/my tools/python" -P'),
        ("/opt/100%/python", "ExecStart=/opt/100%%/python -P"),
    ],
)
def test_paths_are_written_as_systemd_reads_them(path: str, written: str) -> None:
    assert written in unit_text("mocapd.service", Path(path))


@pytest.mark.parametrize(
    "path", ["python", '/opt/"/python', "/opt/a\nExecStartPre=/bin/b", "/$HOME/p"]
)
def test_a_path_that_would_mean_something_else_is_refused(path: str) -> None:
    with pytest.raises(ConfigError, match=r"whole path, from / on.*plainer path"):
        unit_text("mocapd.service", Path(path))


def test_a_folder_where_the_unit_belongs_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / UNIT).mkdir(parents=True)
    with pytest.raises(CannotCreateError, match="cannot be read"):
        install(InstallTarget(root=tmp_path))


def test_the_machines_own_has_each_file_once_and_says_what_comes_next() -> None:
    places = of_machine()
    paths = [one.path for one in files(places, Path("/opt/m/bin/python"))]
    assert len(paths) == len({*paths}) == 7
    assert all(path.is_relative_to("/etc") for path in paths)
    fresh = [InstallStep(path, Outcome.MADE, False) for path in paths]
    steps = "\n".join(next_steps(InstallTarget(), fresh))
    for word in ("systemd-sysusers", "daemon-reload", "enable --now"):
        assert word in steps
    again = [InstallStep(path, Outcome.UNCHANGED, False) for path in paths]
    assert "daemon-reload" not in "\n".join(next_steps(InstallTarget(), again))


def test_a_user_has_one_unit_and_no_configuration(
    empty_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SUDO_USER", raising=False)
    (one,) = install(InstallTarget(user=True))
    assert one.path == empty_home / "config/systemd/user/mocapd.service"
    assert not (empty_home / "config/mocapd").exists()


@pytest.mark.parametrize(
    ("target", "unit", "undo"),
    [
        (
            InstallTarget(),
            "system",
            "`sudo systemctl disable --now mocapd; sudo mocapd uninstall-service;",
        ),
        (
            InstallTarget(user=True),
            "user",
            "mocapd uninstall-service --user; systemctl --user daemon-reload;",
        ),
    ],
)
def test_what_it_hides_of_a_package_is_told_with_the_way_back(
    target: InstallTarget, unit: str, undo: str, tmp_path: Path
) -> None:
    assert installing.hidden_hint(target, tmp_path) == ""
    install(InstallTarget(root=tmp_path))
    hint = installing.hidden_hint(target, tmp_path)
    assert f"{tmp_path}/usr/lib/systemd/{unit}/mocapd.service" in hint
    assert undo in hint
    assert "config.toml" not in hint
    assert installing.hidden_hint(InstallTarget(root=tmp_path), tmp_path) == ""


def test_no_place_no_file() -> None:
    assert not [*files(InstallPaths(None, None), Path("/opt/m/bin/python"))]


def test_the_commands_say_what_they_do(clean_env: dict[str, str], tmp_path: Path) -> None:
    root = tmp_path / "package"
    made = mocapd_here(clean_env, "install-service", "--root", root)
    assert made.code == 0, made.err
    assert f"{root / UNIT} " in made.out
    assert made.out.count(" made\n") == 8
    (root / UNIT).write_text("[Service]\n")
    again = mocapd_here(clean_env, "install-service", "--root", root)
    assert "yours, left alone" in again.out
    assert "move your changes into a drop-in" in again.err
    gone = mocapd_here(clean_env, "uninstall-service", "--root", root)
    assert gone.out.count(" removed\n") == 6
    both = mocapd_here(clean_env, "install-service", "--root", root, "--user")
    assert (both.code, both.err.count("\n")) == (2, 1)
