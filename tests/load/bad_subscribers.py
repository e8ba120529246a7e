"""Subscribers that hang or die beside others, at a real daemon: the others' rate and latency before and after."""

import signal
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.load.children import Child
from tests.load.pictures import CAMERA, write_recording
from tests.outputs.frames import free_port

_SETTLE_S = 2.0
_START_S = 60.0  # until all that listens has started, on a busy machine
_RATE_HZ = 60.0


@dataclass(frozen=True, slots=True)
class Heard:
    """rate_hz: of the median subscriber and of the slowest; p50_ms, p99_ms: publication to arrival, of all."""

    rate_hz: float
    slowest_hz: float
    p50_ms: float
    p99_ms: float


@dataclass(frozen=True, slots=True)
class BadSubscriberFigures:
    """Of those that are neither stuck nor killed: while all are well, the same once more, which shows what the machine
    itself changes, and while the others are not."""

    subscribers: int
    stuck: int
    killed: int
    well: Heard
    again: Heard
    beside: Heard


def measure_bad_subscribers(
    folder: Path, subscribers: int, stuck: int, killed: int, seconds: float
) -> BadSubscriberFigures:
    """A daemon at 60 Hz; so many subscribers, of which some are stopped and others killed after `seconds` [s]."""
    port = free_port()
    film = write_recording(folder / "film.mcap", (64, 48), _RATE_HZ, 3 * seconds + _START_S)
    good = subscribers - stuck - killed
    with ExitStack() as opened:
        daemon = Child(
            "mocapd.cli.main",
            *("run", "--camera", f"{CAMERA}={film}#{CAMERA}", "--tracker", "canned", "--instance", "load"),
            *("--set", f"zenoh.port={port}", "--set", "osc.enabled=false", "--set", "web.enabled=false"),
            *("--set", f"state_dir={folder}"),
        )  # fmt: skip
        opened.enter_context(daemon)
        endpoint = f"tcp/127.0.0.1:{port}"
        others = [
            opened.enter_context(Child("tests.load.hearing", endpoint, "1", "load"))
            for _ in range(stuck + killed)
        ]
        hearer = opened.enter_context(Child("tests.load.hearing", endpoint, str(good), "load"))
        for child in (*others, hearer):
            child.line()
        time.sleep(min(_SETTLE_S, seconds))
        well = _heard(hearer, seconds)
        again = _heard(hearer, seconds)
        for child in others[:stuck]:
            child.signal(signal.SIGSTOP)
        for child in others[stuck:]:
            child.signal(signal.SIGKILL)
        beside = _heard(hearer, seconds)
    return BadSubscriberFigures(subscribers, stuck, killed, well, again, beside)


def _heard(hearer: Child, seconds: float) -> Heard:
    hearer.say("begin")
    time.sleep(seconds)
    told = hearer.answer("tell")
    latencies_ms = told["latencies_ms"] or [float("nan")]
    return Heard(
        float(np.median(told["rates_hz"])),
        float(min(told["rates_hz"])),
        float(np.percentile(latencies_ms, 50)),
        float(np.percentile(latencies_ms, 99)),
    )


def bad_subscriber_table(found: BadSubscriberFigures) -> str:
    """As Markdown."""
    lines = [
        f"| {found.subscribers} subscribers | median rate (slowest subscriber) [Hz] | latency p50 / p99 [ms] |",
        "|---|---|---|",
    ]
    for name, heard in (
        ("no faulty subscribers", found.well),
        ("no faulty subscribers, second measurement", found.again),
        (f"{found.stuck} stuck and {found.killed} killed", found.beside),
    ):
        lines.append(
            f"| {name} | {heard.rate_hz:.1f} ({heard.slowest_hz:.1f}) | {heard.p50_ms:.2f} / {heard.p99_ms:.2f} |"
        )
    for name, heard in (
        ("change without faulty subscribers", found.again),
        ("change with faulty subscribers", found.beside),
    ):
        lines.append(
            f"| {name} | {_change(heard.rate_hz, found.well.rate_hz)} |"
            f" {_change(heard.p50_ms, found.well.p50_ms)} / {_change(heard.p99_ms, found.well.p99_ms)} |"
        )
    return "\n".join(lines)


def _change(now: float, before: float) -> str:
    return f"{now / before - 1.0:+.1%}" if before else "nan"
