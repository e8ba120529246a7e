"""How long a frame is under way from the daemon's outputs to a game on this machine, and what all outputs cost.

`python -m lab.bench_delivery [--seconds S]` sends frames at 60 Hz to every output at once. A game
hears them in a process of its own, by Zenoh and by plain UDP.
"""

import argparse
import json
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from lab.bench_outputs import RATE_HZ, STATURE_M, moving_frames
from mocapd.body.skeleton import standard_skeleton
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.evaluate.bench.bench_live import free_port
from mocapd.evaluate.bench.bench_subscriber import Subscriber
from mocapd.evaluate.tables import number, table
from mocapd.outputs.base import Sink
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.osc.osc_frame import FRAME, FRAME_TYPES
from mocapd.outputs.osc.osc_template import bundle, message
from mocapd.outputs.output_table import (
    OscSection,
    VmcSection,
    VRChatSection,
    ZenohSection,
    build_sinks,
)
from mocapd.pipeline.idle_collection import IdleCollection
from mocapd.types import Floats

_INSTANCE = "bench"
_READY = "ready"
_SETTLE_S = 0.5  # before the first frame that counts
_SILENT_S = 2.0  # after which no more frames come
_NUMBERS_AT = bundle([message(FRAME, FRAME_TYPES, *(0,) * 7, 0.0, *("",) * 4)])[1][0]
_frame_numbers = struct.Struct(">iiii")  # person, seq, part, parts

Arrivals = dict[int, int]  # of each frame, by number: CLOCK_MONOTONIC [ns]


@dataclass(frozen=True, slots=True, eq=False)
class DeliveryTimes:
    """under_way_ms: by way, of each frame that came; lost: by way, frames that did not. Shares of one core:
    busy_share, that the outputs took together; idle_share, that the same loop took without any."""

    under_way_ms: dict[str, Floats]
    lost: dict[str, int]
    busy_share: float
    idle_share: float


def deliver(seconds: float) -> DeliveryTimes:
    """Send for so long. Raises UnavailableError for a port that is taken meanwhile."""
    with ExitStack() as opened:
        silent = [
            opened.enter_context(_bound()) for _ in range(2)
        ]  # never read: the system drops what is too much
        zenoh_port, osc_port = free_port(socket.SOCK_STREAM), free_port(socket.SOCK_DGRAM)
        sinks = build_sinks(
            {
                "zenoh": ZenohSection(port=zenoh_port),
                "osc": OscSection(destinations=(f"127.0.0.1:{osc_port}",)),
                "vmc": VmcSection(enabled=True, destinations=(_address(silent[0]),)),
                "vrchat": VRChatSection(enabled=True, destination=_address(silent[1])),
            },
            _INSTANCE,
        )
        rest = rest_skeleton(standard_skeleton(STATURE_M), instance=_INSTANCE, stature_m=STATURE_M)
        for sink in sinks:
            opened.callback(sink.close)
            sink.open()
            sink.send_state(rest)
        games = {
            "zenoh": _game("zenoh", zenoh_port, opened),
            "osc": _game("osc", osc_port, opened),
        }
        _, idle_share = _send((), seconds / 4.0)
        sent_ns, busy_share = _send(sinks, seconds)
        heard = {way: _heard(game) for way, game in games.items()}
    return DeliveryTimes(
        {
            way: np.array([(at_ns - sent_ns[seq]) / 1e6 for seq, at_ns in arrivals.items()])
            for way, arrivals in heard.items()
        },
        {way: len(sent_ns) - len(arrivals) for way, arrivals in heard.items()},
        busy_share - idle_share,
        idle_share,
    )


