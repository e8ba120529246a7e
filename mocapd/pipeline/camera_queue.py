"""One camera's queued frames, and the prediction of its next frame's time."""

from collections import deque

from mocapd.clock import NS_PER_S
from mocapd.types import Frame

_REMEMBERED = 8  # intervals and delays; their median tolerates three outliers
_LONGEST_PERIOD_NS = NS_PER_S  # a longer interval is an outage, not a rate
_SHORTEST_PERIOD_NS = NS_PER_S // 1000  # a shorter one is an error of the source


class CameraQueue:
    """Frames in order of capture, the estimated period and delay [ns], and the counts."""

    def __init__(self, name: str, period_ns: int) -> None:
        self.name = name
        self.frames: deque[tuple[Frame, int]] = deque()  # with arrival [ns]
        self.received = self.used = self.late = self.lost = 0
        self.missed = 0  # sets in a row that went without this camera after waiting for it
        self.offset_ns = 0  # from the last set's anchor; 0 when not in that set
        self.period_ns = max(period_ns, _SHORTEST_PERIOD_NS)
        self.delay_ns = 0
        self._newest: tuple[int, int] | None = None  # seq and capture time
        self._periods: deque[int] = deque(maxlen=_REMEMBERED)
        self._delays: deque[int] = deque(maxlen=_REMEMBERED)

    @property
    def has_received(self) -> bool:
        """True after the first frame: period and delay are measured."""
        return self._newest is not None

    @property
    def head_ns(self) -> int:
        """Capture time of the oldest queued frame."""
        return self.frames[0][0].t_ns

    @property
    def head_arrival_ns(self) -> int:
        """Arrival time of the oldest queued frame."""
        return self.frames[0][1]

    def accept(self, frame: Frame, arrival_ns: int) -> None:
        """Queue a frame and update the estimates. A frame that is not newer than its predecessor counts as late."""
        self.received += 1
        self.missed = 0
        if self._newest is not None:
            seq, t_ns = self._newest
            if frame.t_ns <= t_ns:
                self.late += 1
                return
            self._learn(frame.seq - seq, frame.t_ns - t_ns)
        self._delays.append(arrival_ns - frame.t_ns)
        self.delay_ns = _median(self._delays)
        self._newest = frame.seq, frame.t_ns
        self.frames.append((frame, arrival_ns))

    def _learn(self, steps: int, interval_ns: int) -> None:
        """Period and lost frames from the difference of two successive frames in `seq` and in time.

        `seq` may come from an untrusted camera node, so a gap counts at most the frames that fit into the time. `seq`
        restarts when a camera is reopened: then the gap is unknown.
        """
        period_ns = interval_ns // max(1, steps)
        if _SHORTEST_PERIOD_NS <= period_ns <= _LONGEST_PERIOD_NS:
            self._periods.append(period_ns)
            self.period_ns = _median(self._periods)
        most = interval_ns // self.period_ns + 1
        self.lost += max(0, min(steps - 1, most))

    def use(self) -> Frame:
        """Take the oldest frame."""
        self.used += 1
        return self.frames.popleft()[0]

    def discard(self) -> None:
        """Drop the oldest frame as late."""
        self.late += 1
        self.frames.popleft()

    def expected_ns(self, near_ns: int) -> int:
        """The capture time, nearest to `near_ns`, of a frame still to come."""
        if self._newest is None:
            return near_ns  # before the first frame: it may come at any time
        newest_ns = self._newest[1]
        steps = round((near_ns - newest_ns) / self.period_ns)
        return newest_ns + max(1, steps) * self.period_ns


def _median(values: deque[int]) -> int:
    return sorted(values)[len(values) // 2]
