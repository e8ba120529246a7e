"""Cameras pulled out and put back at random, a thousand times in ten minutes: the right one is used each time.

Four webcams, two of them without serial numbers, go out and into any free port, also into each other's. What is right
is seen from outside: each picture that a camera delivers is one of the film, of one webcam; a body that names a
camera must have been made of pictures of that webcam.
"""

import random
import statistics
import tempfile
import time
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from pathlib import Path

from tests.faults.faulty_daemon import FaultyDaemon, faulty_daemon
from tests.faults.row import Came, Extent, FaultRow
from tests.faults.socketed_room import WEBCAMS, SocketedRoom

ACTIONS, PAUSE_S = 1000, 0.31  # with what is waited for between them ten minutes in all
SETTLE_EVERY = 25  # actions, after which all are put back where they belong
SETTLED_S = 60.0  # all must take part again by then [s]
SEEN_S = 2.5  # after which each has been seen where it belongs
TOLD_S = 1.0  # 99 of 100 losses must be told by then [s]
_PORTS = (*(f"1-{n}" for n in range(1, 7)), "2-1", "2-3.1")
_NEAR_NS = 25_000_000  # of frames of one set
_MOST_MB, _MOST_FDS, _MOST_THREADS = 12.0, 3.0, 1.0  # growth from the second fifth to the last


@dataclass
class Findings:
    """What is measured on the way."""

    wrong: list[str] = field(default_factory=list)
    told_s: list[float] = field(default_factory=list)
    back_s: list[float] = field(default_factory=list)
    settled_s: list[float] = field(default_factory=list)
    usage: list[tuple[float, float, float]] = field(
        default_factory=list
    )  # MB, threads, descriptors
    checked: int = 0  # uses of a camera in a body
    swaps: int = 0  # of identical webcams, reported
    held: int = 0  # pictures of another webcam, of which nothing was made


class Hands:
    """Who pulls and plugs."""

    def __init__(self, room: SocketedRoom, daemon: FaultyDaemon, seed: int) -> None:
        self._control, self._daemon = room.control, daemon
        self._rng = random.Random(seed)
        self._bodies = self._pictures = 0  # looked at so far
        self.found = Findings()

    def act(self) -> None:
        """One webcam out, or in."""
        name = self._rng.choice(sorted(WEBCAMS))
        plugged = {one.webcam: port for port, one in self._control.sockets.items()}
        if name in plugged:
            self._pull(name)
            return
        free = [port for port in _PORTS if port not in plugged.values()]
        own = self._control.port_of(name)
        port = own if own in free and self._rng.random() < 0.5 else self._rng.choice(free)
        began_s = time.monotonic()
        self._control.plug(name, port)
        if self._has_serial(name):  # by which it is known wherever it is
            self._wait_for_picture(name, began_s)

    def swap_identical(self) -> None:
        """The two that only their ports tell apart, each into the other's: they must take no part, and say why."""
        identical = [name for name in WEBCAMS if not self._has_serial(name)]
        for name in identical:
            self._control.plug(name)
        time.sleep(SEEN_S)
        for name in identical:
            self._control.unplug(name)
        time.sleep(0.3)
        for name, other in zip(identical, reversed(identical), strict=True):
            self._control.plug(name, self._control.port_of(other))
        until_s = time.monotonic() + SETTLED_S
        while not all("were swapped" in self._daemon.told[name].detail for name in identical):
            if time.monotonic() > until_s:
                told = {name: self._daemon.told[name].detail for name in identical}
                self.found.wrong.append(f"swapped webcams are not told: {told}")
                return
            time.sleep(0.02)
        self.found.swaps += 1

    def pause(self) -> None:
        """Between two actions."""
        time.sleep(self._rng.uniform(0.3, 1.7) * PAUSE_S)

    def settle(self) -> None:
        """All where they belong: all must take part again. Then what came meanwhile is looked at."""
        for name in WEBCAMS:
            self._control.unplug(name)
        time.sleep(0.15)
        for name in WEBCAMS:
            self._control.plug(name)
        began_s = time.monotonic()
        while not self._all_take_part(began_s):
            if time.monotonic() - began_s > SETTLED_S or self._daemon.process.poll() is not None:
                told = {name: one.detail or one.state for name, one in self._daemon.told.items()}
                self.found.wrong.append(f"not all are back after {SETTLED_S:.0f} s: {told}")
                break
            time.sleep(0.02)
        self.found.settled_s.append(time.monotonic() - began_s)
        self._compare()
        with self._daemon.usage.oneshot():
            usage = self._daemon.usage
            rss_mb = usage.memory_info().rss / 1e6
            self.found.usage.append((rss_mb, usage.num_threads(), usage.num_fds()))

    def _has_serial(self, name: str) -> bool:
        return not WEBCAMS[name].endswith(":")

    def _pull(self, name: str) -> None:
        status = self._daemon.told.get(name)
        # an identical one in another's port is another camera's, whose loss that is
        was_live = self._has_serial(name) and status is not None and status.state == "live"
        began_s = time.monotonic()
        self._control.unplug(name)
        while was_live and self._daemon.told[name].state == "live":
            if time.monotonic() - began_s > 5.0 * TOLD_S:
                break
            time.sleep(0.005)
        if was_live:
            self.found.told_s.append(time.monotonic() - began_s)

    def _wait_for_picture(self, name: str, began_s: float) -> None:
        newest = len(self._daemon.pictures)
        while time.monotonic() - began_s < SETTLED_S:
            for one in self._daemon.pictures[newest:]:
                if one.camera == name:
                    self.found.back_s.append(one.came_s - began_s)
                    return
            time.sleep(0.005)
        self.found.wrong.append(f"{name} does not come back within {SETTLED_S:.0f} s")

    def _all_take_part(self, since_s: float) -> bool:
        newest = self._daemon.bodies[-1:]
        return any(one.came_s > since_s and set(one.cameras) == set(WEBCAMS) for one in newest)

    def _compare(self) -> None:
        """Which webcam's pictures the bodies were made of."""
        time.sleep(0.3)  # what is on its way
        bodies, pictures = self._daemon.bodies, self._daemon.pictures
        of: dict[str, list[tuple[int, str]]] = {name: [] for name in WEBCAMS}
        for picture in pictures:
            of[picture.camera].append((picture.unix_ns, picture.shows))
        for body in bodies[:-1]:
            for name in body.cameras:
                low = bisect_left(of[name], (body.unix_ns - _NEAR_NS, ""))
                high = bisect_right(of[name], (body.unix_ns + _NEAR_NS, "~"))
                shown = {shows for _, shows in of[name][low:high]}
                self.found.checked += bool(shown)
                if shown and name not in shown:
                    self.found.wrong.append(f"body {body.seq}: {name} was {shown}")
        self.found.held += sum(shows != name for name, seen in of.items() for _, shows in seen)
        del bodies[:-1]
        pictures.clear()


