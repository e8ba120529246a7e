"""Tracks a remote clock: a line through the best samples of two minutes, restarted after a jump."""

import threading
from collections import deque

import numpy as np

from mocapd.capture.remote.camera_wire import ClockAnswer
from mocapd.capture.remote.clock_fit import ClockLine, ClockSample, clock_sample, fit_clock
from mocapd.clock import NS_PER_S

_WINDOW_NS = 120 * NS_PER_S  # over longer times temperature changes the drift
_SPAN_NS = 2 * NS_PER_S  # of each span only the samples with the least queueing are used
_BEST_OF_SPAN = 5
_JUMP_SPARE_NS = 1_000_000  # beyond what the round trip allows: the line's own error
_JUMPS = 3  # in a row that no round trip explains: it was set, or the machine slept
_MANY_RESTARTS, _RESTARTS_NS = 5, 60 * NS_PER_S  # within so long: no clock is set that often
_MOST_DRIFT = 6e-4  # quartz is within 1e-4, a time service slews by 5e-4


class ClockTrack:
    """Fits a `ClockLine` to samples. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._best: deque[ClockSample] = deque()  # of each past span
        self._span: list[ClockSample] = []  # all of the current one
        self._strange: list[ClockSample] = []
        self._line: ClockLine | None = None
        self._restarts_ns: deque[int] = deque(maxlen=_MANY_RESTARTS)

    def add_answer(self, asked_ns: int, answer: ClockAnswer, came_ns: int) -> None:
        """Adds an answer with plausible times. asked_ns, came_ns: by our clock [ns]."""
        within_ns = answer.answered_ns - answer.taken_ns
        if 0 <= within_ns <= came_ns - asked_ns + _JUMP_SPARE_NS:
            self.add(clock_sample(asked_ns, answer.taken_ns, answer.answered_ns, came_ns))

    @property
    def line(self) -> ClockLine | None:
        """None before the first sample."""
        return self._line

    def trouble(self, now_ns: int) -> str:
        """Why picture times are unreliable; empty if reliable. now_ns: by our clock."""
        with self._lock:
            restarts, line = self._restarts_ns, self._line
            if len(restarts) == _MANY_RESTARTS and now_ns - restarts[0] <= _RESTARTS_NS:
                return "the clock of its node jumps over and over, so the times of its pictures are uncertain"
        if line is not None and abs(line.drift) > _MOST_DRIFT:
            return (
                "the clock of its node drifts too much, so the times of its pictures are uncertain"
            )
        return ""

    def restart(self, now_ns: int) -> None:
        """Drops all samples: the node has another clock from now on."""
        with self._lock:
            self._restarts_ns.append(now_ns)
            self._forget()
            self._strange.clear()
            self._line = None

    def add(self, sample: ClockSample) -> None:
        """Adds a sample. Ignores outliers; after three in a row the clock has jumped and the fit restarts."""
        with self._lock:
            if self._line is not None and _is_impossible(self._line, sample):
                self._strange.append(sample)
                if len(self._strange) < _JUMPS:
                    return
                self._restarts_ns.append(sample.local_ns)
                self._forget()
                self._span.extend(self._strange)
            else:
                self._keep(sample)
            self._strange.clear()
            samples = (*self._best, *self._span)
            rows = [(s.local_ns, s.offset_ns, s.round_trip_ns) for s in samples]
            self._line = fit_clock(*np.array(sorted(rows), dtype=np.int64).T)

    def _keep(self, sample: ClockSample) -> None:
        if self._span and sample.local_ns - self._span[0].local_ns > _SPAN_NS:
            by_delay = sorted(self._span, key=lambda sample: sample.round_trip_ns)
            self._best.extend(by_delay[:_BEST_OF_SPAN])
            self._span.clear()
        self._span.append(sample)
        while self._best and sample.local_ns - self._best[0].local_ns > _WINDOW_NS:
            self._best.popleft()

    def _forget(self) -> None:
        self._best.clear()
        self._span.clear()


def _is_impossible(line: ClockLine, sample: ClockSample) -> bool:
    """True if even a fully asymmetric round trip does not explain the distance from the line."""
    expected_ns = line.remote_from_local(sample.local_ns) - sample.local_ns
    allowed_ns = sample.round_trip_ns / 2 + 5 * line.uncertainty_ns + line.asymmetry_ns
    return abs(sample.offset_ns - expected_ns) > allowed_ns + _JUMP_SPARE_NS
