"""Benchmark of the real daemon in its own process on simulated webcams, by a real subscriber."""

import math
import os
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Protocol

import numpy as np
import psutil

from mocapd.clock import NS_PER_S, monotonic_ns, seconds
from mocapd.errors import UnavailableError
from mocapd.evaluate.bench.bench_step import BYTES_PER_MB
from mocapd.evaluate.bench.bench_subscriber import Heard, Subscriber
from mocapd.outputs.messages import Health
from mocapd.types import Floats

INSTANCE = "bench"
FIRST_FRAME_S = 150.0  # timeout of the first frame; the very first start compiles kernels [s]
LOOK_EVERY_S = 1.0  # sampling interval of memory [s]
STOP_S = 5.0


def free_port(kind: socket.SocketKind) -> int:
    """A currently free port of 127.0.0.1; SOCK_STREAM for TCP, SOCK_DGRAM for UDP."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Looks(Protocol):
    """A client of the page; `pictures` counts the received ones."""

    pictures: int


Watching = Callable[[Path], AbstractContextManager[Looks]]  # given the daemon's $XDG_RUNTIME_DIR


@dataclass(frozen=True, slots=True)
class LiveFigures:
    """Measurements of a daemon by a subscriber and the system over `seconds` [s] from its first frame on.

    start_s: from the start of the process to the first published frame [s]; rate_hz: frames
    received per second; dropped: share of all frame sets, from the very first, that were displaced
    by newer ones before they were tracked; missing: share of the published frames that did not arrive; all_cameras,
    live: shares of the frames with evidence of every camera, and tracked live.

    latency_*_ms: middle of the newest exposure to publication [ms]; arrival_*_ms: to the arrival at
    the subscriber [ms]; cpu_share: processor time of the daemon per time, 1 is one core;
    cpu_ms: the same per frame set [ms]; rss_mb: greatest resident memory [MB];
    rss_slope_mb_per_min: its trend over the second half [MB/min]; pictures_per_s: how many the
    page's watcher got, of all cameras together.
    """

    seconds: float
    start_s: float
    sets: int
    rate_hz: float
    dropped: float
    missing: float
    all_cameras: float
    live: float
    latency_median_ms: float
    latency_p95_ms: float
    arrival_median_ms: float
    arrival_p95_ms: float
    cpu_share: float
    cpu_ms: float
    rss_mb: float
    rss_slope_mb_per_min: float
    pictures_per_s: float


def bench_live(
    command: Sequence[str], cameras: int, duration_s: float, watching: Watching | None = None
) -> LiveFigures:
    """Run a daemon for `duration_s` [s] after its first frame and measure it from outside.

    `command` starts `mocapd run` on so many cameras; ports and instance are chosen here. `watching`: a client of its
    page, if any. Raises UnavailableError when it does not start, or ends by itself.
    """
    with ExitStack() as opened:
        # separate from the page of the user's own daemon
        runtime_dir = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        osc = opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        osc.bind(("127.0.0.1", 0))  # a receiver; the system discards what it does not read
        endpoint = f"127.0.0.1:{free_port(socket.SOCK_STREAM)}"
        started_ns = monotonic_ns()
        daemon = opened.enter_context(
            _running([
                *(*command, "--instance", INSTANCE),
                *("--set", f"zenoh.port={endpoint.rpartition(':')[2]}"),
                *("--set", f'osc.destinations=["127.0.0.1:{osc.getsockname()[1]}"]'),
            ], runtime_dir)
        )  # fmt: skip
        subscriber = Subscriber(f"tcp/{endpoint}", INSTANCE)
        opened.enter_context(subscriber)
        first = _first_frame(subscriber, daemon)
        watcher = opened.enter_context(watching(runtime_dir)) if watching else None
        process = psutil.Process(daemon.pid)
        cpu_s, start_ns = _cpu_s(process), monotonic_ns()
        rss = _watch(process, daemon, duration_s)
        heard, cpu_s = subscriber.heard(), _cpu_s(process) - cpu_s
        lasted_s = seconds(monotonic_ns() - start_ns)
        health = subscriber.health()
        pictures = watcher.pictures if watcher else 0
    return _figures(first, started_ns, heard, lasted_s, health, cpu_s, rss, cameras, pictures)


def _figures(
    first: Heard, started_ns: int, heard: Sequence[Heard], lasted_s: float, health: Health,
    cpu_s: float, rss: Floats, cameras: int, pictures: int,
) -> LiveFigures:  # fmt: skip
    n = len(heard)
    if n < 2:
        raise UnavailableError("the daemon published nothing", "bench", "see `mocapd run`")
    captured = np.array([one.frame.capture_monotonic_ns for one in heard])
    published = np.array([one.frame.publish_monotonic_ns for one in heard])
    arrived = np.array([one.arrival_ns for one in heard])
    latency_ms, arrival_ms = (published - captured) / 1e6, (arrived - captured) / 1e6
    sent = heard[-1].frame.seq - heard[0].frame.seq + 1
    rate_hz = (n - 1) * NS_PER_S / float(arrived[-1] - arrived[0])
    # earlier frames were sent before the subscriber was connected
    first_ns = first.frame.publish_monotonic_ns - round(first.frame.seq * NS_PER_S / rate_hz)
    settled = rss[len(rss) // 2 :]
    return LiveFigures(
        seconds=lasted_s,
        start_s=seconds(first_ns - started_ns),
        sets=sent,
        rate_hz=rate_hz,
        dropped=health.dropped / max(1, health.frame_sets),
        missing=(sent - n) / sent,
        all_cameras=sum(len(one.frame.cameras) == cameras for one in heard) / n,
        live=sum(one.frame.tracking == "live" for one in heard) / n,
        latency_median_ms=float(np.median(latency_ms)),
        latency_p95_ms=float(np.percentile(latency_ms, 95.0)),
        arrival_median_ms=float(np.median(arrival_ms)),
        arrival_p95_ms=float(np.percentile(arrival_ms, 95.0)),
        cpu_share=cpu_s / lasted_s,
        cpu_ms=1e3 * cpu_s / sent,
        rss_mb=float(rss[:, 1].max()),
        rss_slope_mb_per_min=(
            float(np.polyfit(settled[:, 0], settled[:, 1], 1)[0]) if len(settled) > 1 else 0.0
        ),
        pictures_per_s=pictures / lasted_s,
    )


@contextmanager
def _running(command: Sequence[str], runtime_dir: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A daemon, terminated on exit. If it ends by itself, the error has the last line of its stderr."""
    env = {name: value for name, value in os.environ.items() if name != "RUNTIME_DIRECTORY"}
    env["XDG_RUNTIME_DIR"] = str(runtime_dir)
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said, env=env)
        try:
            try:
                yield process
            except (UnavailableError, psutil.NoSuchProcess):
                if process.poll() is None:
                    raise
            if process.poll() is not None:
                raise _exit_error(said)
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(STOP_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _exit_error(said: IO[bytes]) -> UnavailableError:
    said.seek(0)
    lines = said.read().decode(errors="replace").strip().splitlines()
    return UnavailableError("the daemon ended by itself", "bench", lines[-1] if lines else "")


def _first_frame(subscriber: Subscriber, daemon: subprocess.Popen[bytes]) -> Heard:
    give_up_ns = monotonic_ns() + round(FIRST_FRAME_S * NS_PER_S)
    while monotonic_ns() < give_up_ns and daemon.poll() is None:
        if subscriber.connect() and (heard := subscriber.heard()):
            return heard[0]
        time.sleep(0.02)
    raise UnavailableError("no frame came from the daemon", "bench", "try `mocapd run`")


def _watch(process: psutil.Process, daemon: subprocess.Popen[bytes], duration_s: float) -> Floats:
    """Resident memory (N,2) of every second: minute, [MB]."""
    rss = []
    start_s = time.monotonic()
    for _ in range(max(1, math.ceil(duration_s / LOOK_EVERY_S))):
        past_s = time.monotonic() - start_s
        time.sleep(max(0.0, min(LOOK_EVERY_S, duration_s - past_s)))
        if daemon.poll() is not None:
            break
        past_min = (time.monotonic() - start_s) / 60.0
        rss.append((past_min, process.memory_info().rss / BYTES_PER_MB))
    return np.array(rss).reshape(-1, 2)


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)
