"""What is made once is made in a process that ends, and remembered."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

from mocapd.app.daemon import cache_warmup
from mocapd.app.daemon.cache_warmup import database_in_background, prepare_in_processes
from mocapd.app.terminal import progress
from mocapd.app.terminal.progress import ProgressBars
from mocapd.config.sections import CameraSection, Config, TrackerSection
from mocapd.session import tracker_setup
from mocapd.session.prepared_marker import MARKER, is_prepared, remember
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.trackers.registry import TRACKERS
from tests.cli.mocapd_process import Outcome, mocapd
from tests.cli.small_capture import write_capture
from tests.outputs.frames import eventually, free_port


def run(env: dict[str, str], capture: Path, *words: str) -> Outcome:
    settings = ("--set", f"zenoh.port={free_port()}", "--set", "web.enabled=false")
    return mocapd(env, "run", "--capture", capture, "--tracker", "canned", *settings, *words)


def test_a_start_that_was_prepared_is_not_prepared_again(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    """Nor is a marker that cannot be read a hint: all is prepared once more."""
    capture, cache = write_capture(tmp_path / "capture"), tmp_path / "cache"
    told = []
    for damaged in (False, False, True):
        if damaged:
            (cache / "prepared").write_bytes(b"\xff\xfe")
        outcome = run(clean_env, capture, "--set", f"cache_dir={cache}")
        assert outcome.code == 0, outcome.err
        assert "Traceback" not in outcome.err
        assert "the next start prepares" not in outcome.err
        told.append((cache / "prepared").read_text().split())
    assert len(told[0]) == 1
    assert told[2] == told[1] == told[0]


def test_trouble_in_the_first_start_is_told_once(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture, cache = write_capture(tmp_path / "capture"), tmp_path / "cache"
    outcome = run(clean_env, capture, "--set", f"cache_dir={cache}", "--rig", str(tmp_path / "no"))
    assert outcome.code != 0
    assert outcome.err.count("mocapd: ") == 1
    assert "Traceback" not in outcome.err
    assert not (cache / "prepared").exists()


def test_a_marker_that_cannot_be_written_is_no_hint(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    capture, cache = write_capture(tmp_path / "capture"), tmp_path / "cache"
    (cache / "prepared" / "x").mkdir(parents=True)
    outcome = run(clean_env, capture, "--set", f"cache_dir={cache}")
    assert outcome.code == 0, outcome.err
    assert "Traceback" not in outcome.err
    assert outcome.err.count("the next start prepares") == 1


def test_a_database_that_no_disk_took_is_not_prepared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a full disk `mocapd prepare` said that everything was prepared."""
    monkeypatch.setattr(cache_warmup, "_run_tasks", lambda *_: True)
    config = Config(cache_dir=tmp_path)
    for is_stored in (False, True):
        if is_stored:
            (tmp_path / CACHE_NAME).touch()
        prepare_in_processes(config)
        assert is_prepared(config) == is_stored


def test_who_tries_all_trackers_prepares_each_once(tmp_path: Path) -> None:
    """With real and with simulated cameras, all of it and a part: none makes another forgotten."""
    tried = [
        (Config(cache_dir=tmp_path, camera=(CameraSection("a", at),), tracker=TrackerSection(name)), part)
        for name in TRACKERS
        for at in ("/dev/video0", "sim:living_room#cam0")
        for part in ("", " database")
    ]  # fmt: skip
    for config, part in tried:
        remember(config, part)
    assert all(is_prepared(config, part) for config, part in tried)


def test_a_demo_prepares_for_real_webcams_too_but_not_the_reverse(tmp_path: Path) -> None:
    """After `make demo` the doctor announced a minute of compiling, which then took no time."""
    real, simulated = (
        Config(cache_dir=tmp_path, camera=(CameraSection("a", source),))
        for source in ("/dev/video0", "sim:living_room#cam0")
    )
    remember(real)
    assert not is_prepared(simulated)
    (tmp_path / MARKER).unlink()
    remember(simulated)
    assert is_prepared(real)


