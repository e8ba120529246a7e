"""Cameras that stay plugged in and are not well, several at a time: each is told of in its own words, and cured."""

import random
import statistics
import tempfile
import time
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

from mocapd.capture.simulated.sockets import Fault
from tests.faults.faulty_daemon import FaultyDaemon, faulty_daemon
from tests.faults.row import Came, Extent, FaultRow
from tests.faults.socketed_room import WEBCAMS, SocketedRoom

ROUNDS = 30
AT_A_TIME = 3  # so that one is left that is well
_TOLD_S, _CURED_S = 60.0, 60.0
_WORDS: Mapping[Fault, str] = MappingProxyType(
    {
        Fault.FROZEN: "sends the same picture over and over",
        Fault.BLACK: "its picture is black",
        Fault.TORN: "many of its pictures come damaged",
        Fault.SMALL: "sends 160x120, its calibration is for 320x240: it takes no part",
        Fault.STALLED: "sent nothing for 1.0 s",
        Fault.STUCK: "its driver has not come back for",
    }
)


class Ward:
    """Makes webcams ill and well, and waits for what is told."""

    def __init__(self, room: SocketedRoom, daemon: FaultyDaemon, seed: int) -> None:
        self._control, self._daemon = room.control, daemon
        self._rng = random.Random(seed)
        self.wrong: list[str] = []
        self.told_s: dict[Fault, list[float]] = {fault: [] for fault in _WORDS}
        self.cured_s: list[float] = []
        self.longest_gap_s = 0.0  # between bodies
        self.left_out = 0  # that failed over and over, and were plugged in anew

    def round(self, faults: list[Fault]) -> None:
        """These at once, each of another webcam; then all are cured."""
        ill = dict(zip(self._rng.sample(sorted(WEBCAMS), len(faults)), faults, strict=True))
        began_s, first = time.monotonic(), len(self._daemon.bodies)
        for name, fault in ill.items():
            self._control.ail(name, fault)
        waiting = dict(ill)
        while waiting and time.monotonic() - began_s < _TOLD_S:
            for name, fault in list(waiting.items()):
                if _WORDS[fault] in self._daemon.told[name].detail:
                    self.told_s[fault].append(time.monotonic() - began_s)
                    del waiting[name]
            time.sleep(0.02)
        self.wrong += [
            f"{name} is {fault.value}, and told is {self._daemon.told[name]}"
            for name, fault in waiting.items()
        ]
        cured_s = time.monotonic()
        for name in ill:
            self._control.ail(name, Fault.NONE)
        if not self._wait(self._all_well):
            told = {name: one.detail or one.state for name, one in self._daemon.told.items()}
            self.wrong.append(f"after {ill} not all are well: {told}")
        self.cured_s.append(time.monotonic() - cured_s)
        came_s = [one.came_s for one in self._daemon.bodies[first:]]
        gaps_s = [b - a for a, b in pairwise(came_s)]
        self.longest_gap_s = max([self.longest_gap_s, *gaps_s])
        del self._daemon.bodies[:-1]

    def shuffled(self) -> list[Fault]:
        """All of them in another order."""
        return self._rng.sample(list(_WORDS), len(_WORDS))

    def _all_well(self) -> bool:
        for name, one in self._daemon.told.items():
            if one.detail.startswith("left out"):  # which people end by its plug
                self.left_out += 1
                self._control.unplug(name)
                self._control.plug(name)
                self._wait(lambda name=name: not self._daemon.told[name].detail)  # type: ignore[misc]
        newest = self._daemon.bodies[-1]
        return set(newest.cameras) == set(WEBCAMS) and not any(
            one.detail for one in self._daemon.told.values()
        )

    def _wait(self, condition: Callable[[], bool]) -> bool:
        until_s = time.monotonic() + _CURED_S
        while not condition():
            if time.monotonic() > until_s:
                return False
            time.sleep(0.02)
        return True


def run(extent: Extent) -> Came:
    """See FaultRow."""
    with tempfile.TemporaryDirectory() as folder:
        room = SocketedRoom(Path(folder), extent.rate_hz)
        with faulty_daemon(Path(folder), *room.words) as daemon:
            daemon.until(lambda: len(daemon.told) == len(WEBCAMS) and daemon.bodies, "cameras")
            ward = Ward(room, daemon, extent.seed)
            rounds = round(extent.of(ROUNDS, 2))
            faults: list[Fault] = []
            for _ in range(rounds):
                faults = faults or ward.shuffled()
                ward.round([faults.pop() for _ in range(AT_A_TIME)])
            wrong = list(ward.wrong)
            if (code := daemon.end()) != 0:
                wrong.append(f"exit code {code}: {daemon.log[-3000:]}")
            if extent.share >= 1.0 and ward.longest_gap_s > 1.0:  # in a test no time is judged
                wrong.append(f"no body for {ward.longest_gap_s:.1f} s")
    told = ", ".join(
        f"{fault.value} {statistics.median(seen):.1f}"
        for fault, seen in ward.told_s.items()
        if seen
    )
    figures = (
        f"{rounds * AT_A_TIME} faults, told after (median, s): {told}; cured after at most {max(ward.cured_s):.1f} s; "
        f"{ward.left_out} left out until they were plugged in anew; "
        f"longest time without a body {ward.longest_gap_s:.2f} s"
    )
    return Came(figures, tuple(wrong))


ROW = FaultRow(
    "cameras that freeze, go black, tear, shrink, stall or hang in their driver, three of four at a time",
    "each told in its own words, the other goes on, and all take part again once they are cured",
    run,
)
