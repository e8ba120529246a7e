"""A daemon with a good camera node and a malicious one: what comes of the good one under each kind of the other.

    python -m tests.attacks.malicious_nodes [--seconds S] [KIND...]

prints a table: the rate of the good camera as the daemon has it and as its node has sent it, the daemon's exit, the lines
of its log, its peak of memory, and what it says of the other camera. The first row is with an honest second node: the
machine may be busy. Exit code 1 when the good camera has less than 29 of 30 pictures of what was sent, and of what it
had in the first row, or the daemon ended, wrote more than 150 lines a minute, or took more than 300 MiB above that row.
"""

import argparse
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import zenoh

from mocapd.boundary.parsing import decode_msgpack
from mocapd.client import Link, connect
from mocapd.outputs.messages import CameraStatus
from mocapd.outputs.zenoh import keys
from tests.attacks.attacked import Attacked, attacked
from tests.attacks.node_kinds import KINDS
from tests.attacks.rogue_node import rogue_process
from tests.attacks.scenario import Found, Scenario
from tests.outputs.frames import free_port

HONEST = "honest"
SHARE = 29 / 30  # of the pictures sent, that the good camera has to keep
MOST_LINES, PER_S = 150, 60.0
MORE_MIB = 300.0
_START_S = 60.0  # until the good camera is live
_SHORT_S = 12.0  # of the scenarios of `make attack`
_SHORT = ("seq-0-and-most", "png-ztxt", "jpeg-comments", "jpeg-damaged", "states-large", "3000-hz-of-100-kb")  # fmt: skip


@dataclass(slots=True)
class Seen:
    """What the daemon says of one camera: (time of arrival [s], pictures so far), and its last state."""

    counts: list[tuple[float, int]] = field(default_factory=list)
    state: str = ""

    @property
    def rate_hz(self) -> float:
        """Between the first and the last message; 0 while there are none."""
        if len(self.counts) < 2:
            return 0.0
        (began_s, before), (ended_s, after) = self.counts[0], self.counts[-1]
        return (after - before) / (ended_s - began_s)


@dataclass(frozen=True, slots=True)
class Row:
    """One kind. good_hz, sent_hz: of the good camera; exit_code: None while it runs."""

    kind: str
    seconds: float
    good_hz: float
    sent_hz: float
    exit_code: int | None
    lines: int
    peak_mib: float
    other: str

    def misses(self, honest: "Row | None") -> list[str]:
        """What is not as wanted."""
        found = []
        if self.exit_code is not None:
            found.append("ended")
        possible_hz = min(30.0, self.sent_hz, honest.good_hz if honest is not None else 30.0)
        if self.good_hz < SHARE * possible_hz:
            found.append("rate")
        if self.lines > MOST_LINES * max(1.0, self.seconds / PER_S):
            found.append("log")
        if honest is not None and self.peak_mib > honest.peak_mib + MORE_MIB:
            found.append("memory")
        return found


def under_attack(kind: str, seconds: float) -> Row:
    """A daemon of its own, for so long."""
    with (
        rogue_process(free_port(), "good", HONEST) as good,
        rogue_process(free_port(), "bad", kind) as bad,
    ):
        cameras = ("--camera", f"good={good.address}", "--camera", f"bad={bad.address}")
        with attacked(cameras=cameras) as daemon:
            seen = _watched(daemon, seconds)
            exit_code = daemon.process.poll()
            peak_mib = daemon.peak_mib() if exit_code is None else float("nan")
            lines = daemon.log.read_bytes().count(b"\n")
    other = seen["bad"]
    said = f"{other.rate_hz:.1f} Hz, {other.state}"
    return Row(kind, seconds, seen["good"].rate_hz, good.rate_hz, exit_code, lines, peak_mib, said)


def _watched(daemon: Attacked, seconds: float) -> dict[str, Seen]:
    seen = {"good": Seen(), "bad": Seen()}
    is_live = threading.Event()

    def heard(sample: zenoh.Sample) -> None:
        status = decode_msgpack(sample.payload.to_bytes(), CameraStatus)
        one = seen[status.camera]
        one.counts.append((time.monotonic(), status.frames))
        one.state = f"{status.state} {status.detail}".strip()
        if status.camera == "good" and status.state == "live":
            is_live.set()

    with connect(Link(f"tcp/127.0.0.1:{daemon.port}")) as session:
        handler = zenoh.handlers.Callback(heard, indirect=False)
        subscriber = session.declare_subscriber(keys.camera_status(keys.ANY, keys.ANY), handler)
        is_live.wait(_START_S)
        for one in seen.values():
            one.counts.clear()
        until_s = time.monotonic() + seconds
        while time.monotonic() < until_s and daemon.process.poll() is None:
            time.sleep(0.2)
        subscriber.undeclare()  # type: ignore[no-untyped-call]
    return seen


def line_of(row: Row, honest: Row | None) -> str:
    """Of the table."""
    ended = "-" if row.exit_code is None else str(row.exit_code)
    misses = ", ".join(row.misses(honest)) or "ok"
    return (
        f"{row.kind:22}{row.good_hz:8.1f}{row.sent_hz:8.1f}{ended:>6}{row.lines:7}{row.peak_mib:8.0f}  {misses:8}"
        f"  {row.other[:110]}"
    )


def _short_run() -> Found:
    honest = under_attack(HONEST, _SHORT_S)
    rows = [under_attack(kind, _SHORT_S) for kind in _SHORT]
    worst = min(row.good_hz / row.sent_hz for row in rows)
    missed = [f"{row.kind}: {', '.join(found)}" for row in rows if (found := row.misses(honest))]
    figure = f"the good camera kept {worst:.0%}, most lines {max(row.lines for row in rows)}"
    return Found("; ".join([figure, *missed]), not missed)


SCENARIOS = {
    "malicious-nodes": Scenario(
        "the good camera goes on, the daemon too, at most 150 lines of log", _short_run
    )
}


def main(words: Sequence[str]) -> int:
    """The exit code."""
    parser = argparse.ArgumentParser("python -m tests.attacks.malicious_nodes")
    parser.add_argument("--seconds", type=float, default=60.0, help="of each kind")
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    options = parser.parse_args(words)
    if unknown := set(options.kinds) - set(KINDS):
        parser.error(f"there is no {', '.join(sorted(unknown))}")
    kinds = [HONEST, *(kind for kind in options.kinds or KINDS if kind != HONEST)]
    print(
        f"{'kind':22}{'good Hz':>8}{'sent':>8}{'exit':>6}{'lines':>7}{'MiB':>8}  {'':8}  the other camera"
    )
    honest: Row | None = None
    missed = 0
    for kind in kinds:
        row = under_attack(kind, options.seconds)
        honest = honest or row
        missed += bool(row.misses(honest))
        print(line_of(row, honest), flush=True)
    print(f"{len(kinds) - missed} of {len(kinds)} held")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
