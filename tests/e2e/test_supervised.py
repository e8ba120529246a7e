"""A real daemon under a service manager: ready, signs of life, reload, end, and what the journal gets."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from tests.app.daemon.manager import Manager
from tests.capture.films import write_film
from tests.cli.mocapd_process import COMMAND
from tests.cli.own_time import end_within
from tests.outputs.frames import free_port

LIMIT_US = "400000"  # so short that each look of the main thread is to be a sign of life
SIGNS = 8
MINUTE = 1800  # frames
MOST_LINES = 12  # in the journal, of a start, a reload and an end


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[Manager]:
    one = Manager(tmp_path / "notify")
    yield one
    one.close()


def supervised(env: Mapping[str, str], manager: Manager, *words: str) -> subprocess.Popen[str]:
    """A child with its stderr as the journal; with the manager's variables."""
    reading, writing = os.pipe()
    told = os.fstat(writing)
    own = {
        "NOTIFY_SOCKET": manager.address,
        "WATCHDOG_USEC": LIMIT_US,
        "JOURNAL_STREAM": f"{told.st_dev}:{told.st_ino}",
    }
    process = subprocess.Popen(
        ("sh", "-c", 'ulimit -c 0; exec "$@"', "sh", *words),
        env={**env, **own},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=writing,
        text=True,
    )
    os.close(writing)
    process.stderr = os.fdopen(reading)
    return process


def run(env: Mapping[str, str], manager: Manager, *words: str) -> subprocess.Popen[str]:
    port = f"zenoh.port={free_port()}"
    settings = ("--tracker", "canned", "--set", port, "--set", "osc.enabled=false")
    return supervised(env, manager, *COMMAND, "run", *settings, *words)


@pytest.fixture
def daemon(
    clean_env: dict[str, str], manager: Manager, tmp_path: Path
) -> Iterator[subprocess.Popen[str]]:
    """On a film that lasts a minute."""
    film = write_film(tmp_path / "a.avi", MINUTE)
    runtime = {"XDG_RUNTIME_DIR": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state")}
    with run(clean_env | runtime, manager, f"--camera=a={film}") as process:
        yield process
        process.kill()


def journal_of_an_orderly_end(process: subprocess.Popen[str], manager: Manager) -> str:
    """Of one that goes on giving signs of life until it is told to end."""
    for _ in range(SIGNS):
        manager.until("WATCHDOG", "1")
    process.send_signal(signal.SIGTERM)
    manager.until("STOPPING", "1")
    _, journal = end_within(process, 2.0)
    assert process.returncode == 0, journal
    return journal


def test_a_life_as_the_service_manager_sees_it(
    daemon: subprocess.Popen[str], manager: Manager
) -> None:
    began = manager.until("READY", "1")
    assert began[0]["READY"] == "1"  # nothing before it
    manager.until("STATUS", "somebody is tracked; a live")
    for _ in range(SIGNS):
        manager.until("WATCHDOG", "1")
    daemon.send_signal(signal.SIGHUP)
    (reloading,) = manager.until("RELOADING", "1")[-1:]
    assert int(reloading["MONOTONIC_USEC"]) > 0
    manager.until("READY", "1")
    journal = journal_of_an_orderly_end(daemon, manager)
    assert manager.waiting() == []  # a word after the end would be a word of another

    lines = journal.splitlines()
    assert all(re.match(r"<[0-7]>\S", line) for line in lines), journal
    assert len(lines) <= MOST_LINES, journal
    assert sum("the first body is sent" in line for line in lines) == 1
    assert sum("taken up, within" in line for line in lines) == 1
    assert len({*lines}) == len(lines)


def test_a_camera_node_is_a_service_too(
    clean_env: dict[str, str], manager: Manager, tmp_path: Path
) -> None:
    film = write_film(tmp_path / "a.avi", MINUTE)
    words = ("camera-node", f"--camera=a={film}", "--set", f"zenoh.port={free_port()}")
    with supervised(clean_env, manager, *COMMAND, *words) as node:
        began = manager.until("READY", "1")
        assert began[0]["READY"] == "1"
        if began[0]["STATUS"] != "a live":
            manager.until("STATUS", "a live")
        journal = journal_of_an_orderly_end(node, manager)
    assert len(journal.splitlines()) <= MOST_LINES, journal


def test_ready_waits_for_no_compiler(
    clean_env: dict[str, str], manager: Manager, tmp_path: Path, simulated: str
) -> None:
    """A first start ever; and who changes their mind then need not wait either."""
    cache = tmp_path / "cache"
    with run(clean_env, manager, "--capture", simulated, "--set", f"cache_dir={cache}") as process:
        try:
            (ready,) = manager.until("READY", "1")
            assert "compiling the tracker" in ready["STATUS"]
            assert not (cache / "prepared").exists()
            (patience,) = manager.until("WATCHDOG_USEC")
            assert int(patience["WATCHDOG_USEC"]) > 60e6
            assert process.stderr is not None
            assert re.match("<6>.*compiling the tracker", process.stderr.readline())
            process.send_signal(signal.SIGTERM)
            manager.until("STOPPING", "1")
            _, journal = end_within(process, 2.0)
        finally:
            process.kill()
    assert process.returncode == 0
    assert journal == ""


def test_a_wrong_configuration_is_never_ready(
    clean_env: dict[str, str], manager: Manager, tmp_path: Path
) -> None:
    """So systemd says at once that the start has failed, and by 78 does not try again."""
    empty = clean_env | {"XDG_STATE_HOME": str(tmp_path / "state")}
    with run(empty, manager) as process:
        _, journal = process.communicate(timeout=600)
    assert process.returncode == 78, journal
    assert "no camera is configured" in journal
    assert not [one for one in manager.waiting() if "READY" in one]


def test_a_pipeline_that_is_stuck_gives_no_sign_of_life(
    clean_env: dict[str, str], manager: Manager
) -> None:
    words = (sys.executable, "-m", "tests.e2e.stuck_pipeline")
    with supervised(clean_env, manager, *words) as process:
        try:
            manager.until("STATUS", "stuck")
            assert {"WATCHDOG": "1"} in manager.told
            for _ in range(2):  # one turn may have come round before it stuck
                manager.until("STATUS")
            begun = len(manager.told)
            for _ in range(SIGNS):
                manager.until("STATUS")
            signs = [one for one in manager.told[begun:] if "WATCHDOG" in one]
            assert signs == []
        finally:
            process.kill()


def test_whoever_is_killed_for_it_says_where_it_was(
    daemon: subprocess.Popen[str], manager: Manager
) -> None:
    manager.until("STATUS", "somebody is tracked; a live")
    daemon.send_signal(signal.SIGABRT)
    _, journal = daemon.communicate(timeout=60)
    assert daemon.returncode == -signal.SIGABRT
    assert re.search(r"pipeline/loop\.py.* in _loop", journal), journal
