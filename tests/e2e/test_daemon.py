"""The whole way: simulated cameras, the real daemon, real Zenoh and OSC subscribers, the end."""

import json
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.cli.mocapd_process import mocapd, start
from tests.cli.small_capture import write_capture

FRAMES = 30
SCENARIO = """
name = "small"
loop_s = 0.5
[[cameras]]
name = "cam0"
position_m = [-1.4, 1.4, 2.4]
look_at_m = [0.0, 1.0, 0.0]
size_px = [160, 120]
[[cameras]]
name = "cam1"
position_m = [1.6, 1.3, 2.2]
look_at_m = [0.0, 1.0, 0.0]
size_px = [160, 120]
clock_offset_s = 0.011
[[motion.keyframes]]
t_s = 0.0
"""


def free_port(kind: socket.SocketKind) -> int:
    """A port of 127.0.0.1 that is free just now."""
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Running:
    """A daemon on two simulated cameras, with ports of its own."""

    def __init__(self, env: dict[str, str], scenario: Path) -> None:
        self.env = env
        self.osc_port = free_port(socket.SOCK_DGRAM)
        zenoh_port = free_port(socket.SOCK_STREAM)
        self.endpoint = f"tcp/127.0.0.1:{zenoh_port}"
        self.process = start(
            env,
            *("run", "--capture", f"sim:{scenario}", "--tracker", "canned"),
            *("--instance", "e2e", "--set", f"zenoh.port={zenoh_port}"),
            *("--set", f'osc.destinations=["127.0.0.1:{self.osc_port}"]'),
        )

    def subscribe(self) -> dict[str, Any]:
        """What a subscriber in another process received."""
        words = (self.endpoint, str(self.osc_port), str(FRAMES))
        done = subprocess.run(
            [sys.executable, "-m", "tests.e2e.subscriber", *words],
            env=self.env,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        received: dict[str, Any] = json.loads(done.stdout)
        return received

    def end(self, number: signal.Signals) -> tuple[int, str]:
        """Exit code and stderr after this signal; it has two seconds."""
        self.process.send_signal(number)
        _, err = self.process.communicate(timeout=2.0)
        return self.process.returncode, err


@pytest.fixture(scope="module")
def cache_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The film is rendered once."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def daemon(clean_env: dict[str, str], tmp_path: Path, cache_dir: Path) -> Iterator[Running]:
    scenario = tmp_path / "small.toml"
    scenario.write_text(SCENARIO)
    running = Running(clean_env | {"MOCAPD_CACHE_DIR": str(cache_dir)}, scenario)
    try:
        yield running
    finally:
        running.process.kill()
        running.process.communicate()


def test_frames_arrive_over_zenoh_and_osc_and_sigterm_ends_it(daemon: Running) -> None:
    received = daemon.subscribe()

    frames = received["zenoh"]
    assert len(frames) == FRAMES
    seqs = [frame["seq"] for frame in frames]
    assert seqs == sorted(set(seqs))
    last = frames[-1]
    assert last["schema"] == "mocapd.Skeleton.v1"
    assert last["instance"] == "e2e"
    assert last["tracking"] == "live"
    assert last["cameras"] == ["cam0", "cam1"]
    assert len(last["joints"]) == 22
    assert max(received["osc"].values()) >= FRAMES
    assert received["health"][0]["instance"] == "e2e"

    watched = mocapd(daemon.env, "watch", "--endpoint", daemon.endpoint, "--json", "--count", "2")
    assert watched.code == 0, watched.err
    assert [json.loads(line)["instance"] for line in watched.out.splitlines()] == ["e2e", "e2e"]

    code, err = daemon.end(signal.SIGTERM)
    assert code == 0, err
    assert "canned live" in err
    assert "Traceback" not in err


def test_ctrl_c_ends_it_with_130(daemon: Running) -> None:
    daemon.subscribe()
    assert daemon.end(signal.SIGINT)[0] == 130


def test_recordings_run_to_their_end(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture = write_capture(tmp_path / "capture")
    port = free_port(socket.SOCK_STREAM)
    outcome = mocapd(clean_env, "run", "--capture", capture, "--set", f"zenoh.port={port}")
    assert outcome.code == 0, outcome.err


def test_a_thread_that_dies_ends_the_process_with_70_and_its_traceback(
    clean_env: dict[str, str],
) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.e2e.dying_camera"],
        env=clean_env,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 70, done.stderr
    assert done.stderr.count("ZeroDivisionError") == 1
