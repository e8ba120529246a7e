"""The whole way: simulated cameras, the real daemon, real Zenoh and OSC subscribers, the end."""

import json
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.evaluate.score import JOINT_SETS
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import World
from tests.cli.mocapd_process import mocapd, start
from tests.cli.own_time import end_within
from tests.cli.small_capture import write_capture
from tests.outputs.frames import free_port

pytestmark = pytest.mark.kernels

FRAMES = 60  # all of the film
SETTLED_S = 1.0  # from the first frame with a person on
WORST_RMS_M = 0.06
SCENARIO = Path(__file__).with_name("two_webcams.toml")


class Running:
    """A daemon on two simulated cameras, with ports of its own."""

    def __init__(self, env: dict[str, str], tracker: str) -> None:
        self.env = env
        self.osc_port = free_port(socket.SOCK_DGRAM)
        zenoh_port = free_port(socket.SOCK_STREAM)
        self.endpoint = f"tcp/127.0.0.1:{zenoh_port}"
        self.process = start(
            env,
            *("run", "--capture", f"sim:{SCENARIO}", "--tracker", tracker),
            *("--instance", "e2e", "--set", f"zenoh.port={zenoh_port}"),
            *("--set", f'osc.destinations=["127.0.0.1:{self.osc_port}"]'),
        )

    def subscribe(self, frames: int) -> dict[str, Any]:
        """What a subscriber in another process received, until it had so many."""
        words = (self.endpoint, str(self.osc_port), str(frames))
        with subprocess.Popen(
            [sys.executable, "-m", "tests.e2e.subscriber", *words],
            env=self.env,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as subscriber:
            while True:
                try:
                    out, err = subscriber.communicate(timeout=1.0)
                    break
                except subprocess.TimeoutExpired:
                    if self.process.poll() is not None:
                        subscriber.kill()
                        pytest.fail(f"the daemon ended: {self.process.communicate()[1]}")
        assert subscriber.returncode == 0, err
        received: dict[str, Any] = json.loads(out)
        return received

    def end(self, number: signal.Signals) -> tuple[int, str]:
        """Exit code and stderr after this signal; it has two seconds."""
        self.process.send_signal(number)
        _, err = end_within(self.process, 2.0)
        return self.process.returncode, err


def joint_errors_m(frames: list[dict[str, Any]], log: str) -> tuple[np.ndarray, np.ndarray]:
    """Age (F,) [s] since the first frame, and errors (F,J) [m] against where the person was then.

    The daemon logs which frame of the film was shown when; the rest is the scenario's.
    """
    began = re.search(r"frame (\d+) of the film .* is at (\d+) ns", log)
    assert began, log
    scenario = load_scenario(SCENARIO)
    world = World(scenario)
    names = JOINT_SETS["upper"]
    errors = []
    for frame in frames:
        played_s = (frame["capture_monotonic_ns"] - int(began[2])) / 1e9
        truth = world.at(int(began[1]) / scenario.fps_hz + played_s).joints_m
        got = np.array([frame["joints"][name]["p"] for name in names])
        errors.append(np.linalg.norm(got - truth[[INDEX[name] for name in names]], axis=1))
    times_ns = np.array([frame["capture_monotonic_ns"] for frame in frames])
    return (times_ns - times_ns[0]) / 1e9, np.array(errors)


@pytest.fixture
def begin(clean_env: dict[str, str]) -> Iterator[Callable[[str], Running]]:
    """Starts a daemon with this tracker; it has ended after the test."""
    begun: list[Running] = []

    def one(tracker: str) -> Running:
        begun.append(Running(clean_env, tracker))
        return begun[-1]

    yield one
    for running in begun:
        running.process.kill()
        running.process.communicate()


def test_frames_arrive_over_zenoh_and_osc_and_sigterm_ends_it(
    begin: Callable[[str], Running],
) -> None:
    daemon = begin("shirt")
    received = daemon.subscribe(FRAMES)

    frames = received["zenoh"]
    seqs = [frame["seq"] for frame in frames]
    assert seqs == sorted(set(seqs))
    live = [frame for frame in frames if frame["tracking"] == "live"]
    assert len(live) >= FRAMES
    last = next(frame for frame in reversed(live) if len(frame["cameras"]) > 1)
    assert last["schema"] == "mocapd.Skeleton.v1"
    assert last["instance"] == "e2e"
    assert last["tracker"] == "shirt"
    assert last["cameras"] == ["cam0", "cam1"]
    assert len(last["joints"]) == 22
    assert max(received["osc"].values()) >= FRAMES
    assert received["health"][0]["instance"] == "e2e"

    watched = mocapd(daemon.env, "watch", "--endpoint", daemon.endpoint, "--json", "--count", "2")
    assert watched.code == 0, watched.err
    assert [json.loads(line)["instance"] for line in watched.out.splitlines()] == ["e2e", "e2e"]

    code, err = daemon.end(signal.SIGTERM)
    assert code == 0, err
    assert "Traceback" not in err

    ages_s, errors_m = joint_errors_m(live, err)
    rms_m = np.sqrt(np.mean(errors_m[ages_s > SETTLED_S] ** 2))
    assert rms_m < WORST_RMS_M, np.sqrt(np.mean(errors_m**2, axis=1)).round(3)


def test_ctrl_c_ends_it_with_130(begin: Callable[[str], Running]) -> None:
    daemon = begin("canned")
    daemon.subscribe(5)
    assert daemon.end(signal.SIGINT)[0] == 130


def test_recordings_run_to_their_end(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture = write_capture(tmp_path / "capture")
    port = free_port(socket.SOCK_STREAM)
    words = ("run", "--capture", capture, "--tracker", "canned")
    outcome = mocapd(clean_env, *words, "--set", f"zenoh.port={port}")
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
