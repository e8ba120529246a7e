"""From a stream's sightings to the match's ticks: a fixed step, whatever the pictures' rate."""

from goalkeeper.core.events import Event
from goalkeeper.core.keeper_track import KeeperTrack
from goalkeeper.core.match import Match
from goalkeeper.core.pitch import TICK_S
from goalkeeper.streams.sighting import PoseStream

_MOST_TICKS = 30  # made up for at once; a machine that stood still for longer has its clock put on


class FixedSteps:
    """Runs the match up to a time; the clock is that of the stream's sightings [s]."""

    def __init__(self, match: Match, stream: PoseStream) -> None:
        self.match, self._stream = match, stream
        self.track = KeeperTrack()
        self.newest_s: float | None = None  # capture time of the newest sighting
        self._next = 1  # number of the next tick
        self._began_s = 0.0

    def begin(self, now_s: float) -> None:
        """The clock's first time."""
        self._began_s, self._next = now_s, 1

    def tick(self) -> list[Event]:
        """The next tick, whatever the time is."""
        t_s = self._began_s + self._next * TICK_S
        self._next += 1
        for one in self._stream.poll(t_s):
            self.track.add(one.captured_s, one.pose)
            self.newest_s = one.captured_s
        return self.match.tick(self.track.at(t_s))

    def run_to(self, now_s: float) -> list[Event]:
        """All ticks that are due."""
        due = int((now_s - self._began_s) / TICK_S) - self._next + 1
        if due > _MOST_TICKS:
            self._began_s += (due - _MOST_TICKS) * TICK_S
            due = _MOST_TICKS
        return [event for _ in range(due) for event in self.tick()]
