"""One capture thread per camera: the newest frame to the mailbox, a lost camera opened again."""

import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

from mocapd.capture.base import Source
from mocapd.capture.rate import RateMeter
from mocapd.clock import monotonic_ns, seconds
from mocapd.errors import (
    CameraLost,
    ConfigError,
    EndOfStream,
    InputError,
    MocapdError,
    PermissionDeniedError,
    UnavailableError,
)
from mocapd.types import Frame

_LOG = logging.getLogger(__name__)

SILENT_S = 1.0  # from a live camera: so long without a frame is told [s]


class Mailbox(Protocol):
    """Where frames go; `put` never blocks and may displace the frame before."""

    def put(self, item: Frame, /) -> None: ...


@runtime_checkable
class CountsTorn(Protocol):
    """A source that leaves out damaged frames and counts them."""

    torn: int


class CaptureState(StrEnum):
    """`lost` is a state, not an error: the camera is sought again until it is back."""

    OPENING = "opening"
    LIVE = "live"
    LOST = "lost"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class CaptureStatus:
    """A snapshot of one capture thread.

    `reason`: why it is lost or ended, and the mend; empty while live. `reopens`: how often it came
    back after a loss. `fps_hz` is measured from the frames' own times over the last 2 s; it falls by
    the clock while a read blocks. `last_frame_ns`: the newest frame's own time, None before the first.
    `silent_s`: since the newest frame came [s]; 0 unless live.
    """

    camera: str
    state: CaptureState
    reason: str
    frames: int
    torn: int
    reopens: int
    fps_hz: float
    last_frame_ns: int | None
    silent_s: float = 0.0

    @property
    def is_silent(self) -> bool:
        """Whether it counts as live and yet sends nothing: its driver does not come back."""
        return self.state is CaptureState.LIVE and self.silent_s >= SILENT_S

    @property
    def trouble(self) -> str:
        """What is wrong with it, for people; empty when nothing is."""
        return f"silent for {self.silent_s:.0f} s" if self.is_silent else self.reason


@dataclass(frozen=True, slots=True)
class BackOff:
    """The pause before opening a lost camera again: `first_s`, doubled each time up to `longest_s`."""

    first_s: float = 0.1
    longest_s: float = 5.0

    def pause_s(self, failures: int) -> float:
        """The pause [s] after that many failures in a row (1 or more)."""
        return min(self.longest_s, self.first_s * 2.0 ** min(failures - 1, 30))