def run(extent: Extent) -> Came:
    """See FaultRow."""
    actions = round(extent.of(ACTIONS, SETTLE_EVERY))
    with tempfile.TemporaryDirectory() as folder:
        room = SocketedRoom(Path(folder), extent.rate_hz)
        with faulty_daemon(Path(folder), *room.words, shows=room.shows) as daemon:
            hands = Hands(room, daemon, extent.seed)
            time.sleep(SEEN_S)  # identical webcams that were never seen cannot be told apart
            hands.settle()
            for count in range(1, actions + 1):
                hands.act()
                hands.pause()
                if count % SETTLE_EVERY == SETTLE_EVERY // 2:
                    hands.swap_identical()
                if count % SETTLE_EVERY == 0:
                    hands.settle()
                if daemon.process.poll() is not None:
                    break
            found = hands.found
            if daemon.process.poll() is not None:
                found.wrong.insert(0, f"the daemon ended: {daemon.log[-3000:]}")
            elif (code := daemon.end()) != 0:
                found.wrong.append(f"exit code {code}")
            if "Traceback" in daemon.log:
                found.wrong.append(daemon.log[daemon.log.index("Traceback") :][:3000])
    figures = _figures(actions, found)
    late_s = sorted(one for one in found.told_s if one > TOLD_S)
    if extent.share >= 1.0 and len(late_s) > 0.01 * len(
        found.told_s
    ):  # in a test no time is judged
        found.wrong.append(f"losses were told after {late_s} s")
    return Came(figures, tuple(found.wrong))


def _figures(actions: int, found: Findings) -> str:
    if not (found.checked and found.held and found.swaps):
        found.wrong.append("nothing was compared")
    parts = [
        f"{actions} times, {found.checked} uses of a picture compared, {found.held} pictures of another webcam held back, "
        f"{found.swaps} swaps of identical webcams told",
        f"a loss told after {_span(found.told_s)} s, a picture after {_span(found.back_s)} s, all four at work after "
        f"{_span(found.settled_s)} s",
    ]
    fifth = len(found.usage) // 5
    if fifth:  # in a short run there is nothing to compare
        before, after = found.usage[fifth : 2 * fifth], found.usage[-fifth:]
        growth = [
            statistics.median(column_after) - statistics.median(column_before)
            for column_before, column_after in zip(
                zip(*before, strict=True), zip(*after, strict=True), strict=True
            )
        ]
        parts.append(
            f"{growth[0]:+.1f} MB, {growth[1]:+.0f} threads, {growth[2]:+.0f} file descriptors"
        )
        for grown, most in zip(growth, (_MOST_MB, _MOST_THREADS, _MOST_FDS), strict=True):
            if grown > most:
                found.wrong.append(f"grown: {parts[-1]}")
    return "; ".join(parts)


def _span(values: list[float]) -> str:
    """Median and largest."""
    return f"{statistics.median(values):.2f} (at most {max(values):.2f})" if values else "-"


ROW = FaultRow(
    "1,000 random unplug/replug of simulated cameras in 10 min",
    "0 crashes, right camera each time, memory, threads and file descriptors flat",
    run,
)
