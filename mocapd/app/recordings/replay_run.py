"""Implementation of `mocapd replay`: sends a recording through the outputs in real time, with current times.

Intervals between publications and the delay from capture to publication are those of the recording, so capture times
work for prediction and latency displays. Frame numbers continue across loops; names and keys are this daemon's.
"""

import itertools
import logging
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import msgspec

from mocapd.clock import NS_PER_S, monotonic_ns, unix_from_monotonic_ns
from mocapd.errors import InputError, MocapdError
from mocapd.latch import Latch
from mocapd.outputs.base import Sink
from mocapd.outputs.mcap.recording_reader import Recorded, RecordingReader
from mocapd.outputs.wire import SkeletonFrame

_log = logging.getLogger(__name__)
LONGEST_PAUSE_NS = 60 * NS_PER_S  # between two frames; a longer pause or a step back is skipped
_STOP_S = 1.0


@dataclass(frozen=True, slots=True)
class ReplayParams:
    """speed: factor, 1 is real time; loop: repeat without end; from_s: start within the recording [s]."""

    speed: float = 1.0
    loop: bool = False
    from_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ReplayPlace:
    """Position of a replay: time in the recording [s], finished rounds, sent frames."""

    at_s: float = 0.0
    rounds: int = 0
    frames: int = 0


class Replay:
    """Runs in a thread of its own from `start` to the recording's end or `end`; `place` is thread-safe."""

    def __init__(
        self,
        reader: RecordingReader,
        sinks: Sequence[Sink],
        instance: str,
        params: ReplayParams,
        clock: Callable[[], int] = monotonic_ns,
    ) -> None:
        self._reader, self._sinks, self._instance = reader, tuple(sinks), instance
        self._params, self._clock = params, clock
        self._ended = Latch()
        self._error: MocapdError | None = None
        self._over = False
        self._thread = threading.Thread(target=self._run, name="replay", daemon=True)
        self._seqs: dict[int, Iterator[int]] = {}
        self.place = ReplayPlace()

    def start(self) -> None:
        """Starts; returns at once."""
        self._thread.start()

    def end(self) -> None:
        """Ends the replay; thread-safe and signal-safe."""
        self._ended.set()

    def wait(self, timeout_s: float) -> bool:
        """True when it is over. Raises the error that ended it: InputError for an unplayable file."""
        self._thread.join(_STOP_S if self._ended.is_set() else timeout_s)
        if self._error is not None:
            raise self._error
        if not (self._thread.is_alive() or self._over):
            raise RuntimeError("the thread of the replay died, see above")
        return self._ended.is_set() or self._over

    def _run(self) -> None:
        try:
            for rounds in itertools.count():
                self.play_once(rounds)
                if self._ended.is_set() or not self._params.loop:
                    break
            self._over = True
        except MocapdError as error:  # raised again by `wait`, in the thread that watches
            self._error = error

    def play_once(self, rounds: int = 0) -> None:
        """Plays the recording once. Raises InputError."""
        params, played = self._params, False
        due_ns = self._clock()
        at_ns = 0
        before: SkeletonFrame | None = None
        for item in self._reader.everything():
            if self._ended.is_set():
                return
            if not isinstance(item, SkeletonFrame):
                self._send_state(item)
                continue
            step_ns = _step_ns(before, item)
            before = item
            at_ns += step_ns
            if at_ns < params.from_s * NS_PER_S:
                continue
            if played:
                due_ns += round(step_ns / params.speed)
            played = True
            if self._ended.wait(max(0, due_ns - self._clock()) / NS_PER_S):
                return
            self._send(item)
            self.place = ReplayPlace(at_ns / NS_PER_S, rounds, self.place.frames + 1)
        if not played:
            raise InputError(
                f"ends after {at_ns / NS_PER_S:.1f} s",
                str(self._reader.path),
                "begin earlier with --from",
            )

    def _send(self, frame: SkeletonFrame) -> None:
        """Sends a frame with current times."""
        now_ns = self._clock()
        capture_ns = now_ns - (frame.publish_monotonic_ns - frame.capture_monotonic_ns)
        seq = self._seqs.setdefault(frame.person, itertools.count())
        sent = msgspec.structs.replace(
            frame,
            instance=self._instance,
            seq=next(seq),
            capture_monotonic_ns=capture_ns,
            capture_unix_ns=capture_ns + unix_from_monotonic_ns(),
            publish_monotonic_ns=now_ns,
        )
        for sink in self._sinks:
            sink.send(sent)

    def _send_state(self, state: Recorded) -> None:
        assert not isinstance(state, SkeletonFrame)
        message = msgspec.structs.replace(state, instance=self._instance)
        for sink in self._sinks:
            sink.send_state(message)


def _step_ns(before: SkeletonFrame | None, frame: SkeletonFrame) -> int:
    """Interval between the publications of two frames [ns]; 0 for a long pause or a step back."""
    if before is None:
        return 0
    step_ns = frame.publish_monotonic_ns - before.publish_monotonic_ns
    if 0 <= step_ns <= LONGEST_PAUSE_NS:
        return step_ns
    what = "pause" if step_ns > 0 else "step back of the clock"
    _log.warning("a %s of %.0f s in the recording is left out", what, abs(step_ns) / NS_PER_S)
    return 0
