"""`mocapd calibrate` as a command: the URL it prints, what it attaches to, how it ends."""

import html
import json
import re
import signal
import stat
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

import pytest

from mocapd.wizard.saving import save_draft
from tests.cli.mocapd_process import Outcome, mocapd, mocapd_here, start
from tests.cli.small_capture import write_capture
from tests.wizard.drafts import full_draft

pytestmark = pytest.mark.long

WAIT_S = 600.0  # a busy machine compiles for long


@pytest.fixture
def env(clean_env: dict[str, str], tmp_path: Path) -> dict[str, str]:
    """Of a user whose session has a runtime directory, and no desktop."""
    runtime = tmp_path / "runtime"
    runtime.mkdir(mode=0o700)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "RUNTIME_DIRECTORY"):
        clean_env.pop(name, None)
    return clean_env | {"XDG_RUNTIME_DIR": str(runtime), "XDG_STATE_HOME": str(tmp_path / "state")}


@pytest.fixture
def cameras(tmp_path: Path) -> tuple[str, ...]:
    """As words of the command line: recordings, as webcams there are none."""
    folder = write_capture(tmp_path / "capture")
    return tuple(f"--camera={name}={folder / name}.mp4" for name in ("cam0", "cam1"))


@contextmanager
def running(env: dict[str, str], *words: str | Path) -> Iterator[subprocess.Popen[str]]:
    process = start(env, *words)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def url_of(process: subprocess.Popen[str]) -> str:
    """The one that it prints, without its fragment."""
    assert process.stdout is not None
    line = process.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:\d+/\?token=[\w-]+#setup$", line.strip())
    assert found, line + (process.stderr.read() if process.stderr and not line else "")
    return found[0].removesuffix("#setup")


def announced(env: dict[str, str], process: subprocess.Popen[str]) -> str:
    """The URL of this process's page, once it has one."""
    path = Path(env["XDG_RUNTIME_DIR"]) / "mocapd" / f"page-{process.pid}.json"
    until_s = time.monotonic() + 2 * WAIT_S  # the film may have to be rendered
    while not path.exists() and time.monotonic() < until_s:
        assert process.poll() is None, process.communicate()[1]
        time.sleep(0.1)
    told = json.loads(path.read_text())
    return f"http://127.0.0.1:{told['port']}/?token={told['token']}"


def status(url: str) -> dict[str, Any]:
    with urllib.request.urlopen(url.replace("/?", "/status?"), timeout=10) as answer:
        told: dict[str, Any] = json.load(answer)
        return told


def ended(process: subprocess.Popen[str]) -> tuple[int, float]:
    """Told by SIGTERM: its exit code, and how long it took [s]."""
    began_s = time.monotonic()
    process.send_signal(signal.SIGTERM)
    return process.wait(WAIT_S), time.monotonic() - began_s


def test_it_serves_a_setup_and_a_second_one_attaches_to_it(
    env: dict[str, str], cameras: tuple[str, ...], tmp_path: Path
) -> None:
    """Each tells the browser of a file, which only this user may read: the token is in no command line."""
    browser, shown = tmp_path / "browser", tmp_path / "told"
    words = f'tr "\\0" "\\n" < /proc/$$/cmdline > {shown}.part'
    browser.write_text(f"#!/bin/sh\n{words}\nmv {shown}.part {shown}\n")
    browser.chmod(0o700)
    desktop = env | {"BROWSER": str(browser), "DISPLAY": ":99"}
    with running(desktop, "calibrate", *cameras) as process:
        url = url_of(process)
        path = led_by(shown, url)
        told = status(url)
        assert told["cameras"] == ["cam0", "cam1"]
        assert told["setup"] == "cameras"
        second = mocapd(desktop, "calibrate", "--step", "check")
        assert second.code == 0, second.err
        assert url in second.out
        assert led_by(shown, url) == path
        until_s = time.monotonic() + WAIT_S
        while status(url)["setup"] != "check" and time.monotonic() < until_s:
            time.sleep(0.1)
        assert status(url)["setup"] == "check"
        code, _ = ended(process)
        assert code == 0
    assert not path.exists()
    assert not list(Path(env["XDG_RUNTIME_DIR"]).rglob("page*"))