def test_a_database_that_was_made_is_not_looked_at_by_the_next_setup(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unless its file has gone, or the code has changed."""
    config, calls = Config(cache_dir=tmp_path), tmp_path / "calls"
    database, marker = tmp_path / CACHE_NAME, tmp_path / MARKER

    def make(_name: str, cache_dir: Path, _progress: object) -> None:
        with calls.open("a") as out:
            out.write("x")
        (cache_dir / CACHE_NAME).touch()

    monkeypatch.setattr(tracker_setup, "make_caches", make)
    for undo, made in ((None, 1), (None, 1), (database, 2), (None, 2), (marker, 3)):
        if undo is not None:
            undo.unlink()
        with database_in_background(config):
            until_s = time.monotonic() + 60.0
            while not (database.exists() and marker.exists()) and time.monotonic() < until_s:
                time.sleep(0.01)
        assert len(calls.read_text()) == made


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines come in a test's time."""
    monkeypatch.setattr(progress, "FIRST_AFTER_S", 0.02)
    monkeypatch.setattr(progress, "REPORT_EVERY_S", 0.02)


def err_with(capfd: pytest.CaptureFixture[str], text: str) -> str:
    """What was said on stderr till this was, or 20 s have passed."""
    said, until_s = "", time.monotonic() + 20.0
    while text not in said and time.monotonic() < until_s:
        time.sleep(0.01)
        said += capfd.readouterr().err
    return said


def test_what_takes_long_says_so_without_a_terminal(
    soon: None, capfd: pytest.CaptureFixture[str]
) -> None:
    """In a small VM the first start compiled for four minutes without a line."""
    with ProgressBars() as bars:
        bars.begin("preparing: compiling")
        assert err_with(capfd, "preparing: compiling: 0 %").startswith("preparing: compiling\n")
        bars("the tracker", 2, 8)
        assert "the tracker: 25 %" in err_with(capfd, "the tracker: 25 %")
    assert "the tracker: done after" in capfd.readouterr().err


def test_in_the_journal_nothing_is_told_of_the_way(
    soon: None, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    there = os.fstat(2)
    monkeypatch.setenv("JOURNAL_STREAM", f"{there.st_dev}:{there.st_ino}")
    before = threading.active_count()
    with ProgressBars() as bars:
        bars.begin("preparing")
        bars("the tracker", 2, 8)
        assert threading.active_count() == before  # nobody who could tell anything later
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("killed", [False, True])
def test_the_preparation_ends_with_who_began_it(tmp_path: Path, killed: bool) -> None:
    """Also where that is killed, and cannot end its children."""
    program = (
        "import os, sys, time\n"
        "from pathlib import Path\n"
        "from mocapd.app.daemon import cache_warmup\n"
        "from mocapd.config.sections import Config\n"
        "def work(config, tell):\n"
        "    os.write(1, b'%d\\n' % os.getpid())\n"
        "    cache_warmup._all_succeed(config, (deep,))\n"
        "def deep(config):\n"
        "    os.write(1, b'%d\\n' % os.getpid())\n"
        "    time.sleep(600)\n"
        "cache_warmup.prepare_in_processes = work\n"
        f"with cache_warmup.prepare_in_background(Config(cache_dir={str(tmp_path)!r})) as one:\n"
        "    sys.stdin.readline()\n"
    )
    program = program.replace("cache_dir='", "cache_dir=Path('").replace("'))", "')))")
    with subprocess.Popen(
        [sys.executable, "-c", program],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        children = [int(process.stdout.readline()) for _ in range(2)]
        if killed:
            process.kill()
        else:
            process.stdin.write("\n")
            process.stdin.flush()
        assert eventually(lambda: not any(psutil.pid_exists(pid) for pid in children), 60.0)


def test_what_is_done_at_once_is_not_told(capfd: pytest.CaptureFixture[str]) -> None:
    with ProgressBars() as bars:
        bars("the tracker", 0, 8)
        bars("the tracker", 8, 8)
    assert capfd.readouterr().err == ""
