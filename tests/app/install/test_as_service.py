"""A command that goes on as the service: its user and directories, the caller's terminal, refused to all but root."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mocapd.app.install.service_user import become, call_like, main_pid, unit_of
from mocapd.errors import PermissionDeniedError, UnavailableError, UsageError

NO_PID = 2**22 + 1  # more than any machine gives


@pytest.fixture
def service_pid() -> Iterator[int]:
    """Some process with a service's environment; this one has another."""
    env = {
        "RUNTIME_DIRECTORY": "/run/mocapd",
        "MOCAPD_CONFIG": "/etc/mocapd/hall.toml",
        "NOTIFY_SOCKET": "/run/notify",
        "WATCHDOG_USEC": "1",
        "TERM": "dumb",
    }
    with subprocess.Popen(["yes"], env=env, stdout=subprocess.PIPE) as process:
        assert process.stdout
        process.stdout.readline()  # a process has no environment yet for a moment after it is made
        yield process.pid
        process.kill()


def test_it_is_as_the_service_is(service_pid: int) -> None:
    call = call_like(service_pid, ["cameras", "--json"], {"TERM": "xterm", "HOME": "/root"})
    assert call.env == {
        "RUNTIME_DIRECTORY": "/run/mocapd",
        "MOCAPD_CONFIG": "/etc/mocapd/hall.toml",
        "TERM": "xterm",
    }
    assert call.argv[:3] == (shutil.which("nsenter"), f"--target={service_pid}", "--mount")
    groups = [word for word in call.argv if word.startswith(("--groups=", "--clear-groups"))]
    wanted = ",".join(map(str, os.getgroups()))
    assert groups == [f"--groups={wanted}" if wanted else "--clear-groups"]
    assert f"--reuid={os.getuid()}" in call.argv
    assert call.argv[-6:] == (sys.executable, "-P", "-m", "mocapd.cli.main", "cameras", "--json")


@pytest.mark.parametrize(
    "name", ["LD_PRELOAD", "LD_LIBRARY_PATH", "PATH", "PYTHONPATH", "PYTHONHOME"]
)
def test_a_service_that_was_broken_into_has_root_run_nothing_of_its_own(
    name: str, tmp_path: Path
) -> None:
    """It may write what it likes into its own environment, by which root's tools would be found and linked."""
    trap = tmp_path / "nsenter"
    trap.write_text("#!/bin/sh\n")
    trap.chmod(0o755)
    yes = shutil.which("yes")
    assert yes
    with subprocess.Popen([yes], env={name: str(tmp_path)}, stdout=subprocess.PIPE) as process:
        assert process.stdout
        process.stdout.readline()
        call = call_like(process.pid, ["version"], {"PATH": "/usr/bin:/bin"})
        process.kill()
    assert str(tmp_path) not in " ".join([*call.argv, *call.env.values()])
    assert Path(call.argv[0]).is_absolute()
    assert Path(call.argv[call.argv.index("--") + 1]).is_absolute()


@pytest.mark.skipif(
    os.geteuid() != 0 or not all(map(shutil.which, ("nsenter", "setpriv"))),
    reason="only root enters what another process sees",
)
def test_the_call_runs(service_pid: int) -> None:
    call = call_like(service_pid, ["version"], os.environ)
    assert call.env["RUNTIME_DIRECTORY"]
    env = {**call.env, "PYTHONPATH": os.environ.get("PYTHONPATH", str(Path.cwd()))}
    done = subprocess.run(call.argv, env=env, capture_output=True, text=True, check=False)
    if "Operation not permitted" in done.stderr and done.stderr.startswith("nsenter"):
        pytest.skip("no namespaces here")
    assert (done.returncode, done.stderr) == (0, "")


def test_a_service_that_has_just_ended_is_told() -> None:
    with pytest.raises(UnavailableError, match="just ended"):
        call_like(NO_PID, ["version"])


@pytest.mark.parametrize("rig", ["..", ".x", "a/b", "a b", "-" * 65, "%i", "ä"])
def test_what_is_no_rig_is_none(rig: str) -> None:
    with pytest.raises(UsageError, match="no rig's name"):
        unit_of(rig)


def test_the_units_of_rigs() -> None:
    assert unit_of("") == "mocapd.service"
    assert unit_of("hall") == "mocapd@hall.service"


@pytest.mark.parametrize("told", ["0", "", "no such unit"])
def test_a_service_that_does_not_run_is_told(
    told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    systemctl = tmp_path / "systemctl"
    systemctl.write_text(f"#!/bin/sh\necho '{told}'\n")
    systemctl.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    with pytest.raises(UnavailableError, match=r"systemctl start mocapd\.service"):
        main_pid("mocapd.service")


def test_without_systemd_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(UnavailableError, match="run by systemd"):
        main_pid("mocapd.service")


def test_nobody_but_root_becomes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(PermissionDeniedError, match="only root"):
        become("", ["version"])