def _send(sinks: Sequence[Sink], seconds: float) -> tuple[list[int], float]:
    """When each frame was handed to the outputs, and the share of a core that this process took."""
    frames = moving_frames(max(1, round(seconds * RATE_HZ)))
    time.sleep(_SETTLE_S)
    sent_ns = []
    with IdleCollection() as garbage:  # as in the daemon
        began_ns, began_busy_ns = monotonic_ns(), time.process_time_ns()
        for i, frame in enumerate(frames):
            due_ns = began_ns + round(i * NS_PER_S / RATE_HZ)
            garbage.idle(monotonic_ns())
            time.sleep(max(0.0, (due_ns - monotonic_ns()) / NS_PER_S))
            sent_ns.append(monotonic_ns())
            for sink in sinks:
                sink.send(frame)
        busy_ns = time.process_time_ns() - began_busy_ns
    return sent_ns, busy_ns / (monotonic_ns() - began_ns)


def _game(way: str, port: int, opened: ExitStack) -> "subprocess.Popen[str]":
    """One that is listening."""
    words = [sys.executable, "-m", __spec__.name, "--hear", way, "--port", str(port)]
    game = opened.enter_context(subprocess.Popen(words, stdout=subprocess.PIPE, text=True))
    assert game.stdout is not None
    assert game.stdout.readline().strip() == _READY, f"nobody hears {way}"
    return game


def _heard(game: "subprocess.Popen[str]") -> Arrivals:
    said, _ = game.communicate()
    return {int(seq): at_ns for seq, at_ns in json.loads(said).items()}


def hear(way: str, port: int) -> Arrivals:
    """What a game does: every frame, until it is silent."""
    arrivals: Arrivals = {}
    if way == "zenoh":
        with Subscriber(f"tcp/127.0.0.1:{port}", _INSTANCE) as game:
            while not game.connect():
                time.sleep(0.1)
            _say(_READY)
            _wait_for_silence(game)
            return {heard.frame.seq: heard.arrival_ns for heard in game.heard()}
    with _bound(port) as listening:
        _say(_READY)
        for seq in _whole_frames(listening):
            arrivals[seq] = monotonic_ns()
    return arrivals


def _wait_for_silence(game: Subscriber) -> None:
    before, silent_s = 0, 0.0
    while silent_s < (_SILENT_S if before else 10 * _SILENT_S):
        time.sleep(0.1)
        silent_s = silent_s + 0.1 if game.count == before else 0.0
        before = game.count


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def _whole_frames(listening: socket.socket) -> Iterator[int]:
    """The number of each frame when the last of its parts has come."""
    parts_of: dict[int, int] = {}
    listening.settimeout(10 * _SILENT_S)
    while True:
        try:
            datagram = listening.recv(2048)
        except TimeoutError:
            return
        listening.settimeout(_SILENT_S)
        _, seq, _, parts = _frame_numbers.unpack_from(datagram, _NUMBERS_AT)
        parts_of[seq] = parts_of.get(seq, 0) + 1
        if parts_of[seq] == parts:
            yield seq


def _bound(port: int = 0) -> socket.socket:
    one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    one.bind(("127.0.0.1", port))
    return one


def _address(one: socket.socket) -> str:
    return f"127.0.0.1:{one.getsockname()[1]}"


def main() -> None:
    """The command in the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="how long [default: 20]")
    parser.add_argument("--hear", choices=("zenoh", "osc"), help=argparse.SUPPRESS)
    parser.add_argument("--port", type=int, default=0, help=argparse.SUPPRESS)
    told = parser.parse_args()
    if told.hear:
        _say(json.dumps(hear(told.hear, told.port)))
        return
    found = deliver(told.seconds)
    rows = []
    for way, under_way_ms in found.under_way_ms.items():
        shares = np.percentile(under_way_ms, (50.0, 95.0, 99.0)).tolist()
        rows.append((way, *(number(ms, 2) for ms in shares), str(found.lost[way])))
    _say(table(("to a game by", "median ms", "p95 ms", "p99 ms", "lost"), rows))
    _say(
        f"\nall outputs at {RATE_HZ:g} Hz: {100.0 * found.busy_share:.1f} % of a core,"
        f" beside {100.0 * found.idle_share:.1f} % of the loop that hands them the frames"
    )


if __name__ == "__main__":
    main()
