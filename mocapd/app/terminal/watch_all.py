"""Implementation of `mocapd watch --all` and `status --all`: one line per daemon on the bus, each second or once."""

import itertools
import json
import sys
import time
from contextlib import ExitStack
from typing import Any

import msgspec
from rich.console import Console
from rich.live import Live
from rich.text import Text

from mocapd.client import Link, connect
from mocapd.clock import monotonic_ns, seconds
from mocapd.errors import one_line
from mocapd.outputs.messages import CameraStatus
from mocapd.outputs.zenoh.zenoh_instances import Instances, InstanceState, list_instances

EVERY_S = 1.0
SILENT_S = 5.0  # a living daemon that sends nothing so long is reported; it should send each second


def watch_all(link: Link, as_json: bool, count: int) -> None:
    """Prints `count` rounds of lines, 0: without end. Raises UnavailableError without a bus, or without a daemon within
    the timeout."""
    instances = Instances()
    with ExitStack() as opened:
        session = opened.enter_context(connect(link))
        instances.follow(session, opened)
        console = Console()
        live = None
        if console.is_terminal and not as_json:
            live = opened.enter_context(Live(console=console, auto_refresh=False))
        for done in itertools.count(1):
            states = instances.states()
            lines = [json.dumps(as_dict(s)) if as_json else as_text(s) for s in states]
            if live is not None:
                summary = f"{sum(state.alive for state in states)} daemons at {link.endpoint}"
                live.update(Text("\n".join([*lines, summary]), no_wrap=True), refresh=True)
            else:
                sys.stdout.write("".join(f"{line}\n" for line in lines))
                sys.stdout.flush()
            if done == count:
                return
            time.sleep(EVERY_S)


def on_the_bus(link: Link) -> tuple[InstanceState, ...]:
    """The state of every daemon. Raises UnavailableError without a bus, or without a daemon within the timeout."""
    with connect(link) as session:
        return list_instances(session)


def is_able(one: InstanceState) -> bool:
    """True if the daemon can track: one of its cameras delivers."""
    return not one.trouble and any(camera.state == "live" for camera in one.cameras.values())


def as_text(one: InstanceState) -> str:
    """One safe line: rate, tracker and its state, latency, cameras, and trouble."""
    return one_line(_raw_text(one))


def _raw_text(one: InstanceState) -> str:
    name = f"{one.name:<16}"
    if one.trouble:
        return f"{name} is not understood: {one.trouble}"
    if not one.alive:
        return f"{name} gone for {_silent_s(one):.0f} s" if one.heard_ns else f"{name} gone"
    if one.health is None:
        return f"{name} has said nothing yet"
    health = one.health
    used = [camera for _, camera in sorted(one.cameras.items()) if camera.state != "ended"]
    live = sum(camera.state == "live" for camera in used)
    parts = [
        f"{name} {health.rate_hz:5.1f} Hz",
        f"{health.tracker} {health.tracking}",
        f"{health.latency_median_ms:.0f} ms (p95 {health.latency_p95_ms:.0f})",
        f"{live} of {len(used)} cameras",
    ]
    if health.slowness:
        parts.append(health.slowness.partition(" -- ")[0])
    elif health.effort != "full":
        parts.append(f"{health.effort} effort")
    parts += [f"{c.camera} {c.state}{_why(c)}" for c in used if c.state != "live"]
    parts += [f"{c.camera} bumped" for c in used if c.mounting == "bumped"]
    if _silent_s(one) > SILENT_S:
        parts.append(f"silent for {_silent_s(one):.0f} s")
    return " | ".join(parts)


def as_dict(one: InstanceState) -> dict[str, Any]:
    """For JSON: the received messages, and whether the daemon lives."""
    return {
        "instance": one.name,
        "alive": one.alive,
        "silent_s": round(_silent_s(one), 1) if one.heard_ns else None,
        "health": msgspec.to_builtins(one.health),
        "cameras": [msgspec.to_builtins(camera) for camera in one.cameras.values()],
        "trouble": one.trouble,
    }


def _why(camera: CameraStatus) -> str:
    """The trouble without its fix, which helps only on that machine."""
    what = camera.detail.partition(" -- ")[0]
    return f": {what}" if what else ""


def _silent_s(one: InstanceState) -> float:
    return seconds(monotonic_ns() - one.heard_ns)
