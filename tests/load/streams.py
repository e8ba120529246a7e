"""Many streams through one router to many subscribers: rate, latency, and what a stream costs."""

import time
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from mocapd.clock import monotonic_ns
from tests.load.children import Child
from tests.outputs.frames import free_port

_STREAMS_A_PROCESS = 8
_SUBSCRIBERS_A_PROCESS = 25
_SETTLE_S = 2.0


@dataclass(frozen=True, slots=True)
class StreamFigures:
    """rate_hz: of the median subscriber and of the slowest; missed: share of the frames that did not come; p50_ms,
    p99_ms: publication to arrival; *_cpu: processor time for each stream per time, 1 is one core."""

    streams: int
    subscribers: int
    rate_hz: float
    slowest_hz: float
    missed: float
    p50_ms: float
    p99_ms: float
    sender_cpu: float
    router_cpu: float
    subscriber_cpu: float


def measure_streams(
    streams: int, subscribers: int, seconds: float, rate_hz: float = 60.0
) -> StreamFigures:
    """Each subscriber takes one of the streams; everything runs on this machine."""
    names = [f"room-{i}" for i in range(streams)]
    port = free_port()
    endpoint = f"tcp/127.0.0.1:{port}"
    with ExitStack() as opened:
        router = opened.enter_context(Child("tests.load.router", str(port)))
        router.line()
        hearers = []
        for first in range(0, subscribers, _SUBSCRIBERS_A_PROCESS):
            count = min(_SUBSCRIBERS_A_PROCESS, subscribers - first)
            theirs = [names[(first + i) % streams] for i in range(count)]
            words = (endpoint, str(count), *theirs)
            hearers.append(opened.enter_context(Child("tests.load.hearing", *words)))
        for hearer in hearers:
            hearer.line()
        senders = [
            opened.enter_context(Child("tests.load.sending", endpoint, str(rate_hz), *theirs))
            for theirs in _split(names, _STREAMS_A_PROCESS)
        ]
        for sender in senders:
            sender.line()
        time.sleep(min(_SETTLE_S, seconds))
        groups = (senders, [router], hearers)
        before = [sum(child.cpu_s() for child in group) for group in groups]
        for hearer in hearers:
            hearer.say("begin")
        began_ns = monotonic_ns()
        time.sleep(seconds)
        told = [hearer.answer("tell") for hearer in hearers]
        lasted_s = (monotonic_ns() - began_ns) / 1e9
        after = [sum(child.cpu_s() for child in group) for group in groups]
    rates = np.concatenate([one["rates_hz"] for one in told])
    latencies_ms = np.concatenate([one["latencies_ms"] for one in told])
    shares = [(b - a) / lasted_s / streams for a, b in zip(before, after, strict=True)]
    return StreamFigures(
        streams,
        subscribers,
        float(np.median(rates)),
        float(rates.min()),
        float(np.mean(np.concatenate([one["missed"] for one in told]))),
        float(np.percentile(latencies_ms, 50)) if len(latencies_ms) else float("nan"),
        float(np.percentile(latencies_ms, 99)) if len(latencies_ms) else float("nan"),
        *shares,
    )


def _split(names: list[str], size: int) -> list[list[str]]:
    return [names[i : i + size] for i in range(0, len(names), size)]


def stream_table(rows: list[StreamFigures]) -> str:
    """As Markdown."""
    lines = [
        "| streams | subscribers | median rate (slowest subscriber) [Hz] | missed frames | latency p50 / p99 [ms]"
        " | CPU per stream: sender / router / its subscribers [% of a core] |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.streams} | {r.subscribers} | {r.rate_hz:.1f} ({r.slowest_hz:.1f}) | {r.missed:.2%}"
        f" | {r.p50_ms:.2f} / {r.p99_ms:.1f}"
        f" | {r.sender_cpu:.2%} / {r.router_cpu:.2%} / {r.subscriber_cpu:.2%} |"
        for r in rows
    ]
    return "\n".join(lines)