class CaptureThread:
    """Reads one source until `stop` or the end of a recording.

    `on_death` is called, in the capture thread, with whatever unexpected ended it. A ConfigError of
    the first opening is among them, as waiting does not mend it; a camera that was open before, and now
    has another size, is lost: the other cameras go on. `expected_hz`: warns, once per opening, when the
    measured rate is under nine tenths of it.
    """

    def __init__(
        self,
        source: Source,
        mailbox: Mailbox,
        on_death: Callable[[BaseException], None],
        expected_hz: float | None = None,
        back_off: BackOff | None = None,
    ) -> None:
        self._source = source
        self._mailbox = mailbox
        self._on_death = on_death
        self._expected_hz = expected_hz
        self._back_off = back_off if back_off is not None else BackOff()
        self._stopping = threading.Event()
        self._lock = threading.Lock()  # guards what follows; never held while reading or opening
        self._state = CaptureState.OPENING
        self._reason = ""
        self._frames = 0
        self._openings = 0  # that delivered
        self._last_frame_ns: int | None = None
        self._came_ns = 0  # the newest frame, by the clock
        self._rate = RateMeter()
        # A daemon thread: a driver that never returns must not keep the process from ending.
        self._thread = threading.Thread(
            target=self._run, name=f"capture-{source.name}", daemon=True
        )

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    def let_go(self) -> None:
        """First pass of stopping: wakes the thread; never blocks."""
        self._stopping.set()
        self._source.close()

    def stop(self, timeout_s: float = 1.4) -> bool:
        """Wake and join. False when a driver still blocks the thread after `timeout_s` [s]."""
        self.let_go()
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def status(self) -> CaptureStatus:
        """A snapshot, at any time from any thread; does not wait for a read that blocks."""
        with self._lock:
            live = self._state is CaptureState.LIVE
            silent_ns = monotonic_ns() - self._came_ns if live else 0
            return CaptureStatus(
                camera=self._source.name,
                state=self._state,
                reason=self._reason,
                frames=self._frames,
                torn=self._source.torn if isinstance(self._source, CountsTorn) else 0,
                reopens=max(0, self._openings - 1),
                fps_hz=self._rate.rate_hz(silent_ns) if live else 0.0,
                last_frame_ns=self._last_frame_ns,
                silent_s=seconds(silent_ns),
            )

    def _run(self) -> None:
        try:
            self._capture()
        except MocapdError as error:  # says all there is to say: no traceback
            self._die(error)
        except BaseException as error:
            self._die(error)
            raise
        finally:
            self._source.close()

    def _die(self, error: BaseException) -> None:
        self._set(CaptureState.ENDED, str(error) or type(error).__name__)
        self._on_death(error)

    def _capture(self) -> None:
        failures, opened = 0, False
        while not self._stopping.is_set():
            frames_before = self._frames
            try:
                self._source.open()
                opened = True
                self._read_until_it_fails()
            except EndOfStream as end:
                if self._stopping.is_set():
                    break
                self._set(CaptureState.ENDED, str(end))
                level = logging.WARNING if end.fix else logging.INFO  # fix: it was cut short
                _LOG.log(level, "%s: %s", self._source.name, end)
                return
            except (
                CameraLost, UnavailableError, PermissionDeniedError, InputError, ConfigError
            ) as error:  # fmt: skip
                if isinstance(error, ConfigError) and not opened:
                    raise
                self._source.close()  # else the camera comes back under another number
                if self._stopping.is_set():
                    break
                failures = 1 if self._frames > frames_before else failures + 1
                self._lost(error)
                self._stopping.wait(self._back_off.pause_s(failures))
        self._set(CaptureState.ENDED, "stopped")

    def _read_until_it_fails(self) -> None:
        first, judged = True, False
        while not self._stopping.is_set():
            frame = self._source.read()
            came_ns = monotonic_ns()
            with self._lock:
                if first:  # a camera that opens and sends nothing is still lost
                    first = False
                    self._openings += 1
                    self._rate.clear()
                    self._state, self._reason = CaptureState.LIVE, ""
                self._frames += 1
                self._last_frame_ns, self._came_ns = frame.t_ns, came_ns
                self._rate.add(frame.t_ns)
            self._mailbox.put(frame)
            if not judged and self._rate.full:
                judged = True
                self._judge_rate()

    def _judge_rate(self) -> None:
        measured_hz = self._rate.rate_hz()
        if self._expected_hz is not None and measured_hz < 0.9 * self._expected_hz:
            _LOG.warning(
                "%s: delivers %.1f Hz, asked for %g Hz: in dim light turn off automatic exposure, "
                "else its USB controller or the processor is overloaded",
                self._source.name,
                measured_hz,
                self._expected_hz,
            )

    def _lost(self, error: MocapdError) -> None:
        # Told once for each loss: the attempts that follow fail for reasons of their own. But that it
        # is back, and does not fit, is news.
        was, reason = self._set(CaptureState.LOST, str(error))
        news = isinstance(error, ConfigError) and str(error) != reason
        _LOG.log(
            logging.WARNING if news or was is not CaptureState.LOST else logging.DEBUG,
            "%s: lost: %s",
            self._source.name,
            error,
        )

    def _set(self, state: CaptureState, reason: str) -> tuple[CaptureState, str]:
        """Change state and reason; returns those before."""
        with self._lock:
            before = self._state, self._reason
            self._state, self._reason = state, reason
            return before
