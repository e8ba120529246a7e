"""`mocapd calibrate` as a command: the URL it prints, what it attaches to, how it ends."""

import json
import re
import signal
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from mocapd.wizard.saving import save_draft
from tests.cli.mocapd_process import mocapd, start
from tests.cli.small_capture import write_capture
from tests.wizard.drafts import full_draft

WAIT_S = 60.0


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
    env: dict[str, str], cameras: tuple[str, ...]
) -> None:
    with running(env, "calibrate", "--no-browser", *cameras) as process:
        url = url_of(process)
        told = status(url)
        assert told["cameras"] == ["cam0", "cam1"]
        assert told["setup"] == "cameras"
        second = mocapd(env, "calibrate", "--no-browser", "--step", "check")
        assert second.code == 0, second.err
        assert url in second.out
        until_s = time.monotonic() + WAIT_S
        while status(url)["setup"] != "check" and time.monotonic() < until_s:
            time.sleep(0.1)
        assert status(url)["setup"] == "check"
        code, _ = ended(process)
        assert code == 0
    assert not list(Path(env["XDG_RUNTIME_DIR"]).rglob("*.json"))


def test_it_attaches_to_a_running_daemon(env: dict[str, str]) -> None:
    words = ("--tracker", "canned", "--set", "zenoh.enabled=false", "--set", "osc.enabled=false")
    with running(env, "run", "--capture", "sim:living_room", *words) as daemon:
        announced = Path(env["XDG_RUNTIME_DIR"]) / "mocapd" / "page.json"
        until_s = time.monotonic() + 2 * WAIT_S  # the film may have to be rendered
        while not announced.exists() and time.monotonic() < until_s:
            time.sleep(0.1)
        url = json.loads(announced.read_text())["url"]
        assert status(url)["setup"] is None
        outcome = mocapd(env, "calibrate", "--no-browser")
        assert outcome.code == 0, outcome.err
        assert outcome.out.strip() == (f"the running mocapd has the cameras; its page: {url}#setup")
        told = status(url)
        assert (told["setup"], told["tracks"]) == ("cameras", True)
        code, _ = ended(daemon)
        assert code == 0


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
        (("--camera", "cam0=nowhere.mp4"), "no such camera or file"),
    ],
)
def test_what_cannot_be_is_refused(env: dict[str, str], words: tuple[str, ...], says: str) -> None:
    outcome = mocapd(env, "calibrate", "--no-browser", *words)
    assert outcome.code in (66, 78)
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
