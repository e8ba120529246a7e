"""Camera nodes, each a process, into one daemon: frame sets used, latency, processor time, error of the clocks."""

import sys
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread

import numpy as np

from mocapd.capture.remote.remote_address import parse_remote
from mocapd.capture.remote.remote_link import RemoteLink
from mocapd.clock import monotonic_ns
from mocapd.evaluate.bench.bench_live import LiveFigures, bench_live
from mocapd.node.network_emulation import Imperfections, parse_imperfections
from tests.load.children import Child
from tests.load.pictures import CAMERA, write_recording
from tests.outputs.frames import free_port

JITTER_AND_LOSS = "jitter_ms=20,loss=0.01"
OTHER_CLOCK = "offset_s=3,drift_ppm=50"
_START_S = 90.0  # until all of them have started, on a busy machine
_LOOK_S = 0.03  # as often as a daemon's source gets a picture


@dataclass(frozen=True, slots=True)
class ClockError:
    """Of one node, over the second half of the run: greatest error of the map [ms], and what it told of it last."""

    node: str
    imperfect: str
    worst_ms: float
    told_ms: float
    drift_ppm: float


@dataclass(frozen=True, slots=True)
class NodeFigures:
    """live: see bench_live; node_cpu: processor time of a node per time, the mean of them."""

    nodes: int
    seconds: float
    live: LiveFigures
    node_cpu: float
    clocks: tuple[ClockError, ...]


def measure_camera_nodes(
    folder: Path, nodes: int, seconds: float, size_px: tuple[int, int] = (640, 480)
) -> NodeFigures:
    """The second node has a poor network, the third another clock, as far as there are so many."""
    film = write_recording(folder / "film.mcap", size_px, 30.0, seconds + _START_S)
    imperfect = ["", JITTER_AND_LOSS, OTHER_CLOCK, *[""] * nodes][:nodes]
    ports = [free_port() for _ in range(nodes)]
    addresses = [f"zenoh://127.0.0.1:{port}/node{i}/{CAMERA}" for i, port in enumerate(ports)]
    with ExitStack() as opened:
        children = [
            opened.enter_context(
                Child(
                    "mocapd.cli.main",
                    *("camera-node", "--name", f"node{i}", "--camera", f"{CAMERA}={film}#{CAMERA}"),
                    *("--set", f"zenoh.port={port}", "--imperfect", faults),
                )
            )
            for i, (port, faults) in enumerate(zip(ports, imperfect, strict=True))
        ]
        for child in children:
            child.line()
        asking = opened.enter_context(AskedClocks(addresses, imperfect))
        cameras = [f"cam{i}={address}" for i, address in enumerate(addresses)]
        command = [sys.executable, "-m", "mocapd.cli.main", "run", "--tracker", "canned"]
        for camera in cameras:
            command += ["--camera", camera]
        command += ["--set", f"state_dir={folder}", "--set", "web.enabled=false"]
        before, began_s = [child.cpu_s() for child in children], time.monotonic()
        live = bench_live(command, nodes, seconds)
        shares = [
            (child.cpu_s() - was) / (time.monotonic() - began_s)
            for child, was in zip(children, before, strict=True)
        ]
        clocks = asking.errors()
    return NodeFigures(nodes, seconds, live, float(np.mean(shares)), clocks)


class AskedClocks:
    """Asks each node's clock as the daemon does, meanwhile; where it really is, is known here, on one machine."""

    def __init__(self, addresses: list[str], imperfect: list[str]) -> None:
        self._nodes = [parse_remote(one).node for one in addresses]
        self._imperfect = imperfect
        self._faults = [parse_imperfections(one) if one else Imperfections() for one in imperfect]
        self._links = [RemoteLink(parse_remote(one)) for one in addresses]
        self._errors_ms: list[list[float]] = [[] for _ in addresses]
        self._over = Event()
        self._thread = Thread(target=self._ask)

    def __enter__(self) -> "AskedClocks":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        for link in self._links:
            link.close()

    def errors(self) -> tuple[ClockError, ...]:
        """So far."""
        found = []
        for i, link in enumerate(self._links):
            line = link.clock.line
            if line is None:
                raise RuntimeError(f"{self._nodes[i]} does not tell the time")
            late = self._errors_ms[i][len(self._errors_ms[i]) // 2 :]
            worst_ms = max(map(abs, late), default=float("nan"))
            told_ms = (line.uncertainty_ns + line.asymmetry_ns) / 1e6
            found.append(
                ClockError(self._nodes[i], self._imperfect[i], worst_ms, told_ms, 1e6 * line.drift)
            )
        return tuple(found)

    def _ask(self) -> None:
        while not self._over.wait(_LOOK_S):
            for link, faults, errors_ms in zip(
                self._links, self._faults, self._errors_ms, strict=True
            ):
                link.ping_if_due()
                line, now_ns = link.clock.line, monotonic_ns()
                if line is not None:
                    off_ns = line.local_from_remote(faults.node_ns(now_ns)) - now_ns
                    errors_ms.append(off_ns / 1e6)


def node_table(found: NodeFigures) -> str:
    """As Markdown."""
    live = found.live
    lines = [
        f"| {found.nodes} camera nodes, {found.seconds:.0f} s | |",
        "|---|---|",
        f"| frame sets used | {1.0 - live.dropped:.2%} |",
        f"| published frames with all {found.nodes} cameras | {live.all_cameras:.2%} |",
        f"| rate of published frames | {live.rate_hz:.1f} Hz |",
        "| latency, newest exposure to publication, median (p95) |"
        f" {live.latency_median_ms:.1f} ms ({live.latency_p95_ms:.1f}) |",
        f"| CPU of the daemon | {live.cpu_share:.0%} of a core, {live.cpu_ms:.1f} ms per frame set |",
        f"| CPU of one node, mean | {found.node_cpu:.0%} of a core |",
    ]
    lines += [
        f"| clock of {one.node}{f' ({one.imperfect})' if one.imperfect else ''} | largest error {one.worst_ms:.2f} ms,"
        f" estimated error {one.told_ms:.2f} ms, drift {one.drift_ppm:+.1f} ppm |"
        for one in found.clocks
    ]
    return "\n".join(lines)