def test_it_attaches_to_a_running_daemon_and_of_two_to_that_of_this_name_or_folder(
    env: dict[str, str], tmp_path: Path, simulated: str
) -> None:
    words = ("run", "--capture", simulated, "--tracker", "canned")
    off = ("--set", "zenoh.enabled=false", "--set", "osc.enabled=false")
    stage = tmp_path / "stage"
    with running(env, *words, *off, "--instance", "game") as game:
        url = announced(env, game)
        assert status(url)["setup"] is None
        outcome = mocapd_here(env, "calibrate", "--no-browser")
        assert outcome.code == 0, outcome.err
        assert outcome.out.strip() == (f"the running mocapd has the cameras; its page: {url}#setup")
        told = status(url)
        assert (told["setup"], told["tracks"]) == ("cameras", True)
        beside = ("--instance", "cave", "--set", f"state_dir={stage}")
        with running(env, *words, *off, *beside) as cave:
            urls = {"game": url, "cave": announced(env, cave)}
            for chosen, name in (
                (("--set", "instance=cave"), "cave"),
                (("--set", "instance=game"), "game"),
                (("--state-dir", stage), "cave"),
                ((), "game"),
            ):
                outcome = mocapd_here(env, "calibrate", "--no-browser", *chosen)
                assert outcome.code == 0, outcome.err
                assert urls[name] in outcome.out
            mistyped = mocapd_here(env, "calibrate", "--no-browser", "--set", "instance=caev")
            assert mistyped.code == 69
            assert "choose one that is: " in mistyped.err
            refused = mocapd_here(
                env, "calibrate", "--no-browser", "--state-dir", tmp_path / "none"
            )
            assert refused.code == 78
            assert "game" in refused.err
            assert "--set instance=NAME" in refused.err
            assert all(one in refused.out for one in urls.values())
            assert ended(cave)[0] == 0
        last = mocapd_here(env, "calibrate", "--no-browser")
        assert url in last.out
        assert ended(game)[0] == 0


def led_by(told: Path, url: str) -> Path:
    """The file that the browser was told of, which leads to this URL."""
    until_s = time.monotonic() + WAIT_S
    while not told.exists() and time.monotonic() < until_s:
        time.sleep(0.05)
    words = told.read_text().split()
    told.unlink()
    assert parse_qs(urlsplit(url).query)["token"][0] not in " ".join(words)
    assert words[-1].startswith("file:///")
    path = Path(unquote(urlsplit(words[-1]).path))
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert f"{url}#setup" in html.unescape(path.read_text())
    return path


def test_one_step_alone_needs_a_calibration_and_keeps_the_rest(
    env: dict[str, str], tmp_path: Path
) -> None:
    words = ("calibrate", "--no-browser", "--step", "body", "--state-dir", tmp_path / "mine")
    refused = mocapd(env, *words)
    assert refused.code == 78
    assert "do all steps" in refused.err
    save_draft(full_draft(), tmp_path / "mine")
    with running(env, *words) as process:
        url = url_of(process)
        assert status(url)["setup"] == "body"
        assert status(url)["cameras"] == ["cam0", "cam1"]  # though they are not plugged in


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--step", "dance"), "cameras, lens, room"),
        (("--out", "rig.json"), "--from-folder"),
        (("--from-folder", ".", "--out", "rig.json"), "--board-size and --square"),
        (("--camera", "cam0"), "ID=SOURCE"),
    ],
)
def test_what_cannot_be_is_refused(env: dict[str, str], words: tuple[str, ...], says: str) -> None:
    assert_refused(mocapd_here(env, "calibrate", "--no-browser", *words), says)


def test_a_setup_that_could_not_be_saved_is_refused_before_it_begins(
    env: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    for words in (("--demo",), ("--step", "body")):
        outcome = mocapd_here(
            env, "calibrate", "--no-browser", *words, "--state-dir", tmp_path / "file"
        )
        assert_refused(outcome, "is no folder")


def test_a_camera_that_is_not_there_is_refused(env: dict[str, str]) -> None:
    """In a process of its own, since others begin to make the pose database beside it."""
    outcome = mocapd(env, "calibrate", "--no-browser", "--camera", "cam0=nowhere.mp4")
    assert_refused(outcome, "no such camera or file")


def assert_refused(outcome: Outcome, says: str) -> None:
    assert outcome.code in (2, 66, 73, 78)
    assert says in outcome.err
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.skipif(
    any(Path("/dev").glob("video*")) or Path("/sys/class/video4linux").is_dir(),
    reason="this machine has cameras",
)
def test_without_a_camera_it_says_what_to_do(env: dict[str, str]) -> None:
    outcome = mocapd(env, "calibrate", "--no-browser")
    assert outcome.code == 69
    assert "plug a webcam in" in outcome.err
