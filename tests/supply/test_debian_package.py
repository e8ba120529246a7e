"""The Debian package holds what an admin expects of one, and nothing of where it was made.

That it installs, runs and goes is shown under a real systemd: tests/vm/deb_proof.sh.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.supply.distributions import SITE, build
from tests.supply.lock_files import ROOT

DEBIANS = Path("/usr/bin/python3")


def _skipped_for() -> str:
    if shutil.which("dpkg-deb") is None or not DEBIANS.exists():
        return "this is no Debian"
    asked = [str(DEBIANS), "-c", "import sys; print(*sys.version_info[:2])"]
    version = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split()
    if version != [str(part) for part in sys.version_info[:2]]:
        return "what is here to run mocapd on is not for the Python that packages stand on"
    return ""


pytestmark = pytest.mark.skipif(bool(_skipped_for()), reason=_skipped_for())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(ROOT, "wheel", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def package(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(wheel, tmp_path_factory.mktemp("deb"))


def made(wheel: Path, folder: Path, **more: str) -> Path:
    """The package, made in this folder without what mocapd runs on: that is there already."""
    unset = ("PYTHONPATH", "DEBFULLNAME", "DEBEMAIL")
    env = {name: value for name, value in os.environ.items() if name not in unset}
    env |= {"XDG_CACHE_HOME": str(folder / "cache"), "TMPDIR": str(folder)} | more
    argv = [str(ROOT / "deb/build.sh"), sys.executable, str(wheel), str(folder / "out"), str(SITE)]
    done = subprocess.run(argv, env=env, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (package,) = (folder / "out").iterdir()
    return package


@pytest.fixture(scope="module")
def unpacked(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("unpacked")
    subprocess.run(["dpkg-deb", "--raw-extract", str(package), str(folder)], check=True)
    return folder


def test_it_is_for_this_python_and_says_so(package: Path) -> None:
    asked = ["dpkg-deb", "--field", str(package), "Depends"]
    depends = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    minor = sys.version_info.minor
    assert f"python3 (>= 3.{minor}~), python3 (<< 3.{minor + 1}~)" in depends


def test_made_again_elsewhere_by_somebody_else_it_is_the_same_to_the_byte_but_for_the_name(
    package: Path, wheel: Path, tmp_path: Path
) -> None:
    """It names nobody as its maintainer unless told; both names here are of one length, so that only they differ."""
    other = tmp_path / "another folder"
    other.mkdir()
    copy = Path(shutil.copy(wheel, other))
    told = {"DEBFULLNAME": "Hall & Söhne", "DEBEMAIL": "ha@example.org"}
    again = made(copy, other, LANG="C", LC_ALL="C", TZ="Asia/Tokyo", **told)
    assert again.name == package.name
    nobody, somebody = (
        f"Maintainer: {one}\n".encode()
        for one in ("mocapd <mocapd@nobody.invalid>", "Hall & Söhne <ha@example.org>")
    )
    assert len(nobody) == len(somebody)
    assert control_tar(package).count(nobody) == 1
    assert control_tar(again).replace(somebody, nobody) == control_tar(package)
    assert around_control(again) == around_control(package)


def control_tar(package: Path) -> bytes:
    asked = ["dpkg-deb", "--ctrl-tarfile", str(package)]
    return subprocess.run(asked, capture_output=True, check=True).stdout


def around_control(package: Path) -> tuple[bytes, bytes]:
    """The package's bytes before the size of its compressed control files, and after these."""
    whole = package.read_bytes()
    stamped = whole.index(b"control.tar.zst") + 48  # name, date, owner, group and mode
    return whole[:stamped], whole[whole.index(b"data.tar.zst") :]


def test_the_units_start_what_is_in_the_package(unpacked: Path) -> None:
    python = unpacked / "usr/lib/mocapd/bin/python"
    start = f"ExecStart=/{python.relative_to(unpacked)} -P -m mocapd.cli.main"
    for unit, command in (
        ("system/mocapd.service", "run"),
        ("system/mocapd@.service", "run"),
        ("system/mocapd-camera-node.service", "camera-node"),
        ("system/mocapd-prepare.service", "prepare"),
        ("user/mocapd.service", "run"),
    ):
        assert f"{start} {command}\n" in (unpacked / "usr/lib/systemd" / unit).read_text()
    assert python.is_symlink()
    assert python.resolve() == DEBIANS.resolve()
    assert (unpacked / "usr/bin/mocapd").resolve() == unpacked / "usr/lib/mocapd/bin/mocapd"


