"""One capture thread per camera: the newest frame to the mailbox, a lost camera opened again.

A thread that is stuck in a driver cannot be ended: it is abandoned, and another one takes its place. What the
abandoned one brings, should it ever come back, is thrown away, and it touches its source no more.
"""

import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from mocapd.capture.base import CountsTorn, LookedAfter, Notices, Pluggable, Source
from mocapd.capture.camera_thread.capture_record import CaptureRecord
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.capture.camera_thread.frame_faults import FrameFaults
from mocapd.capture.camera_thread.reopening import BackOff, RestartBudget
from mocapd.clock import monotonic_ns, nanoseconds, seconds
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

STUCK_S = 8.0  # in one call of a driver; the longest of those that come back takes 3 [s]
MOST_STUCK = 3  # threads of one camera that hang in its driver at a time
_LOOK_S = 0.25  # how often a lost camera's socket is looked at [s]


class Mailbox(Protocol):
    """Where frames go; `put` never blocks and may displace the frame before."""

    def put(self, item: Frame, /) -> None: ...


class Presence(Protocol):
    """Who must know of every loss of a camera before its next frame; called in the capture thread, never blocks."""

    def went(self, camera: str, /) -> None: ...


class CaptureThread:
    """Reads one source until `stop` or the end of a recording.

    `on_death` is called, in the capture thread, with whatever unexpected ended it. A ConfigError of
    the first attempt to open it is among them, as waiting does not mend it; a camera that comes later, or
    comes back, and has another size, is lost: the other cameras go on. `expected_hz`: warns, once per
    opening, when the measured rate is under nine tenths of it. `size_px`: of its calibration.
    """

    def __init__(
        self,
        source: Source,
        mailbox: Mailbox,
        on_death: Callable[[BaseException], None],
        expected_hz: float | None = None,
        back_off: BackOff | None = None,
        *,
        budget: RestartBudget | None = None,
        size_px: tuple[int, int] | None = None,
        presence: Presence | None = None,
        stuck_s: float = STUCK_S,
    ) -> None:
        self._source = source
        self._counts_torn = (
            source if isinstance(source, CountsTorn) else None
        )  # asked once: it takes 0.1 ms
        self._notices = source if isinstance(source, Notices) else None
        self._plug = source if isinstance(source, Pluggable) else None
        self._keeper = source if isinstance(source, LookedAfter) else None
        self._mailbox = mailbox
        self._on_death = on_death
        self._expected_hz = expected_hz
        self._back_off = back_off if back_off is not None else BackOff()
        self._budget = budget if budget is not None else RestartBudget()
        self._faults = FrameFaults(size_px)
        self._presence = presence
        self._stuck_s = stuck_s
        self._stopping = threading.Event()
        self._woken = threading.Event()  # the pause before reopening is over
        self._record = CaptureRecord(source.name)
        self._turn = 0  # of the thread that reads; those before it were abandoned
        self._called_ns: int | None = None  # since when it is in its driver
        self._renewal = ""  # why it is opened anew though it does not fail
        self._plugging = ""  # see Pluggable
        self._stuck: list[threading.Thread] = []  # abandoned
        self._hang = CameraLost("")  # what is told while one of them hangs
        self._thread = self._new_thread()

    # -- the owner's -----------------------------------------------------------------------------

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    def let_go(self) -> None:
        """First pass of stopping: wakes the thread; never blocks."""
        self._stopping.set()
        self._woken.set()
        self._source.close()

    def stop(self, timeout_s: float = 1.4) -> bool:
        """Wake and join. False when a driver still blocks the thread after `timeout_s` [s]."""
        self.let_go()
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def look_again(self) -> None:
        """A camera was plugged in, maybe this one: where it is lost it is sought now. From any thread."""
        self._woken.set()

    def renew(self, why: str) -> None:
        """Open it again, although it has not failed; from any thread, never blocks."""
        self._renewal = why
        self._woken.set()
        self._source.close()

    def watch(self) -> None:
        """Replace the thread where its driver has not come back; call it about once a second, from one thread.

        Of recordings, which may be slow, nothing is expected. Where several hang already, no further one is
        risked until one of them comes back.
        """
        self._stuck = [one for one in self._stuck if one.is_alive()]
        called_ns = self._called_ns
        stuck_ns = 0 if called_ns is None else monotonic_ns() - called_ns
        if stuck_ns >= nanoseconds(self._stuck_s) and not self._source.recorded:
            self._abandon(stuck_ns)
        never_ran = self._turn > 0 and self._thread.ident is None
        if never_ran and len(self._stuck) < MOST_STUCK and not self._stopping.is_set():
            self._thread.start()

    def _abandon(self, stuck_ns: int) -> None:
        self._turn += 1
        self._called_ns = None
        self._stuck.append(self._thread)
        self._thread = self._new_thread()
        self._hang = CameraLost(
            f"its driver has not come back for {seconds(stuck_ns):.0f} s, and is left to itself",
            fix="unplug the camera and plug it in again",
        )
        self._lost(self._hang)
        self._source.close()

    def status(self) -> CaptureStatus:
        """A snapshot, at any time from any thread; does not wait for a read that blocks."""
        return self._record.status(self._torn())

    # -- the thread's ----------------------------------------------------------------------------

    def _new_thread(self) -> threading.Thread:
        # A daemon thread: a driver that never returns must not keep the process from ending.
        name = f"capture-{self._source.name}"
        return threading.Thread(target=self._run, args=(self._turn,), name=name, daemon=True)

    def _over(self, turn: int) -> bool:
        return self._stopping.is_set() or turn != self._turn

    def _run(self, turn: int) -> None:
        try:
            self._capture(turn)
        except MocapdError as error:  # says all there is to say: no traceback
            self._die(error, turn)
        except BaseException as error:
            self._die(error, turn)
            raise
        finally:
            if turn == self._turn:
                self._source.close()

    def _die(self, error: BaseException, turn: int) -> None:
        if turn == self._turn:
            self._record.ended(str(error) or type(error).__name__)
        self._on_death(error)

    def _capture(self, turn: int) -> None:
        failures, first = 0, turn == 0
        while not self._over(turn):
            frames_before = self._record.frames
            try:
                self._woken.clear()
                self._renewal = ""
                self._plugging = self._plugged_now()
                with self._called(turn):
                    self._source.open()
                self._read_until_it_fails(turn)
            except EndOfStream as end:
                if self._over(turn):
                    break
                self._record.ended(str(end))
                level = logging.WARNING if end.fix else logging.INFO  # fix: it was cut short
                _LOG.log(level, "%s: %s", self._source.name, end)
                return
            except (
                CameraLost, UnavailableError, PermissionDeniedError, InputError, ConfigError
            ) as error:  # fmt: skip
                if self._over(turn):
                    break
                if isinstance(error, ConfigError) and first:
                    raise
                self._source.close()  # else the camera comes back under another number
                delivered = self._record.frames > frames_before
                failures = 1 if delivered else failures + 1
                self._wait_after(error, delivered, failures)
            first = False
        if turn == self._turn:
            self._record.ended("stopped")

    def _read_until_it_fails(self, turn: int) -> None:
        first, judged = True, False
        self._faults.clear()
        while not self._over(turn):
            with self._called(turn):
                frame = self._source.read()
            if turn != self._turn:
                return
            if first:
                self._record.opened(self._place())
            self._record.came(frame)
            first = False
            self._mailbox.put(frame)
            if not self._source.recorded:
                self._look_at(frame)
            if not judged and self._record.rate.full:
                judged = True
                self._judge_rate()

    def _look_at(self, frame: Frame) -> None:
        """Raises CameraLost for a camera that shows the past."""
        of_source = self._notices.notice if self._notices is not None else ""
        if self._faults.add(frame, self._torn(), of_source):
            self._record.noticed(self._faults.notice, self._place())
        if self._faults.frozen and self._keeper is None:
            raise CameraLost(
                "sends the same picture over and over",
                fix="it is opened again; where that does not help, unplug it and plug it in again",
            )

    def _judge_rate(self) -> None:
        measured_hz = self._record.rate.rate_hz()
        if self._expected_hz is not None and measured_hz < 0.9 * self._expected_hz:
            _LOG.warning(
                "%s: delivers %.1f Hz, asked for %g Hz: in dim light turn off automatic exposure, "
                "else its USB controller or the processor is overloaded",
                self._source.name,
                measured_hz,
                self._expected_hz,
            )

    def _wait_after(self, error: MocapdError, delivered: bool, failures: int) -> None:
        renewal, self._renewal = self._renewal, ""
        if renewal:
            self._lost(CameraLost(renewal))
            self._woken.clear()
            return
        # who pulls its plug does not wear a camera out: only that it is still there, and fails, counts
        there = self._plug is None or bool(self._plugged_now())
        hangs = there and any(one.is_alive() for one in self._stuck)
        if hangs and isinstance(error, UnavailableError):
            error = self._hang  # busy with ourselves: ending another program mends nothing
        ours = self._keeper is None or not self._keeper.camera_failed
        spent = delivered and there and ours and self._budget.spend(monotonic_ns())
        if spent:
            error = self._budget.left_out(error, self._plug is not None)
        self._lost(error)
        self._pause(self._budget.rest_s if spent else self._back_off.pause_s(failures))

    def _pause(self, pause_s: float) -> None:
        """Ends sooner when it is plugged in, woken or to stop."""
        until_ns = monotonic_ns() + nanoseconds(pause_s)
        while (left_s := seconds(until_ns - monotonic_ns())) > 0.0:
            if self._woken.wait(min(left_s, _LOOK_S)):
                self._woken.clear()
                return
            now = self._plugged_now()
            if now and now != self._plugging:
                self._budget.renew()
                return

    def _plugged_now(self) -> str:
        return self._plug.plugging() if self._plug is not None else ""

    def _place(self) -> str:
        return self._plug.place if self._plug is not None else ""

    @contextmanager
    def _called(self, turn: int) -> Iterator[None]:
        """Within it the thread is in its driver, for who watches it."""
        self._called_ns = monotonic_ns()
        try:
            yield
        finally:
            if turn == self._turn:
                self._called_ns = None

    def _torn(self) -> int:
        return self._counts_torn.torn if self._counts_torn is not None else 0

    def _lost(self, error: MocapdError) -> None:
        if self._record.lost(error) and self._presence is not None:
            self._presence.went(self._source.name)
