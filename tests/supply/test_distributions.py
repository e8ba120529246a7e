"""What is built of the checkout is whole: the wheel runs where there is no checkout, and the source makes the same wheel."""

import signal
import subprocess
import time
import zipfile
from pathlib import Path

import pytest

from tests.cli.own_time import end_within
from tests.outputs.frames import free_port
from tests.supply.distributions import Installed, build, install, package_files
from tests.supply.lock_files import ROOT


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(ROOT, "wheel", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return install(wheel, tmp_path_factory.mktemp("installed") / "env")


@pytest.fixture
def elsewhere(clean_env: dict[str, str]) -> dict[str, str]:
    """The environment of a user who has no checkout, and has never started mocapd."""
    home = Path(clean_env["HOME"])
    env = {name: value for name, value in clean_env.items() if name != "PYTHONPATH"}
    return env | {"XDG_CACHE_HOME": str(home / "cache")}


def names(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as opened:
        return {name for name in opened.namelist() if ".dist-info/" not in name}


def test_the_wheel_holds_every_file_of_the_package_and_of_calib(wheel: Path) -> None:
    held = names(wheel)
    assert held == package_files()
    # one of each kind, by name: that package_files() is no empty promise
    for one in (
        *("systemd/mocapd.service", "systemd/sandbox.conf", "calib/scenarios/living_room.toml"),
        *("calib/shirt_standard_v1.json", "web/page/index.html", "web/page/live.js"),
        "published/hecht2009/face/lbpcascade_frontalface.xml",
    ):
        assert f"mocapd/{one}" in held


def test_the_wheel_holds_nothing_of_the_lab_and_no_test(wheel: Path) -> None:
    assert {name.split("/")[0] for name in names(wheel)} == {"mocapd"}


def test_the_source_distribution_makes_the_same_wheel_and_has_tests_and_pages(
    wheel: Path, tmp_path: Path
) -> None:
    sdist = build(ROOT, "sdist", tmp_path / "sdist")
    # Debian 12's own Python has no safe way of its own to unpack
    subprocess.run(["tar", "-xzf", sdist, "-C", tmp_path], check=True)
    source = tmp_path / sdist.name.removesuffix(".tar.gz")
    assert names(build(source, "wheel", tmp_path / "again")) == names(wheel)
    for one in (
        "Makefile",
        "locks/run.txt",
        "tests/conftest.py",
        "docs/service.md",
        "deb/build.sh",
        "lab/README.md",
    ):
        assert (source / one).is_file()


def test_installed_it_is_found_where_it_was_installed(
    installed: Installed, elsewhere: dict[str, str]
) -> None:
    where = installed.asks(elsewhere, "import mocapd; print(mocapd.__file__)")
    assert Path(where).is_relative_to(installed.folder)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("check-config", "--set", "tracker.stature_m=1.75"), "stature_m"),
        (("install-service", "--user", "--dry-run"), "mocapd.service"),
        (
            ("install-service", "--root", "{}", "--python", "/usr/lib/mocapd/bin/python"),
            "sysusers.d",
        ),
        (("man",), "mocapd"),
        (("shirt", "--out", "{}/shirt.pdf"), ""),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_installed_its_commands_do_what_they_say(
    words: tuple[str, ...],
    said: str,
    installed: Installed,
    elsewhere: dict[str, str],
    tmp_path: Path,
) -> None:
    argv = [str(installed.command), *(word.format(tmp_path) for word in words)]
    done = subprocess.run(
        argv, env=elsewhere, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert said in done.stdout


def test_installed_the_demo_begins_and_ends_well(
    installed: Installed, elsewhere: dict[str, str], tmp_path: Path
) -> None:
    """As far as to where something that is made once is being made; that goes on for a minute."""
    cache = Path(elsewhere["XDG_CACHE_HOME"])
    process = subprocess.Popen(
        [installed.command, "demo", "--set", f"zenoh.port={free_port()}"],
        env=elsewhere,
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        while not {"pose_database-beginning.lock", "sim-living_room-beginning.lock"} & {
            p.name for p in cache.rglob("*.lock")
        }:
            if process.poll() is not None:
                pytest.fail(f"it ended before it made anything: {process.communicate()[1]}")
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        _, err = end_within(process, 2.0)
    assert process.returncode == 0, err
    assert "Traceback" not in err