def test_everything_around_the_program_is_placed(unpacked: Path) -> None:
    for path in (
        *("usr/lib/sysusers.d/mocapd.conf", "usr/share/man/man1/mocapd.1.gz"),
        "usr/share/bash-completion/completions/mocapd",
        *("usr/share/doc/mocapd/docs/README.md", "usr/share/doc/mocapd/docs/images/setup_room.jpg"),
        *("usr/share/doc/mocapd/copyright", "usr/share/doc/mocapd/examples/network.conf.example"),
    ):
        assert (unpacked / path).stat().st_size > 0


def test_the_links_of_its_documents_lead_to_others(unpacked: Path) -> None:
    """All but those to clients and the lab, which are not in the package."""
    doc = unpacked / "usr/share/doc/mocapd"
    for document in (doc / "README.md", *(doc / "docs").glob("*.md")):
        for link in re.findall(r"\]\(([^)#\s]+)", document.read_text("utf-8")):
            target = Path(os.path.normpath(document.parent / link))
            if "://" not in link and not {"clients", "lab"} & set(target.relative_to(doc).parts):
                assert target.exists(), f"{document.name}: {link}"


def test_an_update_asks_before_it_changes_the_configuration(unpacked: Path) -> None:
    assert (unpacked / "DEBIAN/conffiles").read_text().split() == ["/etc/mocapd/config.toml"]
    assert (unpacked / "etc/mocapd/config.toml").is_file()


def test_it_is_roots_whoever_made_it_and_others_may_only_read(package: Path) -> None:
    asked = ["dpkg-deb", "--contents", str(package)]
    listing = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(listing) > 100
    for line in listing:
        mode, owner, *_ = line.split()
        assert owner == "root/root"
        others = "-" if line.endswith("/etc/mocapd/config.toml") else "r"  # it may hold passwords
        assert mode[0] == "l" or (mode[5], mode[7], mode[8]) == ("-", others, "-"), line


def test_every_module_is_compiled_so_that_root_leaves_nothing_behind(unpacked: Path) -> None:
    (library,) = (unpacked / "usr/lib/mocapd/lib").glob("python3*")
    own = library / "site-packages/mocapd"
    modules = {path.relative_to(own) for path in own.rglob("*.py")}
    compiled = {
        path.parent.parent.relative_to(own) / f"{path.name.split('.')[0]}.py"
        for path in own.rglob("*.pyc")
    }
    assert modules == compiled


@pytest.mark.parametrize("name", ["postinst", "prerm", "postrm"])
def test_its_scripts_are_what_a_plain_shell_reads_and_enable_nothing(
    name: str, unpacked: Path
) -> None:
    script = unpacked / "DEBIAN" / name
    assert os.access(script, os.X_OK)
    subprocess.run(["sh", "-n", str(script)], check=True)
    commands = [line for line in script.read_text().splitlines() if "systemctl" in line]
    assert not [
        line for line in commands if line.split()[:2] == ["systemctl", "enable"] and "#" not in line
    ]


@pytest.mark.parametrize("restarts", [True, False])
def test_an_update_after_which_the_service_does_not_start_is_installed_and_told(
    restarts: bool, unpacked: Path, tmp_path: Path
) -> None:
    """As where a key of the configuration is gone: else every later call of apt would fail."""
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in ("systemd-sysusers", "systemctl"):
        fails = tool == "systemctl" and not restarts
        (tools / tool).write_text(f'#!/bin/sh\n[ "$1" != try-restart ] || exit {int(fails)}\n')
        (tools / tool).chmod(0o755)
    (tmp_path / "confmodule").write_text("db_stop() { :; }\n")
    script = (unpacked / "DEBIAN/postinst").read_text()
    script = script.replace("/run/systemd/system", str(tmp_path))
    script = script.replace("/usr/share/debconf/confmodule", str(tmp_path / "confmodule"))
    done = subprocess.run(
        ["sh", "-c", script, "postinst", "configure", "0.0.9"],
        env={"PATH": f"{tools}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0
    assert ("did not start again" in done.stderr) is not restarts
